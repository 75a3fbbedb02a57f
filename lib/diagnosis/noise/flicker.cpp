// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/noise/flicker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "base/angle.h"
#include "base/robust.h"
#include "base/solve.h"
#include "diagnosis/criteria.h"
#include "diagnosis/lines/spectrum.h"
#include "diagnosis/noise/along_and_across.h"

namespace ada {

namespace {

/// Part of a channel's white noise that the radial direction keeps in that channel, of a vector
/// that turns: the mean of cos^4 + (sin cos)^2.
constexpr double kRadialWhite = 0.5;

/// Power of both channels' lines over time, and how it is looked at.
struct Lines {
  std::array<std::vector<double>, 2> power;
  std::array<double, 2> mean_square_v2{}; ///< of what the spectrum is of
  std::vector<double> flicker; ///< density of flicker noise over white noise and corner, s
  double bin_hz = 0.0;
  /// Lines that tell: those of the grid closer than the record resolves are no news, below the
  /// first what is slow in time, or steps with the speed, was taken out, and about the pair's own
  /// frequency lies what goes on slowly in its gain and angle.
  std::vector<std::size_t> told;

  std::size_t size() const { return power[0].size(); }

  /// Whittle's log likelihood of a corner, with the density of the white part that fits best.
  double likelihood(int channel, double corner_hz, double &white) const {
    const auto &p = power[static_cast<std::size_t>(channel)];
    double sum = 0.0, n = 0.0, logs = 0.0;
    for (std::size_t k : told) {
      const double shape = 1.0 + corner_hz * flicker[k];
      sum += p[k] / shape;
      logs += std::log(shape);
      n += 1.0;
    }
    white = sum / n;
    return -n * std::log(white) - n - logs;
  }
};

/// Density of flicker noise at a frequency where only the radial part of both channels is left,
/// over that of white noise there. Of each channel a half of the amplitude stays where it is, and a
/// quarter of each of the two goes to twice the rate of turning on either side.
double radial_flicker(double frequency, const std::vector<double> &twice_turning, double least) {
  double sum = 0.0;
  for (const double f : twice_turning)
    sum += 0.25 / std::max(std::abs(frequency - f), least) + 0.25 / (frequency + f);
  return 0.5 / frequency + sum / static_cast<double>(twice_turning.size());
}

/// Takes out what every pair has, by least squares in each channel: beside what repeats with the
/// angle a baseline may be off, and at a speed that changes its line spreads far and low.
void take_out_pair(ResidualColumns &rest) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  const auto row = [&](std::size_t i) {
    return Eigen::Vector3d(1.0, rest.model_sin[i], rest.model_cos[i]);
  };
  for (std::size_t i = 0; i < rest.sin.size(); ++i) {
    const Eigen::Vector3d x = row(i);
    matrix += x * x.transpose();
    right += x * Eigen::RowVector2d(rest.sin[i], rest.cos[i]);
  }
  const Eigen::Matrix<double, 3, 2> of = solved(matrix, right);
  if (!of.allFinite())
    return;
  for (std::size_t i = 0; i < rest.sin.size(); ++i) {
    const Eigen::RowVector2d pair = row(i).transpose() * of;
    rest.sin[i] -= pair[0];
    rest.cos[i] -= pair[1];
  }
}

/// `radial`: only that part is left, in which the pair does not turn.
Lines lines_of(const Observations &data, ResidualColumns rest, int periods, bool radial) {
  take_out_pair(rest);
  Lines out;
  for (int channel = 0; channel < 2; ++channel) {
    const auto &v = channel == 0 ? rest.sin : rest.cos;
    out.mean_square_v2[static_cast<std::size_t>(channel)] = mean_square(v);
    PowerOverTime s;
    add_power_over_time(
        data.time, data.frame_period_s, [&](std::size_t i) { return v[i]; }, s);
    out.bin_hz = s.bin_hz;
    out.power[static_cast<std::size_t>(channel)].assign(s.power.begin(), s.power.end());
  }
  const double span = data.time.back() - data.time.front();
  std::size_t stride = 1;
  if (span > 0.0 && out.bin_hz > 0.0)
    stride =
        std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(1.0 / (span * out.bin_hz))));
  constexpr std::size_t kSpeeds = 100; // that stand for all
  std::vector<double> turning, twice_turning;
  for (std::size_t i = 0; i < data.size(); i += std::max<std::size_t>(1, data.size() / kSpeeds))
    turning.push_back(periods * std::abs(static_cast<double>(data.omega[i])) / kTwoPi);
  if (radial)
    for (double f : std::exchange(turning, {}))
      twice_turning.push_back(2.0 * f);
  std::sort(turning.begin(), turning.end());
  const auto slow = stride * static_cast<std::size_t>(criteria::kMostTrends);
  const double width = static_cast<double>(slow) * out.bin_hz;
  for (std::size_t k = slow; k < out.size(); k += stride) {
    const double frequency = static_cast<double>(k) * out.bin_hz;
    const auto near = std::lower_bound(turning.begin(), turning.end(), frequency - width);
    if (near == turning.end() || *near > frequency + width)
      out.told.push_back(k);
  }
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double frequency = std::max<double>(static_cast<double>(k), 0.5) * out.bin_hz;
    out.flicker.push_back(twice_turning.empty()
                              ? 1.0 / frequency
                              : radial_flicker(frequency, twice_turning, 0.5 / span));
  }
  return out;
}

/// What is left along the radius. What has no name is chosen by what it takes out in all, of which
/// the most may lie across: where it adds along the radius it stays.
ResidualColumns radial_of(const Observations &data, ResidualColumns as_it_is,
                          ResidualColumns less) {
  keep_radial(data, as_it_is);
  keep_radial(data, less);
  return mean_square(as_it_is.sin) + mean_square(as_it_is.cos) <
                 mean_square(less.sin) + mean_square(less.cos)
             ? as_it_is
             : less;
}

/// A noise of the channels is the same wherever the shaft is. What comes back at a place, too fine
/// for the orders that were taken out, or seen by a motion that errs, is none: the mean of each
/// part of the turn is taken out, and rows of a part that still has much more power than most weigh
/// by so much less. Where few turns were made a place is a time, and nothing is done.
void even_out_places(const Observations &data, ResidualColumns &rest) {
  constexpr double kFewestTurns = 8.0;          // of which a mean takes an eighth of what is slow
  constexpr double kParts = 72.0, kRows = 64.0; // of a part, whose power is known to an eighth
  constexpr double kMuchMore = 2.0;
  const auto [least, most] = std::minmax_element(data.alpha.begin(), data.alpha.end());
  if (*most - *least < kFewestTurns * kTwoPi)
    return;
  const auto parts =
      static_cast<std::size_t>(std::clamp(static_cast<double>(data.size()) / kRows, 1.0, kParts));
  const auto part = [&](std::size_t i) {
    const double turns = wrap(data.alpha[i], kTwoPi) / kTwoPi;
    return std::min(parts - 1, static_cast<std::size_t>(turns * static_cast<double>(parts)));
  };
  struct Part {
    double rows = 0.0, sin = 0.0, cos = 0.0, power = 0.0;
  };
  std::vector<Part> of(parts);
  for (std::size_t i = 0; i < data.size(); ++i) {
    Part &p = of[part(i)];
    p.rows += 1.0;
    p.sin += (rest.sin[i] - p.sin) / p.rows;
    p.cos += (rest.cos[i] - p.cos) / p.rows;
  }
  for (std::size_t i = 0; i < data.size(); ++i) {
    Part &p = of[part(i)];
    rest.sin[i] -= p.sin;
    rest.cos[i] -= p.cos;
    p.power += (rest.sin[i] * rest.sin[i] + rest.cos[i] * rest.cos[i]) / p.rows;
  }
  std::vector<double> powers;
  for (const Part &p : of)
    if (p.rows > 0.0)
      powers.push_back(p.power);
  const double usual = quantile(powers, 0.5);
  for (std::size_t i = 0; i < data.size(); ++i)
    if (const double power = of[part(i)].power; power > kMuchMore * usual) {
      rest.sin[i] *= usual / power;
      rest.cos[i] *= usual / power;
    }
}

} // namespace

Flicker flicker_of(const Observations &whole, bool has_reference, const Model &model,
                   const Anonymous &left) {
  // What is smooth in time is taken out: flicker noise goes on above it, a wander does not. Of rows
  // that follow each other: into the gaps of a selection the low frequencies leak, and the corner
  // seems higher.
  Flicker out;
  std::vector<std::uint32_t> rows(std::min(whole.size(), criteria::kFlickerRows));
  std::iota(rows.begin(), rows.end(), static_cast<std::uint32_t>((whole.size() - rows.size()) / 2));
  Observations data = whole.select(rows);
  data.coloured.reset();
  if (!has_reference) // at an angle that is off the radius is that of another part of the ellipse
    data = at_own_angle(std::move(data), model);
  const double span = data.time.back() - data.time.front();
  if (!(data.frame_period_s > 0.0) || span <= 0.0)
    return out;
  ResidualColumns rest = residual_columns(data, model), as_it_is;
  if (!has_reference)
    as_it_is = rest;
  subtract(left.basis, left.selection, data, rest);
  if (!has_reference)
    rest = radial_of(data, std::move(as_it_is), std::move(rest));
  even_out_places(data, rest);
  const Lines of = lines_of(data, std::move(rest), model.periods_per_turn, !has_reference);
  const auto &[power, mean_squares, flicker, bin, told] = of;
  const std::size_t lines = of.size();
  if (lines < 64 || told.empty() || told.front() >= lines / 4)
    return out;
  double white[2], still[2];
  for (int c = 0; c < 2; ++c)
    still[c] = of.likelihood(c, 0.0, white[c]);
  const double top = static_cast<double>(lines) * bin;
  double least = 0.0, at_end = 0.0;
  for (double corner = 2.0 / span; corner < criteria::kHighestCorner * top; corner *= 1.08) {
    double w[2];
    const double a = of.likelihood(0, corner, w[0]) - still[0],
                 b = of.likelihood(1, corner, w[1]) - still[1];
    at_end = a + b;
    if (a + b > out.nats) {
      out.nats = a + b;
      out.corner_hz = corner;
      least = std::min(a, b);
      white[0] = w[0];
      white[1] = w[1];
    }
  }
  // As likely at the end of the search, where no white noise is left that it could meet: no corner
  // was seen.
  if (least < criteria::kNatsOfNoise || out.nats - at_end < criteria::kNatsOfNoise)
    return {};
  // Flicker noise and nothing else: every octave must be as this spectrum has it.
  for (int c = 0; c < 2; ++c)
    for (std::size_t from = told.front(); from < lines; from *= 2) {
      double ratio = 0.0, n = 0.0;
      for (auto k = std::lower_bound(told.begin(), told.end(), from);
           k != told.end() && *k < 2 * from; ++k, n += 1.0)
        ratio += power[static_cast<std::size_t>(c)][*k] /
                 (white[c] * (1.0 + out.corner_hz * flicker[*k]));
      const double off = std::abs(std::log(ratio / n));
      const bool clearly = off > std::log(criteria::kOctaveClearlyOff) &&
                           off > criteria::kErrorsOfOctave / std::sqrt(n);
      if (n >= criteria::kFewestOfOctave && (clearly || off > std::log(criteria::kOctaveOff)))
        return {};
    }
  // Flicker noise of the channels is seen along the radius as well: what is across only is an angle
  // that the reference, or the magnet, has moved.
  if (has_reference) {
    const Observations own = at_own_angle(std::move(data), model);
    ResidualColumns at_own = residual_columns(own, model), less = at_own;
    subtract(left.basis, left.selection, own, less);
    ResidualColumns radial = radial_of(own, std::move(at_own), std::move(less));
    even_out_places(own, radial);
    const Lines along = lines_of(own, std::move(radial), model.periods_per_turn, true);
    double nats = 0.0, w;
    for (int c = 0; c < 2; ++c)
      nats += along.likelihood(c, out.corner_hz, w) - along.likelihood(c, 0.0, w);
    if (nats <= 0.0)
      return {};
  }
  // Density of the white part from its share of the whole mean square.
  const double of_white = has_reference ? 1.0 : kRadialWhite;
  double sum = 0.0;
  for (int c = 0; c < 2; ++c) {
    double all = 0.0;
    for (std::size_t k : told)
      all += power[static_cast<std::size_t>(c)][k];
    const double count = static_cast<double>(told.size());
    const double density =
        mean_squares[static_cast<std::size_t>(c)] * white[c] / (all / count) / top / of_white;
    sum += 0.5 * density * out.corner_hz * std::log(std::max(out.corner_hz * span, std::exp(1.0)));
  }
  out.rms_v = std::sqrt(sum);
  // What was taken out was fitted, and its errors lie low in the spectrum as well.
  const double of_fit_v2 = left.selection.noise_v2 *
                           static_cast<double>(left.selection.columns.size()) /
                           std::max(1.0, left.from.n_train);
  return sum > criteria::kOfFit * of_fit_v2 ? out : Flicker{};
}

} // namespace ada

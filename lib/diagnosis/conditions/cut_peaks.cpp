// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Peaks that are cut off at one level, as the readings alone show them: where much else is left
// over, no fit shows the few readings on it.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Dense>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/criteria.h"
#include "model/effect.h"
#include "model/residual.h"

namespace ada {

namespace {

/// One end of a channel.
struct Level {
  double value_v = 0.0, error_v = 0.0;
  std::size_t peaks = 0;         ///< that it cuts off
  std::vector<std::size_t> rows; ///< on it, ascending
};

/// What holds all readings of one level: its converter's step at the least, and at the most the
/// noise of the channel, of which a level that is cut after the noise has none.
struct Band {
  double least_v, most_v;
};

Band band_of(std::span<const double> v, std::span<const char> usable, double half_v) {
  constexpr double kResolved = 1e-6; // of half the range: text is rounded, if nothing else is
  const double step = std::max(1.5 * converter_step(v), kResolved * half_v);
  const double noise = 2.0 * criteria::kLevelNoise * noise_between(v, usable);
  return {step, std::min(std::max(step, noise), criteria::kWidestLevel * half_v)};
}

/// A channel, whose readings times `sense` have their end at the top, and the other one, which goes
/// on while this one is on its level.
struct Channels {
  std::span<const double> own, other;
  std::span<const char> usable;
  double sense;
  Band band;
  double half_v, other_half_v, other_middle_v; ///< of their ranges
  double top(std::size_t i) const { return sense * own[i]; }
  /// By how much the channel lies below its peak where the other one is, on an ellipse, V.
  double fallen(double other_v) const {
    const double part = std::min(1.0, std::abs(other_v - other_middle_v) / other_half_v);
    return half_v * (1.0 - std::sqrt(1.0 - part * part));
  }
};

struct End {
  double top_v, band_v;
};

/// How the readings on a level go with what they would be lower by on an ellipse: as 1 on one, 0 on
/// a level, in between at a peak that is only flat. Beside that they may go with the other channel:
/// on a part of a turn the middle of its range is not that of the ellipse.
class Flatness {
public:
  void add(double other_v, double fallen_v, double top_v) {
    n_ += 1.0;
    const Eigen::Vector3d now(other_v, fallen_v, top_v), step = now - mean_;
    mean_ += step / n_;
    products_ += step * (now - mean_).transpose();
  }
  bool flat() const {
    if (n_ < 5.0 || !(products_(0, 0) > 0.0))
      return false;
    // Of the fall and of the top, what the other channel leaves.
    const Eigen::Vector2d along = products_.col(0).tail<2>();
    const Eigen::Matrix2d left =
        products_.bottomRightCorner<2, 2>() - along * along.transpose() / products_(0, 0);
    if (!(left(0, 0) > 0.0))
      return false;
    const double slope = left(0, 1) / left(0, 0);
    const double error =
        std::sqrt(std::max(0.0, left(1, 1) - slope * left(0, 1)) / ((n_ - 3.0) * left(0, 0)));
    return error < criteria::kFlatKnown &&
           std::abs(slope) < std::max(criteria::kFlatErrors * error, criteria::kFlat);
  }

private:
  double n_ = 0.0;
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products_ = Eigen::Matrix3d::Zero();
};

/// The readings at such an end, where they are on a level.
std::optional<Level> level_at(const Channels &c, const End &end) {
  const auto on = [&](std::size_t i) { return c.usable[i] && c.top(i) > end.top_v - end.band_v; };
  Level out;
  Flatness flatness;
  std::size_t in_peaks = 0;
  for (std::size_t i = 0; i < c.own.size(); ++i) {
    if (!on(i))
      continue;
    const std::size_t from = i;
    std::size_t to = i;
    double low = c.other[i], high = low, step = 0.0;
    for (; to < c.own.size() && on(to); ++to) {
      out.rows.push_back(to);
      if (to > from)
        step = std::max(step, std::abs(c.other[to] - c.other[to - 1]));
      low = std::min(low, c.other[to]);
      high = std::max(high, c.other[to]);
    }
    // It comes from below and goes there again: a channel that is stuck, or jumps, does not, and
    // the other one does not jump meanwhile.
    const auto joins = [&](std::size_t k) {
      return end.top_v - c.top(k) < criteria::kJoins * c.half_v;
    };
    const double half_way = 0.5 * (high - low);
    if (from > 0 && to < c.own.size() && joins(from - 1) && joins(to) &&
        to - from >= criteria::kFewestInPeak && step < criteria::kLargestStep * (high - low) &&
        c.fallen(c.other_middle_v + half_way) > criteria::kCutBands * end.band_v) {
      ++out.peaks;
      in_peaks += to - from;
      // About the middle of this peak: where the channels are not read at once, the other one is
      // not at that of its range, and elsewhere at each speed.
      const double here_v = 0.5 * (high + low);
      for (std::size_t k = from + 1; k + 1 < to; ++k) // the first and the last may be on the way
        flatness.add(c.other[k] - here_v, c.fallen(c.other_middle_v + c.other[k] - here_v),
                     c.top(k));
    }
    i = to - 1;
  }
  if (out.peaks == 0 || 2 * in_peaks < out.rows.size() || !flatness.flat())
    return {};
  std::vector<double> values;
  for (std::size_t i : out.rows)
    values.push_back(c.own[i]);
  out.value_v = quantile(values, 0.5);
  const double step = converter_step(c.own);
  out.error_v = std::hypot(robust_spread(values), step / std::sqrt(12.0)) /
                std::sqrt(static_cast<double>(values.size()));
  return out;
}

/// The level at the end of the readings, but for a few beyond it that may be spikes, in the widest
/// band that shows one.
std::optional<Level> level_of(const Channels &c) {
  std::vector<double> top;
  for (std::size_t i = 0; i < c.own.size(); ++i)
    if (c.usable[i])
      top.push_back(c.top(i));
  const auto most_spikes =
      static_cast<std::size_t>(criteria::kSpikesAboveLevel * static_cast<double>(top.size()));
  // Two of the widest bands of a sine hold a fifth of it.
  const auto quarter = top.begin() + static_cast<std::ptrdiff_t>(top.size() / 4);
  std::nth_element(top.begin(), quarter, top.end(), std::greater<>());
  top.erase(quarter, top.end());
  std::sort(top.begin(), top.end(), std::greater<>());
  const auto below = [&](double level) {
    return static_cast<double>(std::lower_bound(top.begin(), top.end(), level, std::greater<>()) -
                               top.begin());
  };
  for (double band = c.band.most_v; band >= c.band.least_v && band > 0.0; band *= 0.5)
    for (std::size_t k = 0; k <= most_spikes && k < top.size(); ++k) {
      const double upper = below(top[k] - band) - static_cast<double>(k),
                   lower = below(top[k] - 2.0 * band) - static_cast<double>(k) - upper;
      if (upper < criteria::kFewestOnLevel || upper <= criteria::kOnLevel * lower)
        continue;
      if (auto found = level_at(c, {top[k], band}))
        return found;
      break; // further down are the same readings
    }
  return {};
}

} // namespace

namespace {

/// How round the readings of one channel lie where a level acts in the model: 1 on an ellipse, 0 on
/// a level. Against the other channel a peak is a parabola, wherever its middle is. What the model
/// has behind the level, a memory or a tone, is in what it leaves no more.
struct Roundness {
  double value = 0.0, error = std::numeric_limits<double>::infinity();
};

Roundness roundness_on(const Residual &r, bool of_sin, double sense) {
  const std::span<const float> reads = of_sin ? r.read_sin_v : r.read_cos_v;
  const std::span<const float> others = of_sin ? r.read_cos_v : r.read_sin_v;
  const std::span<const double> model = of_sin ? r.model_sin_v : r.model_cos_v;
  const std::span<const double> without = of_sin ? r.without_sin_v : r.without_cos_v;
  const double centre_v = of_sin ? r.centre_cos_v : r.centre_sin_v;
  std::vector<double> other, own; // of the amplitude
  for (std::size_t i = 0; i < reads.size(); ++i)
    if (sense * (without[i] - model[i]) > criteria::kActsOnLevel * r.noise_v) {
      other.push_back((static_cast<double>(others[i]) - centre_v) / r.amplitude_v);
      own.push_back(sense * (static_cast<double>(reads[i]) - model[i]) / r.amplitude_v);
    }
  const double middle = quantile(own, 0.5), most = criteria::kWildOnLevel * robust_spread(own);
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double n = 0.0, square = 0.0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (std::abs(own[i] - middle) > most)
      continue;
    const Eigen::Vector3d row(1.0, other[i], 0.5 * other[i] * other[i]);
    products += row * row.transpose();
    right += row * own[i];
    square += own[i] * own[i];
    n += 1.0;
  }
  const Eigen::LDLT<Eigen::Matrix3d> solver(products);
  if (n < criteria::kFewestActedOn || solver.info() != Eigen::Success ||
      !(solver.vectorD().minCoeff() > 0.0))
    return {};
  const Eigen::Vector3d parabola = solver.solve(right);
  // Within one step of the converter any peak is flat; and no reading is exact.
  constexpr double kExact = 1e-6; // of the amplitude: text is rounded, if nothing else is
  const double step = std::max(
      converter_step(std::vector<double>(reads.begin(), reads.end())) / r.amplitude_v, kExact);
  const double variance = std::max((square - parabola.dot(right)) / (n - 3.0), step * step / 12.0);
  return {-parabola[2], std::sqrt(variance * solver.solve(Eigen::Vector3d::UnitZ())[2])};
}

/// Rows on a level are not the pair's, nor are those between and beside them that noise alone has
/// put below: what is left of them would all lie on one side.
void leave_out(const Level &level, std::span<const double> v, double sense, double band_v,
               std::vector<char> &usable) {
  constexpr double kBands = 2.0; // below the level: from there on it is the way to the next peak
  for (std::size_t k = 0; k < level.rows.size(); ++k) {
    const std::size_t row = level.rows[k];
    std::fill(usable.begin() + static_cast<std::ptrdiff_t>(row - std::min<std::size_t>(row, 1)),
              usable.begin() + static_cast<std::ptrdiff_t>(std::min(row + 2, usable.size())),
              char{0});
    if (k == 0)
      continue;
    const auto between = usable.begin() + static_cast<std::ptrdiff_t>(level.rows[k - 1]) + 1;
    const auto end = usable.begin() + static_cast<std::ptrdiff_t>(level.rows[k]);
    const auto below = [&](const char &of_row) {
      const double at = v[static_cast<std::size_t>(&of_row - usable.data())];
      return sense * (level.value_v - at) > kBands * band_v;
    };
    if (std::none_of(between, end, below))
      std::fill(between, end, char{0});
  }
}

/// Periods of the pair that a reference goes through.
double periods_of_reference(const Capture &capture, std::span<const char> usable) {
  double turns = 0.0, last = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < capture.size(); ++i) {
    if (!usable[i])
      continue;
    if (!std::isnan(last))
      turns += std::abs(wrap_centred(capture.reference_deg[i] - last, 360.0)) / 360.0;
    last = capture.reference_deg[i];
  }
  return turns * capture.meta.periods_per_turn;
}

/// Whether an end is cut off in some periods and not in others, as where the amplitude changes: of
/// that the mean peak, which a reference tells, is no measure, and the readings alone say it.
bool cuts_some(const Screened &look, std::size_t peaks) {
  constexpr double kAll = 0.9;
  const double periods = periods_of_reference(look.capture, look.usable);
  return static_cast<double>(peaks) < kAll * std::floor(periods);
}

} // namespace

bool lie_on_levels(const Residual &residual, std::span<const double> levels) {
  if (residual.without_sin_v.empty())
    return true;
  for (const std::size_t high : {0u, 1u}) {
    if (!std::isfinite(levels[high]))
      continue;
    double weights = 0.0, sum = 0.0;
    for (const bool of_sin : {true, false}) {
      if (!std::isnan(levels[2]) && (levels[2] < 0.5) != of_sin)
        continue;
      const Roundness at = roundness_on(residual, of_sin, high ? 1.0 : -1.0);
      const double weight = 1.0 / (at.error * at.error);
      weights += weight;
      sum += weight * at.value;
    }
    constexpr double kRound = 1.0, kHalfWay = 0.5; // of an ellipse; nearer to a level
    if (!(weights > 0.0))
      return false;
    const double roundness = sum / weights, error = 1.0 / std::sqrt(weights);
    if (roundness + criteria::kFlatErrors * error > kRound || roundness > kHalfWay)
      return false;
  }
  return true;
}

bool screen_cut_peaks(Screened &look, const Effect &effect) {
  const Capture &capture = look.capture;
  const std::span<const double> channels[] = {capture.vsin_v, capture.vcos_v};
  const Range ranges[] = {range_of(channels[0], look.usable), range_of(channels[1], look.usable)};
  const Band bands[] = {band_of(channels[0], look.usable, ranges[0].half),
                        band_of(channels[1], look.usable, ranges[1].half)};
  const double band = std::max(bands[0].most_v, bands[1].most_v);
  std::optional<Level> ends[2][2]; // of a channel: low, high
  for (std::size_t k : {0u, 1u})
    for (std::size_t high : {0u, 1u})
      ends[k][high] =
          level_of({channels[k], channels[1 - k], look.usable, high ? 1.0 : -1.0, bands[k],
                    ranges[k].half, ranges[1 - k].half, ranges[1 - k].middle});
  std::size_t on_levels = 0, peaks = 0, usable = 0;
  std::size_t fewest = std::numeric_limits<std::size_t>::max(); // of the ends with a level
  for (const auto &channel : ends)
    for (const auto &end : channel)
      if (end) {
        fewest = std::min(fewest, end->peaks);
        on_levels += end->rows.size();
        peaks += end->peaks;
      }
  if (peaks < criteria::kFewestCutPeaks || (capture.has_reference() && !cuts_some(look, fewest)))
    return false;
  for (char u : look.usable)
    usable += u != 0;
  if (2 * on_levels > usable) // the rest shows no pair: levels are left to the fit
    return false;
  // A level is that of both channels unless the other one goes beyond it.
  const auto of_both = [&](std::size_t k, std::size_t high) {
    const double sense = high ? 1.0 : -1.0;
    const double level = ends[k][high]->value_v;
    if (const auto &other = ends[1 - k][high])
      return std::abs(other->value_v - level) < band;
    std::size_t beyond = 0;
    for (std::size_t i = 0; i < capture.size(); ++i)
      beyond += look.usable[i] && sense * (channels[1 - k][i] - level) > band;
    return static_cast<double>(beyond) <=
           criteria::kBeyondOthersLevel * static_cast<double>(capture.size());
  };
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto find = [&](const std::optional<Level> &low, const std::optional<Level> &high,
                        double channel) {
    if (low || high)
      look.findings.push_back({&effect,
                               {low ? low->value_v : kNone, high ? high->value_v : kNone, channel},
                               {low ? low->error_v : 0.0, high ? high->error_v : 0.0, 0.0},
                               {},
                               {}});
  };
  bool both = true, any = false;
  for (std::size_t k : {0u, 1u})
    for (std::size_t high : {0u, 1u})
      if (ends[k][high]) {
        any = true;
        both = both && of_both(k, high);
        leave_out(*ends[k][high], channels[k], high ? 1.0 : -1.0, bands[k].most_v, look.usable);
      }
  if (both)
    find(ends[0][0] ? ends[0][0] : ends[1][0], ends[0][1] ? ends[0][1] : ends[1][1], kNone);
  else
    for (std::size_t k : {0u, 1u})
      find(ends[k][0], ends[k][1], static_cast<double>(k));
  return any;
}

} // namespace ada

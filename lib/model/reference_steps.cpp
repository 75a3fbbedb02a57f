// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/angle.h"
#include "base/sense.h"
#include "model/residual.h"

namespace ada {

namespace {

constexpr std::size_t kFewest = 64; ///< samples
constexpr double kOnGrid = 0.95;    ///< part of the samples
constexpr double kOffGrid = 0.1;    ///< of a step
constexpr std::size_t kWindow = 8;  ///< samples to either side over which the speed is even
constexpr std::size_t kLongWindow = 8 * kWindow;
constexpr double kAddsToNoise = 1.0 / 9; ///< of its power: a twentieth of its rms
/// Of the power of the noise of a difference, from which on half of what a count is off by is told
/// from none; and share of the samples that may be off by none all the same, where a speed is not
/// even.
constexpr double kOffByMore = 32.0, kMostKeptUp = 0.5;

/// The last decimal that numbers are written with, of nine at most.
double last_decimal(const std::vector<double> &values) {
  double unit = 1.0;
  for (int decimals = 0; decimals < 9; ++decimals, unit *= 0.1)
    if (std::all_of(values.begin(), values.end(), [&](double v) {
          return std::abs(v / unit - std::round(v / unit)) * unit < 1e-10;
        }))
      break;
  return unit;
}

/// The spacing of which all spacings of the values are multiples; 0 where there is none.
double grid_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double decimal = last_decimal(values);
  // One count may be written in two ways, a last decimal apart. Where that is the step itself it is
  // what most neighbours are apart.
  constexpr double kOneValue = 1e-9;
  const auto gaps_beyond = [&](double least) {
    std::vector<double> out;
    double last = values.empty() ? 0.0 : values.front();
    for (const double v : values)
      if (v - last > least) {
        out.push_back(v - last);
        last = v;
      }
    return out;
  };
  std::vector<double> gaps = gaps_beyond(kOneValue);
  const auto finest =
      std::count_if(gaps.begin(), gaps.end(), [&](double g) { return g < 1.5 * decimal; });
  if (2 * static_cast<std::size_t>(finest) < gaps.size())
    gaps = gaps_beyond(1.5 * decimal);
  if (gaps.size() < 3)
    return 0.0;
  std::vector<double> sorted = gaps;
  const auto low = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 10);
  std::nth_element(sorted.begin(), low, sorted.end());
  // The text rounds each value, so one gap is no measure of the step: count them over the turn,
  // first over gaps so short that they hold a whole number of such steps without doubt, then over
  // those that the step known from them counts without doubt.
  constexpr double kDoubt = 0.25; // of a step
  // A step of four decimals or fewer is taken as exact: one more or less would be in doubt itself.
  // Within a run of gaps the rounding of all but its ends cancels.
  double step = *low, error = (*low - 0.5 * decimal) * kDoubt > decimal ? decimal : 0.0;
  constexpr int kMostPasses = 10; // each knows the step by as much better as it counts farther
  double before = 0.0;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    double counted = 0.0, length = 0.0, steps = 0.0, runs = 1.0;
    for (const double gap : gaps) {
      const double in_gap = std::round(gap / step);
      if (in_gap * error > kDoubt * step) {
        runs += 1.0;
        continue;
      }
      length += gap;
      steps += in_gap;
      counted += 1.0;
    }
    if (!(steps > 0.0))
      return 0.0;
    step = length / steps;
    error = std::min(error, decimal * std::sqrt(runs) / steps);
    if (std::exchange(before, counted) >= counted)
      break;
  }
  const auto fits = std::count_if(values.begin(), values.end(), [&](double v) {
    const double at = (v - values.front()) / step;
    return std::abs(at - std::round(at)) < kOffGrid;
  });
  return static_cast<double>(fits) >= kOnGrid * static_cast<double>(values.size()) ? step : 0.0;
}

/// White noise of a column, squared, from its third divided differences: into them neither a motion
/// enters that is smooth over four rows nor a clock that scatters.
double noise_power(const std::vector<double> &time, const std::vector<double> &x) {
  std::vector<double> size;
  for (std::size_t i = 3; i < x.size(); ++i) {
    double difference = 0.0, squares = 0.0;
    for (std::size_t k = i - 3; k <= i; ++k) {
      double weight = 1.0;
      for (std::size_t m = i - 3; m <= i; ++m)
        weight *= m == k ? 1.0 : (time[i] - time[i - 3]) / (time[k] - time[m]);
      difference += weight * x[k];
      squares += weight * weight;
    }
    if (const double d = difference / std::sqrt(squares); std::isfinite(d))
      size.push_back(std::abs(d));
  }
  if (size.empty())
    return 0.0;
  const auto middle = size.begin() + static_cast<std::ptrdiff_t>(size.size() / 2);
  std::nth_element(size.begin(), middle, size.end());
  const double rms = *middle / 0.6745; // of a normal distribution
  return rms * rms;
}

/// Sums up to each element, to take means over windows.
std::vector<double> sums(const std::vector<double> &x) {
  std::vector<double> out{0.0};
  for (const double v : x)
    out.push_back(out.back() + v);
  return out;
}

} // namespace

double reference_grid_rad(std::span<const double> reference_deg) {
  return grid_of({reference_deg.begin(), reference_deg.end()}) * kRadPerDeg;
}

bool goes_on_evenly(std::span<const double> reference_deg) {
  constexpr double kNearlyAll = 0.999, kSame_deg = 1e-6;
  constexpr double kMostly = 0.9;     // a counter that dithers turns back in each row
  constexpr double kDecimals = 100.0; // in a step that is none of them
  const std::vector<double> all(reference_deg.begin(), reference_deg.end());
  const double decimal_deg = last_decimal(all);
  const double same_deg =
      kSame_deg + (grid_of(all) > kDecimals * decimal_deg ? 1.5 * decimal_deg : 0.0);
  std::vector<double> by;
  for (std::size_t i = 1; i < reference_deg.size(); ++i)
    by.push_back(wrap_centred(reference_deg[i] - reference_deg[i - 1], 360.0));
  if (by.empty())
    return false;
  // Where the shaft turns back, two rows are nearer to each other, and on one of its sides.
  std::vector<double> onward;
  for (std::size_t i = 0; i < by.size(); ++i)
    if (!(i > 0 && by[i - 1] * by[i] <= 0.0) && !(i + 1 < by.size() && by[i] * by[i + 1] <= 0.0))
      onward.push_back(std::abs(by[i]));
  if (static_cast<double>(onward.size()) < kMostly * static_cast<double>(by.size()))
    return false;
  std::vector<double> sorted = onward;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double usual = *middle;
  const auto same = std::count_if(onward.begin(), onward.end(),
                                  [=](double d) { return std::abs(d - usual) < same_deg; });
  return usual != 0.0 &&
         static_cast<double>(same) >= kNearlyAll * static_cast<double>(onward.size());
}

// A grid alone is no evidence: a stage that stops at whole degrees has one as well. A counter that
// shows steps of width q to a shaft that moves by v = (k + f) q from sample to sample counts k or
// k + 1, so that its differences scatter by q^2 f (1 - f) about those of the pair.
double find_reference_step(const Screened &look) {
  const std::vector<double> &reference = look.capture.reference_deg;
  if (reference.size() < kFewest || look.angle.size() != reference.size() ||
      look.capture.time_s.size() != reference.size())
    return 0.0;
  const double step = reference_grid_rad(reference);
  const double noise = noise_power(look.capture.time_s, look.angle);
  if (!(step * step / 12.0 > kAddsToNoise * noise) || goes_on_evenly(reference))
    return 0.0;

  std::vector<double> moved(reference.size() - 1), seen(moved.size()), apart(moved.size());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const double of_pair = look.angle[i + 1] - look.angle[i];
    const double of_reference = wrap_centred(reference[i + 1] - reference[i], 360.0) * kRadPerDeg;
    if (!std::isfinite(of_pair) || !std::isfinite(of_reference))
      continue;
    seen[i] = of_pair;
    moved[i] = of_reference;
  }
  const double sense = common_sense(
      moved.size(), [&](std::size_t i) { return moved[i]; },
      [&](std::size_t i) { return seen[i]; });
  for (std::size_t i = 0; i < moved.size(); ++i)
    apart[i] = moved[i] - sense * seen[i];
  // Differences scatter about their mean over a window, whose speed is that of `of_speed`: by as
  // much as a counter's do, beside `noise` of theirs. `sigma`: of the speed, in steps a sample;
  // `least`: f (1 - f) below which it shows nothing of its width, at whole multiples of the step
  // and at rest.
  const auto counts = [&](std::size_t window, const std::vector<double> &of_speed,
                          const std::vector<double> &difference, double own_noise, double sigma,
                          double least) {
    const std::vector<double> speed = sums(of_speed), mean = sums(difference);
    double scatter = 0.0, expected = 0.0, count = 0.0, told = 0.0, kept_up = 0.0;
    for (std::size_t i = window; i + window < moved.size(); ++i) {
      const std::size_t from = i - window, to = i + window + 1;
      const double length = static_cast<double>(to - from);
      const double e = difference[i] - (mean[to] - mean[from]) / length;
      const double v = std::abs(speed[to] - speed[from]) / length / step;
      const double f = v - std::floor(v);
      if (std::abs(e) > 2.0 * step + 6.0 * std::sqrt(own_noise)) // a spike, a loss
        continue;
      scatter += e * e;
      expected += step * step * f * (1.0 - f);
      count += 1.0;
      // Every count is off by the one part of a step or the other: a shaft that goes from rest to
      // rest keeps up with its reference in almost every row.
      if (const double least_off = step * std::min(f, 1.0 - f);
          own_noise > 0.0 && least_off * least_off > kOffByMore * own_noise) {
        told += 1.0;
        kept_up += std::abs(difference[i]) < 0.5 * least_off;
      }
    }
    scatter -= 2.0 * own_noise * count;
    // The noise of the speed alone lets f(1 - f) seem as large as its mean deviation, 0.8 sigma.
    const bool shows = expected > (least + 1.5 * sigma) * step * step * count;
    return shows && scatter > 0.5 * expected && scatter < 2.0 * expected &&
           kept_up <= kMostKeptUp * told;
  };
  const double length = 2.0 * kWindow + 1.0, long_length = 2.0 * kLongWindow + 1.0;
  const double sigma = std::sqrt(2.0 * noise) / length / step;
  // A steady speed near a whole multiple is known well enough from the reference itself, over many
  // samples, of which the first and the last are rounded. Then its differences alone must scatter
  // so, which those of a speed that is one do not, and what the pair does not go along with, which
  // a shaft that moves in steps does.
  const double of_ends = 1.0 / std::sqrt(6.0) / long_length;
  const bool steps = counts(kWindow, seen, apart, noise, sigma, 0.02) ||
                     (counts(kLongWindow, moved, moved, 0.0, of_ends, 0.005) &&
                      counts(kLongWindow, moved, apart, noise, of_ends, 0.005));
  return steps ? step * kDegPerRad : 0.0;
}

// Counts are off by an even spread of a step, whatever else is noise: both variances add, and so do
// both fourth cumulants, of which noise has none and an even spread -1.2 times its variance
// squared.
double counted_step(std::span<const double> reference_deg, std::span<const double> off_rad,
                    double noise_rad) {
  constexpr std::size_t kEnough = 100;
  constexpr double kOutside = 0.02, kErrors = 3.0;
  constexpr double kUneven = 0.7; // a variance of a hundred even values is known to 9 %
  constexpr double kOfEven = -1.2, kHalf = 0.5;
  constexpr double kFine = 1.0 / 15; // of a step; more noise than that hides where the counts end
  const std::size_t n = reference_deg.size();
  if (n < kEnough || off_rad.size() != n)
    return 0.0;
  const double step = reference_grid_rad(reference_deg);
  const double of_steps = step * step / 12.0, noise = noise_rad * noise_rad;
  double squares = 0.0, fourths = 0.0, inside = 0.0;
  for (const double off : off_rad)
    if (std::abs(off) <= kHalf * step + kErrors * noise_rad) {
      inside += 1.0;
      squares += off * off;
      fourths += std::pow(off, 4);
    }
  if (!(inside > 0.0) || inside < (1.0 - kOutside) * static_cast<double>(n))
    return 0.0;
  squares /= inside;
  const double share = (squares - noise) / of_steps;
  const double kurtosis = fourths / inside / (squares * squares) - 3.0;
  const double of_even = kOfEven * std::pow(of_steps / (of_steps + noise), 2);
  const double error = std::sqrt(24.0 / inside); // of a normal distribution's
  // Beside little noise the bounds alone tell: of normal values as wide, eight in a hundred lie
  // outside them.
  const bool even =
      noise_rad < kFine * step || kurtosis < std::min(kHalf * of_even, -kErrors * error);
  return even && share > kUneven && share < 1.0 / kUneven ? step * kDegPerRad : 0.0;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "motion/counted_angle.h"

#include <algorithm>
#include <cmath>

#include "base/robust.h"
#include "motion/spline.h"

namespace ada {

namespace {

/// Of a step, what a reading may be off: half of one, and what the spline's own error adds.
constexpr double kAgrees = 0.55;
constexpr std::size_t kFewest = 24; ///< readings in a piece: with fewer nothing is smoothed
constexpr int kMostRounds = 20;     ///< of halving, over a million readings
/// Where most readings agree and a few do not: of all of them, and of a step.
constexpr double kShare = 0.999, kSpread = 2.4 * kAgrees;

} // namespace

std::optional<std::vector<double>> between_steps(std::span<const double> time,
                                                 std::span<const double> angle,
                                                 std::span<const char> usable, double step) {
  const std::size_t n = time.size();
  if (n < kFewest || !(step > 0.0))
    return std::nullopt;
  std::vector<std::size_t> ends{0, n - 1}; // samples at the knots
  std::vector<double> out(n), off;
  for (int round = 0; round < kMostRounds; ++round) {
    std::vector<double> knots;
    for (std::size_t at : ends)
      knots.push_back(time[at]);
    CubicSpline spline(knots);
    spline.fit(time, angle, usable, 0, {});
    off.clear();
    for (std::size_t i = 0; i < n; ++i) {
      out[i] = spline.value(time[i]);
      if (usable[i])
        off.push_back(angle[i] - out[i]);
    }
    if (off.empty())
      return std::nullopt;
    std::vector<std::size_t> halved;
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
      halved.push_back(ends[k]);
      const std::size_t middle = (ends[k] + ends[k + 1]) / 2;
      bool agrees = true;
      for (std::size_t i = ends[k]; i < ends[k + 1] && agrees; ++i)
        agrees = !usable[i] || std::abs(angle[i] - out[i]) <= kAgrees * step;
      if (!agrees && ends[k + 1] - ends[k] >= 2 * kFewest && time[middle] > time[ends[k]] &&
          time[ends[k + 1]] > time[middle])
        halved.push_back(middle);
    }
    halved.push_back(ends.back());
    if (halved.size() == ends.size())
      break;
    ends = std::move(halved);
  }
  if (quantile(off, 0.5 + 0.5 * kShare) - quantile(off, 0.5 - 0.5 * kShare) > kSpread * step)
    return std::nullopt;
  return out;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "motion/counted_angle.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "motion/spline.h"

namespace ada {

namespace {

/// Of a step, what a reading may be off: half of one, and what the spline's own error adds.
constexpr double kAgrees = 0.55;
constexpr std::size_t kFewest = 24; ///< readings in a piece: with fewer nothing is smoothed
constexpr int kMostRounds = 20;     ///< of halving, over a million readings

} // namespace

BetweenSteps between_steps(std::span<const double> time, std::span<const double> angle,
                           std::span<const char> usable, double step) {
  const std::size_t n = time.size();
  BetweenSteps result{{angle.begin(), angle.end()}, std::vector<char>(n, 0)};
  auto &[out, known] = result;
  if (n < kFewest || !(step > 0.0) || !(time.back() > time.front()) ||
      std::count(usable.begin(), usable.end(), char{1}) == 0)
    return result;
  std::vector<std::size_t> ends{0, n - 1}; // samples at the knots
  for (int round = 0; round < kMostRounds; ++round) {
    std::vector<double> knots;
    for (std::size_t at : ends)
      knots.push_back(time[at]);
    CubicSpline spline(knots);
    spline.fit(time, angle, usable, 0, {});
    std::vector<std::size_t> halved;
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
      const std::size_t from = ends[k], to = ends[k + 1], middle = (from + to) / 2;
      halved.push_back(from);
      bool agrees = true;
      for (std::size_t i = from; i <= to; ++i) {
        out[i] = spline.value(time[i]);
        agrees = agrees && (!usable[i] || std::abs(angle[i] - out[i]) <= kAgrees * step);
      }
      std::fill(known.begin() + static_cast<std::ptrdiff_t>(from),
                known.begin() + static_cast<std::ptrdiff_t>(to + 1), agrees);
      if (agrees)
        continue;
      if (to - from >= 2 * kFewest && time[middle] > time[from] && time[to] > time[middle])
        halved.push_back(middle);
    }
    halved.push_back(ends.back());
    if (halved.size() == ends.size())
      break;
    ends = std::move(halved);
  }
  for (std::size_t i = 0; i < n; ++i)
    if (!usable[i] || !known[i]) {
      out[i] = angle[i];
      known[i] = 0;
    }
  return result;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/angle.h"
#include "health/checks.h"
#include "health/criteria.h"

namespace ada::health {

namespace {

/// Mean of 1 - cos about their direction: 0 where all are one angle, 1 where they fill the circle.
/// The farthest ones do not count, as many as may be wild.
double scatter(const std::vector<double> &angles_rad) {
  double x = 0, y = 0;
  for (const double a : angles_rad) {
    x += std::cos(a);
    y += std::sin(a);
  }
  const double direction = std::atan2(y, x);
  std::vector<double> off;
  for (const double a : angles_rad)
    off.push_back(1 - std::cos(a - direction));
  const auto all = static_cast<double>(off.size());
  const auto wild = static_cast<std::size_t>(
      std::max(static_cast<double>(kFewFaulty), kMaxFaultyFraction * all));
  if (off.size() <= wild)
    return 0;
  const auto end = off.end() - static_cast<std::ptrdiff_t>(wild);
  std::nth_element(off.begin(), end, off.end());
  return std::accumulate(off.begin(), end, 0.0) / static_cast<double>(end - off.begin());
}

/// Electrical angles of reference and sensor, and between them for either sense of rotation.
struct Compared {
  std::vector<double> reference, sensor, between, against;
};

Compared compare(const Evidence &e) {
  Compared out;
  const double periods = e.capture.meta.periods_per_turn * kRadPerDeg;
  for (std::size_t i = 0; i < e.angles.size(); ++i) {
    const double reference = wrap(periods * e.capture.reference_deg[i], kTwoPi);
    const double sensor = periods * e.angles[i].angle_deg;
    if (!std::isfinite(reference + sensor))
      continue;
    out.reference.push_back(reference);
    out.sensor.push_back(sensor);
    out.between.push_back(sensor - reference);
    out.against.push_back(sensor + reference);
  }
  return out;
}

/// The periods that the pair makes in a turn of the reference, where it goes with it by another number
/// than the stated one.
std::optional<int> periods_that_fit(const Evidence &e, double turning) {
  constexpr int kMost = 32;
  std::vector<double> with, against;
  for (int periods = 1; periods <= kMost; ++periods) {
    with.clear();
    against.clear();
    for (std::size_t i = 0; i < e.angles.size(); ++i) {
      const double sensor = e.capture.meta.periods_per_turn * kRadPerDeg * e.angles[i].angle_deg;
      const double reference = periods * kRadPerDeg * e.capture.reference_deg[i];
      if (!std::isfinite(reference + sensor))
        continue;
      with.push_back(sensor - reference);
      against.push_back(sensor + reference);
    }
    if (std::min(scatter(with), scatter(against)) / turning <= kReferenceScatter)
      return periods;
  }
  return std::nullopt;
}

std::string why_not(const Evidence &e, double turning) {
  const int stated = e.capture.meta.periods_per_turn;
  if (const auto periods = periods_that_fit(e, turning))
    return fmt::format("the reference goes with the sensor at {} {} a turn, where the capture states "
                       "{}: its periods_per_turn is wrong, or the reference counts other turns",
                       *periods, *periods == 1 ? "period" : "periods", stated);
  return fmt::format("the sensor turns, but the reference does not go with it: it belongs to another "
                     "shaft, slips, or the periods per turn are not {}",
                     stated);
}

} // namespace

HealthCheck check_reference(const Evidence &e) {
  const Compared angles = compare(e);
  const bool reference_turns = scatter(angles.reference) >= kTurnedScatter;
  if (!e.turns)
    return reference_turns ? verdict("reference", false, 1, kReferenceScatter, "of its turning",
                                     "the reference turns, but the outputs do not: there is no "
                                     "magnet, or neither channel is connected")
                           : cannot_tell("reference", "the magnet does not turn");
  if (const std::string why = no_figures(e); !why.empty())
    return cannot_tell("reference", why);
  const double turning = scatter(angles.sensor);
  if (turning < kTurnedScatter)
    return cannot_tell("reference", "the magnet hardly turns");
  const double left = std::min(scatter(angles.between), scatter(angles.against)) / turning;
  const bool passed = left <= kReferenceScatter;
  return verdict("reference", passed, left, kReferenceScatter, "of its turning",
                 passed            ? "the reference goes with the sensor"
                 : reference_turns ? why_not(e, turning)
                                   : "the sensor turns, but the reference stands still");
}

} // namespace ada::health

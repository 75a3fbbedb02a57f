// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/angle.h"
#include "base/text.h"
#include "health/checks.h"
#include "health/criteria.h"
#include "health/reference_share.h"

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

std::string why_not(const Evidence &e) {
  std::string why = why_of_no_shaft(e.capture);
  return !why.empty() ? why
                      : "the reference goes with the sensor now and then only: it slips, drifts or "
                        "jumps against it, or stands still for a time";
}

HealthCheck held_fault(const Evidence &e, const std::vector<RowRange> &held) {
  const RowRange longest = *std::ranges::max_element(held, {}, &RowRange::size);
  return failed_by(
      e, "reference", held,
      fmt::format("the reference keeps its value while the pair turns on: {}, first at "
                  "{}, for {} rows at most",
                  times_text(held.size()), moment_text(e.capture.time_s[held.front().first]),
                  longest.size()));
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
  if (passed)
    if (const std::vector<RowRange> held = held_reference(e.capture); !held.empty())
      return held_fault(e, held);
  return verdict("reference", passed, left, kReferenceScatter, "of its turning",
                 passed ? "the reference goes with the sensor" : why_not(e));
}

} // namespace ada::health

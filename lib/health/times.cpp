// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/frame.h"
#include "base/text.h"
#include "health/checks.h"
#include "health/criteria.h"
#include "recording/capture_file.h"

namespace ada::health {

namespace {

HealthCheck gaps_fault(double measured, double limit, std::string unit, std::string explanation) {
  return verdict("gaps", false, measured, limit, std::move(unit), std::move(explanation));
}

/// Samples that share their time: all, so many that the times are rounded, or some.
HealthCheck standing_time(const Evidence &e) {
  const Recording &c = e.what.recording;
  const TimeSteps &s = e.tally.steps;
  const auto standing = static_cast<double>(s.standing), all = static_cast<double>(c.size());
  const double moments = all - standing;
  std::string why;
  if (s.standing + 1 == c.size())
    why = fmt::format("all samples have the same time, {}", moment(c, 0));
  else if (standing > moments)
    why = fmt::format("time is given in steps of {:.3g} s, with about {:.0f} samples to each: too "
                      "coarse to show missing samples, or any speed",
                      e.usual_step_s, all / moments);
  else
    why = fmt::format("time does not grow from sample to sample: {} times, first at {}", s.standing,
                      moment(c, s.first_standing));
  return gaps_fault(standing, 0, "steps", why);
}

} // namespace

HealthCheck check_gaps(const Evidence &e) {
  const Recording &c = e.what.recording;
  const TimeSteps &s = e.tally.steps;
  if (s.back > 0)
    return gaps_fault(static_cast<double>(s.back), 0, "steps",
                      fmt::format("time goes back or is no number: {} times, first at {}", s.back,
                                  moment(c, s.first_back)));
  if (s.standing > 0)
    return standing_time(e);
  if (e.usual_step_s < kShortestStep)
    return gaps_fault(e.usual_step_s, kShortestStep, "s",
                      fmt::format("time grows by {:.3g} s a sample, less than a recording can tell",
                                  e.usual_step_s));
  if (c.meta().sample_rate_hz && !times_follow_rate(e.capture))
    return gaps_fault(
        e.usual_step_s, kAbsent, "s",
        fmt::format("time grows by {:.3g} s a sample, but sample_rate_hz says {:.3g} s: "
                    "one of them is wrong",
                    e.usual_step_s, 1 / *c.meta().sample_rate_hz));
  constexpr double kCountable = 9007199254740992.0; // 2^53: beyond, a number of samples is none
  const std::string missing = s.lost < kCountable
                                  ? fmt::format("about {:.0f} samples are missing", s.lost)
                                  : "samples are missing, too many to count";
  return verdict("gaps", s.gaps == 0, static_cast<double>(s.gaps), 0, "gaps",
                 s.gaps == 0
                     ? "no sample is missing"
                     : fmt::format("{}, the longest gap is {:.6g} s where {:.3g} s is usual",
                                   missing, s.longest_gap_s, e.usual_step_s));
}

} // namespace ada::health

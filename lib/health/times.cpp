// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/frame.h"
#include "base/robust.h"
#include "base/text.h"
#include "conversion/gap_detector.h"
#include "health/checks.h"
#include "health/criteria.h"
#include "recording/capture_file.h"

namespace ada::health {

namespace {

/// The steps of time from sample to sample.
struct Steps {
  std::size_t back = 0, first_back = 0;         ///< or no number
  std::size_t standing = 0, first_standing = 0; ///< the time of the sample before
  std::size_t gaps = 0;
  double usual_s = 0, longest_gap_s = 0, lost = 0;
};

Steps steps_of(const Capture &c) {
  Steps s;
  s.usual_s = median_step(c.time_s);
  GapDetector gap;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const bool reported = std::binary_search(c.gaps.begin(), c.gaps.end(), i);
    const bool seen = gap(c.time_s[i]);
    if (i == 0)
      continue;
    const double dt = c.time_s[i] - c.time_s[i - 1];
    if (dt == 0 && s.standing++ == 0)
      s.first_standing = i;
    if (!(dt >= 0) && s.back++ == 0)
      s.first_back = i;
    if (!seen && !reported)
      continue;
    ++s.gaps;
    s.lost += std::max(std::round(dt / s.usual_s) - 1, 0.0);
    s.longest_gap_s = std::max(s.longest_gap_s, dt);
  }
  return s;
}

HealthCheck fault(double measured, double limit, std::string unit, std::string explanation) {
  return verdict("gaps", false, measured, limit, std::move(unit), std::move(explanation));
}

/// Samples that share their time: all, so many that the times are rounded, or some.
HealthCheck standing_time(const Capture &c, const Steps &s) {
  const auto standing = static_cast<double>(s.standing), all = static_cast<double>(c.size());
  const double moments = all - standing;
  std::string why;
  if (s.standing + 1 == c.size())
    why = fmt::format("all samples have the same time, {}", moment(c, 0));
  else if (standing > moments)
    why = fmt::format("time is given in steps of {:.3g} s, with about {:.0f} samples to each: too "
                      "coarse to show missing samples, or any speed",
                      s.usual_s, all / moments);
  else
    why = fmt::format("time does not grow from sample to sample: {} times, first at {}", s.standing,
                      moment(c, s.first_standing));
  return fault(standing, 0, "steps", why);
}

} // namespace

HealthCheck check_gaps(const Evidence &e) {
  const Capture &c = e.capture;
  const Steps s = steps_of(c);
  if (s.back > 0)
    return fault(static_cast<double>(s.back), 0, "steps",
                 fmt::format("time goes back or is no number: {} times, first at {}", s.back,
                             moment(c, s.first_back)));
  if (s.standing > 0)
    return standing_time(c, s);
  if (s.usual_s < kShortestStep)
    return fault(
        s.usual_s, kShortestStep, "s",
        fmt::format("time grows by {:.3g} s a sample, less than a recording can tell", s.usual_s));
  if (c.meta.sample_rate_hz && !times_follow_rate(c))
    return fault(s.usual_s, kAbsent, "s",
                 fmt::format("time grows by {:.3g} s a sample, but sample_rate_hz says {:.3g} s: "
                             "one of them is wrong",
                             s.usual_s, 1 / *c.meta.sample_rate_hz));
  constexpr double kCountable = 9007199254740992.0; // 2^53: beyond, a number of samples is none
  const std::string missing = s.lost < kCountable
                                  ? fmt::format("about {:.0f} samples are missing", s.lost)
                                  : "samples are missing, too many to count";
  return verdict("gaps", s.gaps == 0, static_cast<double>(s.gaps), 0, "gaps",
                 s.gaps == 0
                     ? "no sample is missing"
                     : fmt::format("{}, the longest gap is {:.6g} s where {:.3g} s is usual",
                                   missing, s.longest_gap_s, s.usual_s));
}

} // namespace ada::health

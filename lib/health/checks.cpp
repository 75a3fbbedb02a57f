// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "health/checks.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/frame.h"
#include "base/plain_numbers.h"
#include "base/text.h"
#include "health/criteria.h"

namespace ada::health {

HealthCheck verdict(std::string id, bool passed, double measured, double limit, std::string unit,
                    const std::string &explanation) {
  return {std::move(id),   passed ? HealthState::passed : HealthState::failed,
          measured,        limit,
          std::move(unit), in_plain_numbers(explanation)};
}

HealthCheck cannot_tell(std::string id, const std::string &why) {
  return {std::move(id), HealthState::unknown, kAbsent, kAbsent, "", in_plain_numbers(why)};
}

HealthCheck failed_by(const Evidence &e, std::string id, const std::vector<RowRange> &rows,
                      const std::string &explanation) {
  HealthCheck out =
      verdict(std::move(id), false, static_cast<double>(rows_of(rows)), 0, "rows", explanation);
  for (const RowRange &r : rows)
    if (out.times_s.size() < kMostTimes)
      out.times_s.push_back(e.capture.time_s[r.first]);
  return out;
}

std::string no_figures(const Evidence &e) {
  if (!e.ellipse)
    return kNoCircle;
  if (e.stuck)
    return e.stuck->name + (e.stuck->name.find(' ') == std::string::npos ? " does" : " do") +
           " not follow the magnet";
  return {};
}

std::string moment(const Recording &recording, std::size_t sample) {
  const double time_s = recording.time_s(sample);
  return std::isfinite(time_s) ? moment_text(time_s) : fmt::format("sample {}", sample);
}

bool too_many(const Faults &faults, std::size_t samples) {
  const double allowed =
      std::max(static_cast<double>(kFewFaulty), kMaxFaultyFraction * static_cast<double>(samples));
  return static_cast<double>(faults.count) > allowed || faults.longest > kMaxFaultyRow;
}

} // namespace ada::health

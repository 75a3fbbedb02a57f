// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/soundness.h"

#include <algorithm>
#include <string_view>

#include "common/print.h"

namespace cli {

namespace {

/// The lines of a check's report, NAME STATE SENTENCE, whose state says so.
std::string what_failed(std::string_view report) {
  std::string out;
  while (!report.empty()) {
    const std::string_view line = report.substr(0, report.find('\n'));
    const std::size_t state = line.find_first_not_of(' ', line.find(' '));
    if (state != line.npos && line.substr(state).starts_with("failed "))
      out.append(line).append("\n");
    report.remove_prefix(std::min(report.size(), line.size() + 1));
  }
  return out;
}

} // namespace

void warn_of_faults(const Recording &capture, const std::string &path) {
  const auto health =
      make<Health>(ada4571_check, capture.get(), static_cast<const ada4571_model *>(nullptr));
  if (ada4571_health_sound(health.get()))
    return;
  const std::string failed = what_failed(ada4571_health_text(health.get()));
  if (failed.empty()) // too little to judge by
    note("whether {0} is sound cannot be told: see `iio-angle check {0}`\n", path);
  else
    note("but {0} is not sound: see `iio-angle check {0}`\n", path);
  remark(failed);
}

} // namespace cli

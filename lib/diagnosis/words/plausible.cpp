// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/words/plausible.h"

#include <algorithm>
#include <array>

namespace ada {

namespace {

/// Whether the check is one of the volts as such, which offsets and amplitude of the model follow
/// wherever they lie.
bool is_of_the_scale(const std::string &id) {
  constexpr std::array<std::string_view, 3> kScale{"range", "supply", "amplitude"};
  return std::find(kScale.begin(), kScale.end(), id) != kScale.end();
}

} // namespace

void add_checks(Diagnosis &diagnosis, const Health &health, const std::string &which) {
  for (const HealthCheck &check : health.checks) {
    if (check.state != HealthState::failed)
      continue;
    diagnosis.failed_checks.push_back({check.id, which + check.explanation});
    if (diagnosis.verdict != Verdict::no_discrepancy)
      continue;
    if (is_of_the_scale(check.id))
      diagnosis.reason = "the model fits, but " + which + check.explanation;
    else if (check.id == "rotation" && !diagnosis.by_reference()) // a scatter has no discrepancy
      diagnosis.reason = which + check.explanation;
    else
      continue;
    diagnosis.verdict = Verdict::insufficient_data;
  }
}

} // namespace ada

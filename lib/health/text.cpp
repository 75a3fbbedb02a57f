// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "health/health.h"

namespace ada {

namespace {

const char *state_name(HealthState state) {
  switch (state) {
  case HealthState::passed:
    return "passed";
  case HealthState::failed:
    return "failed";
  case HealthState::unknown:
    break;
  }
  return "unknown";
}

/// The verdict in words: "sound" only where everything was judged. Noise that nothing states is no
/// gap in the judgement.
std::string closing_line(const Health &health) {
  std::size_t failed = 0;
  std::vector<std::string> open;
  for (const HealthCheck &check : health.checks) {
    failed += check.state == HealthState::failed;
    if (check.state == HealthState::unknown && check.id != "noise")
      open.push_back(check.id);
  }
  if (failed > 0)
    return fmt::format("NOT sound: {} failed", failed);
  if (health.too_few)
    return "not judged: too few samples";
  if (!open.empty())
    return fmt::format("no fault seen, but this capture cannot show: {}", fmt::join(open, ", "));
  return "sound";
}

} // namespace

std::string health_json(const Health &health) {
  nlohmann::ordered_json json;
  json["schema"] = "ada4571-check/1";
  json["sound"] = health.sound();
  json["against"] = health.against;
  json["checks"] = nlohmann::ordered_json::array();
  for (const HealthCheck &check : health.checks) {
    nlohmann::ordered_json entry;
    entry["id"] = check.id;
    entry["state"] = state_name(check.state);
    if (std::isfinite(check.measured))
      entry["measured"] = check.measured;
    if (std::isfinite(check.limit))
      entry["limit"] = check.limit;
    if (!check.unit.empty())
      entry["unit"] = check.unit;
    entry["explanation"] = check.explanation;
    if (!check.times_s.empty())
      entry["times_s"] = check.times_s;
    json["checks"].push_back(std::move(entry));
  }
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string health_text(const Health &health) {
  std::string text = fmt::format("compared with {}\n", health.against);
  for (const HealthCheck &check : health.checks)
    fmt::format_to(std::back_inserter(text), "{:<9} {:<8} {}\n", check.id, state_name(check.state),
                   check.explanation);
  return text + closing_line(health) + "\n";
}

} // namespace ada

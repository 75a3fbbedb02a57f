// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "diagnosis/health.h"

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
    json["checks"].push_back(std::move(entry));
  }
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string health_text(const Health &health) {
  std::string text = fmt::format("compared with {}\n", health.against);
  std::size_t failed = 0;
  for (const HealthCheck &check : health.checks) {
    fmt::format_to(std::back_inserter(text), "{:<9} {:<8} {}\n", check.id, state_name(check.state),
                   check.explanation);
    failed += check.state == HealthState::failed;
  }
  text += failed == 0 ? "sound\n" : fmt::format("NOT sound: {} failed\n", failed);
  return text;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "capi/long_capture.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "capi/to_fit.h"
#include "health/health.h"
#include "motion/followed_gaps.h"
#include "recording/spread_sample.h"

namespace ada::capi {

namespace {

constexpr std::size_t kMost = std::size_t{1} << 20, kStretch = std::size_t{1} << 15;

std::string explanation(const Health &health, std::string_view id) {
  for (const HealthCheck &check : health.checks)
    if (check.id == id)
      return check.explanation;
  return "not told";
}

} // namespace

std::shared_ptr<const Capture> LookedAt::part_of(const ada4571_recording &handle) {
  const Recording &recording = *handle.impl;
  if (recording.size() <= kMost)
    return recording.whole();
  const Health health = check_health(to_fit(handle), nullptr);
  long_.push_back({kMost, recording.size(), kMost / kStretch, explanation(health, "spikes"),
                   explanation(health, "gaps")});
  const auto part = std::make_shared<Capture>(*spread_sample(recording, kMost, kStretch, true));
  std::vector<LeftOut> left_out;
  for (std::size_t gap : part->gaps)
    left_out.push_back({sample_place(recording.size(), kMost, kStretch, gap - 1),
                        sample_place(recording.size(), kMost, kStretch, gap)});
  part->turned_rad = turned_in(recording, RoughCircle(*part), left_out);
  return part;
}

std::string LookedAt::text() const {
  std::string text;
  for (const Long &l : long_)
    text += fmt::format("\nlooked at: {} of {} samples, in {} stretches from everywhere; in all of "
                        "it: {}; {}\n",
                        l.samples, l.of_samples, l.stretches, l.spikes, l.gaps);
  return text;
}

std::string LookedAt::with_json(const std::string &json) const {
  if (long_.empty())
    return json;
  auto result = nlohmann::ordered_json::parse(json);
  for (const Long &l : long_)
    result["looked_at"].push_back({{"samples", l.samples},
                                   {"of_samples", l.of_samples},
                                   {"stretches", l.stretches},
                                   {"spikes_in_all", l.spikes},
                                   {"gaps_in_all", l.gaps}});
  return result.dump(1);
}

} // namespace ada::capi

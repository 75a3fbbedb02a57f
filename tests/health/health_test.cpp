// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "health/health.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "base/error.h"
#include "support/health.h"
#include "support/seed.h"
#include "support/wild.h"

namespace ada::test {
namespace {

class WildCheck : public testing::TestWithParam<std::tuple<std::size_t, double>> {};

TEST_P(WildCheck, counts_spikes_says_where_and_stays_sound) {
  const auto [count, rpm] = GetParam();
  const std::uint64_t seed = fresh_seed();
  const SensorPair pair;
  Capture c = Sampler(pair, seed).capture(10000, 7, constant_speed(rpm / 60));
  std::mt19937_64 rng(seed);
  const std::vector<std::size_t> places = add_wild(c, count, rng);
  const Health health = check_health(c, nullptr);
  EXPECT_TRUE(health.sound()) << health_text(health);
  const HealthCheck &spikes = find(health, "spikes");
  // Every one that is off the circle by twenty times the noise.
  std::size_t told = 0;
  for (const std::size_t i : places) {
    const double radius =
        std::hypot(c.vsin_v[i] - 2.5 - pair.offset_sin_v, c.vcos_v[i] - 2.5 - pair.offset_cos_v);
    const bool found = std::count(spikes.times_s.begin(), spikes.times_s.end(), c.time_s[i]) > 0;
    told += found;
    if (std::abs(radius - pair.amplitude_v) > 20 * pair.noise_rms_v) {
      EXPECT_TRUE(found) << "sample " << i;
    }
  }
  // Noise alone passes for a spike in one capture of some 500: two in one are no chance.
  EXPECT_LE(spikes.times_s.size(), told + 1) << spikes.explanation;
  EXPECT_EQ(static_cast<double>(spikes.times_s.size()), spikes.measured);
}

INSTANTIATE_TEST_SUITE_P(Speeds, WildCheck,
                         testing::Combine(testing::Values(1u, 3u, 30u),
                                          testing::Values(10.0, 60.0, 3000.0)),
                         [](const auto &i) {
                           return std::to_string(std::get<0>(i.param)) + "_samples_at_" +
                                  std::to_string(static_cast<int>(std::get<1>(i.param))) + "_rpm";
                         });

TEST(Check, names_the_channel_that_is_stuck) {
  const std::uint64_t seed = fresh_seed();
  Sampler sampler(SensorPair{}, seed);
  for (int draw = 0; draw < 10; ++draw)
    for (const bool sine : {true, false}) {
      // Two electrical periods and more are left: on a short arc the other channel hardly moves.
      const double rpm = sampler.uniform(60, 2000), from = sampler.uniform(0.1, 0.7);
      Capture c = sampler.capture(5000, 4, constant_speed(rpm / 60));
      auto &column = sine ? c.vsin_v : c.vcos_v;
      const auto first = static_cast<std::size_t>(from * static_cast<double>(c.size()));
      const double held = column[first];
      for (std::size_t i = first; i < c.size(); ++i)
        column[i] = held + sampler.noise(0.0005);
      const Health health = check_health(c, nullptr);
      EXPECT_FALSE(health.sound());
      const HealthCheck &stuck = find(health, "stuck");
      EXPECT_EQ(stuck.state, HealthState::failed);
      EXPECT_EQ(stuck.explanation.substr(0, 4), sine ? "VSIN" : "VCOS")
          << rpm << " rpm from " << from << ": " << health_text(health);
      const HealthCheck &clipping = find(health, "clipping"); // may not accuse the other one
      EXPECT_NE(clipping.state, HealthState::passed);
      if (clipping.state == HealthState::failed) {
        EXPECT_EQ(clipping.explanation.substr(0, 4), sine ? "VSIN" : "VCOS");
      }
    }
}

TEST(Check, says_of_a_magnet_at_rest_what_it_cannot_tell) {
  const Capture c = Sampler(SensorPair{}, fresh_seed()).capture(5000, 1, constant_speed(0));
  const Health health = check_health(c, nullptr);
  EXPECT_TRUE(health.sound());
  for (const char *id : {"clipping", "stuck", "short", "rotation", "amplitude"})
    EXPECT_EQ(find(health, id).state, HealthState::unknown) << id;
  EXPECT_NE(health_text(health).find("\nno fault seen, but this capture cannot show: "),
            std::string::npos);
}

TEST(Check, never_calls_too_few_samples_sound) {
  Sampler sampler(SensorPair{}, fresh_seed());
  for (const std::size_t n : {1u, 2u, 7u, 19u}) {
    const Capture c = sampler.capture(static_cast<double>(n), 1, constant_speed(0.9));
    ASSERT_EQ(c.size(), n);
    const Health health = check_health(c, nullptr);
    EXPECT_FALSE(health.sound());
    EXPECT_NE(health_text(health).find("not judged: too few samples"), std::string::npos);
  }
  EXPECT_THROW(check_health(Capture(), nullptr), Error);
}

TEST(Check, a_row_of_faulty_samples_is_a_fault_and_no_spike) {
  Capture c = Sampler(SensorPair{}, fresh_seed()).capture(10000, 7, constant_speed(5));
  for (std::size_t i = 30000; i < 30005; ++i)
    c.vsin_v[i] = 0;
  const Health health = check_health(c, nullptr);
  EXPECT_EQ(find(health, "rails").state, HealthState::failed);
  EXPECT_NE(find(health, "rails").explanation.find("from 3 s"), std::string::npos);
}

TEST(Check, reports_in_json_what_it_says_in_words) {
  Capture c = Sampler(SensorPair{}, fresh_seed()).capture(10000, 1, constant_speed(5));
  c.vsin_v[5000] = 999999;
  const std::string json = health_json(check_health(c, nullptr));
  EXPECT_NE(json.find("\"sound\": true"), std::string::npos) << json;
  EXPECT_NE(json.find("\"times_s\": [\n    0.5\n"), std::string::npos) << json;
}

} // namespace
} // namespace ada::test

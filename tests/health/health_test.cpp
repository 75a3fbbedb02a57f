// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "health/health.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "base/error.h"
#include "base/text.h"
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

/// A wild sample at a slow turn may lie as far ahead as makes the mean step after it that before it
/// backwards, and so may two near each other: they are spikes, and the channels are what they were.
TEST(Check, a_spike_ahead_of_the_turn_is_no_reversal) {
  const SensorPair pair;
  Sampler sampler(pair, fresh_seed());
  for (int draw = 0; draw < 40; ++draw) {
    const double rpm = sampler.uniform(5, 20);
    Capture c = sampler.capture(10000, 7, constant_speed(rpm / 60));
    double first = 0;
    for (int wild = 0; wild < 30; ++wild) {
      const bool second = wild % 2 != 0;
      first = second ? first + sampler.uniform(1, 9) : sampler.uniform(0, 69990);
      const auto place = static_cast<std::size_t>(first);
      const double steps = sampler.uniform(14, 18); // twice the eight whose mean is looked at
      sampler.pair_at(constant_speed(rpm / 60)(c.time_s[place] + steps / 10000),
                      pair.vtemp_reference_v, c.vsin_v[place], c.vcos_v[place]);
    }
    const Health health = check_health(c, nullptr);
    EXPECT_TRUE(health.sound()) << rpm << " rpm\n" << health_text(health);
  }
}

/// Wild samples in a row: how many, and what they are times their distance from the middle.
class WildRow : public testing::TestWithParam<std::tuple<std::size_t, double>> {};

TEST_P(WildRow, is_counted_and_placed_wherever_it_is) {
  const auto [count, size] = GetParam();
  const SensorPair pair;
  Sampler sampler(pair, fresh_seed());
  for (const double rpm : {30.0, 60.0, 3000.0}) {
    const Capture sound = sampler.capture(10000, 2, constant_speed(rpm / 60));
    const std::size_t n = sound.size();
    for (const std::vector<std::size_t> &begins : std::vector<std::vector<std::size_t>>{
             {0}, {1}, {n / 3}, {n - count - 1}, {n - count}, {0, n - count}}) {
      Capture c = sound;
      std::vector<double> times;
      for (const std::size_t begin : begins)
        for (std::size_t i = begin; i < begin + count; ++i) {
          c.vsin_v[i] = 2.5 + size * (c.vsin_v[i] - 2.5);
          c.vcos_v[i] = 2.5 + size * (c.vcos_v[i] - 2.5);
          times.push_back(c.time_s[i]);
        }
      const Health health = check_health(c, nullptr);
      SCOPED_TRACE(std::to_string(rpm) + " rpm, from sample " + std::to_string(begins[0]) + "\n" +
                   health_text(health));
      const HealthCheck &spikes = find(health, "spikes");
      EXPECT_EQ(spikes.times_s, times);
      EXPECT_EQ(spikes.measured, static_cast<double>(times.size()));
      EXPECT_EQ(spikes.state, count <= 4 ? HealthState::passed : HealthState::failed);
      EXPECT_EQ(health.sound(), count <= 4);
      const HealthCheck &range = find(health, "range");
      EXPECT_EQ(range.explanation.find(" but for ") != std::string::npos, size > 1000);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, WildRow,
                         testing::Combine(testing::Values(1u, 2u, 3u, 4u, 5u, 10u, 20u),
                                          testing::Values(0.0, 0.8, 0.92, 1.08, 1.25, 7e5)));

/// The same in a column beside the pair.
struct WildColumn {
  const char *name; ///< in the sentence
  std::vector<double> Capture::*values;
};

class WildBesideThePair : public testing::TestWithParam<WildColumn> {};

TEST_P(WildBesideThePair, is_counted_and_placed) {
  const auto &[name, values] = GetParam();
  const std::uint64_t seed = fresh_seed();
  Sampler sampler(SensorPair{}, seed);
  std::mt19937_64 rng(seed);
  for (const double rpm : {30.0, -3000.0}) {
    Capture sound =
        sampler.capture(10000, 2, constant_speed(rpm / 60), [](double t) { return 25 + 20 * t; });
    for (std::size_t i = 0; i < sound.size(); ++i) {
      sound.vdd_v.push_back(5 + sampler.noise(1e-4));
      sound.reference_deg[i] += 0.2 * std::sin(kRadPerDeg * sound.reference_deg[i]);
    }
    const std::size_t n = sound.size();
    EXPECT_EQ(find(check_health(sound, nullptr), "spikes").explanation, "no sample stands out");
    for (const std::size_t count : {1u, 3u, 30u})
      for (const std::size_t begin : {std::size_t{0}, 100 + below(rng, n / 2), n - count})
        for (const double wild : {1e5, -7.0, sampler.uniform(-1e6, 1e6)}) {
          Capture c = sound;
          for (std::size_t i = begin; i < begin + count; ++i)
            // In a row the reference is off by as much, wherever it stands and however far it
            // turns.
            (c.*values)[i] = values == &Capture::reference_deg
                                 ? (c.*values)[i] + 20 + std::fmod(std::abs(wild), 140)
                                 : wild;
          const Health health = check_health(c, nullptr);
          EXPECT_TRUE(
              find(health, "spikes")
                  .explanation.starts_with("samples that stand out: " + std::to_string(count) +
                                           " in " + name + " (at " + moment_text(c.time_s[begin])))
              << wild << " from " << begin << "\n"
              << health_text(health);
          EXPECT_TRUE(health.sound() || find(health, "vtemp").state == HealthState::failed)
              << health_text(health);
        }
  }
}

INSTANTIATE_TEST_SUITE_P(Columns, WildBesideThePair,
                         testing::Values(WildColumn{"VTEMP", &Capture::vtemp_v},
                                         WildColumn{"VDD", &Capture::vdd_v},
                                         WildColumn{"the reference", &Capture::reference_deg}),
                         [](const auto &i) { return std::string(1, "vdr"[i.index]) + "_column"; });

/// An encoder that errs, or a magnet that slips, is no row of wild readings.
TEST(Check, an_error_of_the_reference_is_no_spike) {
  Sampler sampler(SensorPair{}, fresh_seed());
  for (const double rpm : {20.0, 600.0, 6000.0}) {
    const Capture sound = sampler.capture(10000, 2, constant_speed(rpm / 60));
    const double slip = sampler.uniform(-90, 90), eccentric = sampler.uniform(0.5, 3);
    for (const auto &change : std::vector<std::function<double(double, std::size_t)>>{
             [&](double deg, std::size_t i) { return i < sound.size() / 2 ? deg : deg + slip; },
             [&](double deg, std::size_t) { return deg + eccentric * std::sin(kRadPerDeg * deg); },
             [](double deg, std::size_t) { return std::floor(deg); },
             [](double deg, std::size_t) { return -deg; },
             [](double deg, std::size_t) { return std::fmod(deg, 360); }}) {
      Capture c = sound;
      for (std::size_t i = 0; i < c.size(); ++i)
        c.reference_deg[i] = change(c.reference_deg[i], i);
      EXPECT_EQ(find(check_health(c, nullptr), "spikes").explanation, "no sample stands out")
          << rpm << " rpm, slip " << slip << ", eccentric " << eccentric;
    }
  }
}

TEST(Check, counts_what_is_wild_also_where_it_is_not_rare) {
  const std::pair<double, std::string> cases[] = {
      {5.0, "off the circle by more than 5 % of its radius"},
      {0.0, "beyond the supply"}}; // no circle
  for (const auto &[speed, where] : cases) {
    Capture c = Sampler(SensorPair{}, fresh_seed()).capture(1000, 0.5, constant_speed(speed));
    for (std::size_t i = 0; i < 30; ++i)
      c.vsin_v[16 * i] = i % 2 ? 1e6 : -1e6;
    const Health health = check_health(c, nullptr);
    EXPECT_FALSE(health.sound());
    EXPECT_EQ(find(health, "spikes").measured, 30) << health_text(health);
    EXPECT_EQ(find(health, "spikes").explanation,
              "30 samples lie " + where + ", the first at 0 s: too many to be single ones");
  }
}

TEST(Check, says_of_the_rails_and_the_range_what_does_not_hold_for_single_samples) {
  for (const double rpm : {0.0, 300.0}) {
    Capture c = Sampler(SensorPair{}, fresh_seed()).capture(10000, 1, constant_speed(rpm / 60));
    c.vsin_v[0] = c.vsin_v[1] = 0;
    c.vcos_v[c.size() - 1] = 1e6;
    const Health health = check_health(c, nullptr);
    EXPECT_TRUE(health.sound()) << health_text(health);
    EXPECT_EQ(find(health, "rails").explanation, "no channel sits at a rail but for 2 samples");
    EXPECT_EQ(find(health, "range").explanation,
              "both channels stay within the supply of 5 V but for a single sample");
    EXPECT_EQ(find(health, "spikes").measured, 3) << health_text(health);
  }
}

TEST(Check, noise_in_steps_of_a_converter_is_no_spike) {
  Sampler sampler(SensorPair{}, fresh_seed());
  for (int draw = 0; draw < 20; ++draw) {
    Capture c = sampler.capture(10000, 1, constant_speed(1));
    const double step = 5.0 / 65536, noise_steps = sampler.uniform(0.1, 5);
    for (auto *column : {&c.vtemp_v, &c.vdd_v})
      for (std::size_t i = 0; i < c.size(); ++i)
        column->push_back(step * std::round(sampler.noise(noise_steps) +
                                            (column == &c.vdd_v ? 5.0 : 1.6) / step));
    const std::string said = find(check_health(c, nullptr), "spikes").explanation;
    EXPECT_EQ(said.find("VTEMP"), std::string::npos) << noise_steps << " steps: " << said;
    EXPECT_EQ(said.find("VDD"), std::string::npos) << noise_steps << " steps: " << said;
  }
}

TEST(Check, a_distortion_that_moves_faster_than_the_noise_is_no_spike) {
  const SensorPair pair;
  for (const double rpm : {600.0, 1500.0, 3000.0}) {
    Capture c = Sampler(pair, fresh_seed()).capture(10000, 2, constant_speed(rpm / 60));
    for (std::size_t i = 0; i < c.size(); ++i) {
      const double psi = std::atan2(c.vsin_v[i] - 2.5, c.vcos_v[i] - 2.5);
      c.vsin_v[i] += 0.015 * std::sin(3 * psi);
      c.vcos_v[i] += 0.015 * std::cos(3 * psi);
    }
    EXPECT_EQ(find(check_health(c, nullptr), "spikes").explanation, "no sample stands out");
  }
}

TEST(Check, crests_of_an_offset_that_turns_at_changing_speed_are_no_spikes) {
  const std::uint64_t seed = fresh_seed();
  Sampler sampler(SensorPair{}, seed);
  for (int draw = 0; draw < 10; ++draw) {
    const double slow = sampler.uniform(0.5, 2), fast = sampler.uniform(1.1, 5) * slow;
    Capture c = sampler.capture(100, 600, [&](double t) {
      return 2 * std::numbers::pi * (slow * t + (fast - slow) * t * t / 1200);
    });
    for (std::size_t i = 0; i < c.size(); ++i) // what warms up by the end
      c.vsin_v[i] += 0.04 * (c.time_s[i] / 600 - 0.5);
    const HealthCheck check = find(check_health(c, nullptr), "spikes");
    EXPECT_EQ(check.state, HealthState::passed) << "seed " << seed;
    EXPECT_LE(check.measured, 3) << check.explanation << "; " << slow << " to " << fast
                                 << " turns a second, seed " << seed;
  }
}

TEST(Check, noise_of_two_sizes_is_no_row_of_spikes) {
  const std::uint64_t seed = fresh_seed();
  Sampler sampler(SensorPair{}, seed);
  for (int draw = 0; draw < 10; ++draw) {
    const double often = sampler.uniform(0.1, 0.5), times = sampler.uniform(2, 5);
    Capture c = sampler.capture(2000, 2.5, constant_speed(1));
    for (auto *column : {&c.vsin_v, &c.vcos_v})
      for (double &v : *column)
        v += sampler.noise(sampler.uniform(0, 1) < often ? times * 0.001 : 0.001);
    const HealthCheck check = find(check_health(c, nullptr), "spikes");
    // Of the tenth that is four times as noisy 0.6 % reach 2.8 of its sigmas, which is twice what
    // one in sixty of all exceeds: three samples in this capture.
    EXPECT_EQ(check.state, HealthState::passed);
    EXPECT_LE(check.measured, 10) << check.explanation << "; " << often << " of the samples "
                                  << times << " times, seed " << seed;
  }
}

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

/// A channel that stands still bends the circle that its figures are measured on: none of the
/// others is at fault.
TEST(Check, accuses_nothing_else_of_what_a_stuck_channel_does) {
  Sampler sampler(SensorPair{}, fresh_seed());
  for (int draw = 0; draw < 20; ++draw)
    for (const bool sine : {true, false}) {
      const double rpm = sampler.uniform(60, 2000), from = sampler.uniform(0.02, 0.9);
      Capture c = sampler.capture(2000, 3, constant_speed(rpm / 60));
      c.meta.noise_rms_v = SensorPair().noise_rms_v;
      c.meta.adc_bits = 16;
      c.meta.adc_reference_v = 5.0;
      auto &column = sine ? c.vsin_v : c.vcos_v;
      const auto first = static_cast<std::size_t>(from * static_cast<double>(c.size()));
      std::fill(column.begin() + static_cast<std::ptrdiff_t>(first), column.end(), column[first]);
      const Health health = check_health(c, nullptr);
      EXPECT_EQ(find(health, "stuck").state, HealthState::failed) << health_text(health);
      for (const char *id :
           {"supply", "amplitude", "clipping", "short", "numbers", "gaps", "reference"}) {
        EXPECT_NE(find(health, id).state, HealthState::failed)
            << rpm << " rpm from " << from << ": " << health_text(health);
      }
    }
}

/// Of a few degrees of the circle nobody knows where its middle is.
TEST(Check, does_not_judge_the_supply_by_a_short_arc) {
  Sampler sampler(SensorPair{}, fresh_seed());
  for (int draw = 0; draw < 40; ++draw) {
    const double turns = sampler.uniform(0.01, 0.1); // electrical ones are twice that
    const Capture c = sampler.capture(2000, 1, constant_speed(turns));
    const HealthCheck supply = find(check_health(c, nullptr), "supply");
    EXPECT_NE(supply.state, HealthState::failed) << turns << " turns: " << supply.explanation;
  }
}

TEST(Check, names_both_channels_where_both_keep_one_value) {
  const Capture sound = Sampler(SensorPair{}, fresh_seed()).capture(10000, 1, constant_speed(2));
  const auto told = [&](double vsin, double vcos, std::size_t first) {
    Capture c = sound;
    c.meta.noise_rms_v = SensorPair().noise_rms_v;
    c.meta.adc_bits = 16;
    c.meta.adc_reference_v = 5.0;
    for (std::size_t i = first; i < c.size(); ++i) {
      c.vsin_v[i] = std::isnan(vsin) ? c.vsin_v[i] : vsin;
      c.vcos_v[i] = std::isnan(vcos) ? c.vcos_v[i] : vcos;
    }
    const Health health = check_health(c, nullptr);
    EXPECT_EQ(find(health, "stuck").state, HealthState::failed) << health_text(health);
    return find(health, "stuck").explanation;
  };
  for (const double value : {0.0, 5e-324, 1e-150, 2.5, -0.0, 1e6})
    for (const std::size_t first : {0u, 3000u}) {
      const std::string both = told(value, value, first), sine = told(value, NAN, first);
      EXPECT_TRUE(both.starts_with("VSIN and VCOS ")) << both;
      EXPECT_NE(both.find(std::to_string(10000 - first) + " samples"), std::string::npos) << both;
      EXPECT_TRUE(sine.starts_with("VSIN without")) << sine;
      EXPECT_TRUE(told(NAN, value, first).starts_with("VCOS without"));
    }
}

TEST(Check, places_a_jump_of_vtemp) {
  Sampler sampler(SensorPair{}, fresh_seed());
  Capture c = sampler.capture(10000, 1, constant_speed(2));
  for (std::size_t i = 0; i < c.size(); ++i)
    c.vtemp_v.push_back((i < 4321 ? 1.5 : 1.7) + sampler.noise(0.0002));
  const HealthCheck check = find(check_health(c, nullptr), "vtemp");
  EXPECT_NE(check.explanation.find("first at 0.4321 s"), std::string::npos) << check.explanation;
}

TEST(Check, no_moment_is_minus_zero) {
  for (const double time_s : {0.0, -0.0, -1e-300, -4e-7})
    EXPECT_EQ(moment_text(time_s), "0 s");
  EXPECT_EQ(moment_text(-0.5), "-0.5 s");
  EXPECT_EQ(moment_text(-10), "-10 s");
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

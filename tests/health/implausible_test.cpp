// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What cannot be, at the supply and the converter that the capture states.

#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>

#include <gtest/gtest.h>

#include "support/health.h"
#include "support/seed.h"

namespace ada::test {
namespace {

struct Case {
  const char *name;
  const char *check; ///< that fails; NULL: sound
  std::function<void(Capture &, Sampler &)> change;
};

std::ostream &operator<<(std::ostream &out, const Case &c) {
  return out << c.name;
}

void scale(Capture &c, double gain, double offset) {
  for (auto *channel : {&c.vsin_v, &c.vcos_v})
    for (double &v : *channel)
      v = 2.5 + gain * (v - 2.5) + offset;
}

auto supply(double volts) {
  return [volts](Capture &c, Sampler &) { c.meta.supply_v = volts; };
}
auto scaled(double gain, double offset) {
  return [gain, offset](Capture &c, Sampler &) { scale(c, gain, offset); };
}

const Case kCases[] = {
    {"nothing", nullptr, [](Capture &, Sampler &) {}},
    {"supply_4_5", "supply", supply(4.5)},
    {"supply_5_25", nullptr, supply(5.25)},
    {"supply_6", "supply", supply(6)},
    {"supply_100", "supply", supply(100)},
    {"supply_2", "range", supply(2)},
    {"amplitude_30_mV", "amplitude", scaled(0.0207, 0)},
    {"amplitude_145_kV", "range", scaled(1e5, 0)},
    {"offset_200_V", "range", scaled(1, 200)},
    {"negative_volts", "range", scaled(1, -5)},
    {"about_zero", "range", scaled(1, -2.5)},
    {"converter_of_3_V", "range",
     [](Capture &c, Sampler &) {
       c.meta.adc_reference_v = 3;
       c.meta.adc_bits = 12;
     }},
    {"vdd_of_3_V", "supply", [](Capture &c, Sampler &) { c.vdd_v.assign(c.size(), 3.0); }},
    {"square_wave", "rotation",
     [](Capture &c, Sampler &) {
       for (std::size_t i = 0; i < c.size(); ++i) {
         const std::size_t quarter = i / 7 % 4;
         c.vsin_v[i] = quarter < 2 ? 1.5 : 3.5;
         c.vcos_v[i] = quarter == 1 || quarter == 2 ? 1.5 : 3.5;
       }
     }},
    {"reference_stands_still", "reference",
     [](Capture &c, Sampler &) { c.reference_deg.assign(c.size(), 17.0); }},
    {"reference_stands_still_but_for_a_few", "reference",
     [](Capture &c, Sampler &s) {
       c.reference_deg.assign(c.size(), 17.0);
       for (std::size_t k = 0; k < 3; ++k)
         c.reference_deg[k * 900] = s.uniform(0, 360);
     }},
    {"reference_stops_after_a_third", "reference",
     [](Capture &c, Sampler &) {
       const std::size_t third = c.size() / 3;
       std::fill(c.reference_deg.begin() + static_cast<std::ptrdiff_t>(third),
                 c.reference_deg.end(), c.reference_deg[third]);
     }},
    {"reference_of_another_shaft", "reference",
     [](Capture &c, Sampler &) {
       for (double &r : c.reference_deg)
         r = std::fmod(0.7 * r, 360);
     }},
    {"other_periods_per_turn", "reference",
     [](Capture &c, Sampler &) { c.meta.periods_per_turn = 1; }},
    {"reference_runs_the_other_way", nullptr,
     [](Capture &c, Sampler &) {
       for (double &r : c.reference_deg)
         r = 360 - r;
     }},
    {"reference_with_wild_values", nullptr,
     [](Capture &c, Sampler &s) {
       for (std::size_t k = 0; k < 3; ++k)
         c.reference_deg[k * 900] = s.uniform(0, 1e6);
     }},
    {"reference_turns_and_the_outputs_stand", "reference",
     [](Capture &c, Sampler &s) {
       for (auto *channel : {&c.vsin_v, &c.vcos_v})
         for (double &v : *channel)
           v = 2.5 + 1e-3 * s.uniform(-1, 1);
     }},
    {"uniform_noise", "rotation",
     [](Capture &c, Sampler &sampler) {
       for (auto *channel : {&c.vsin_v, &c.vcos_v})
         for (double &v : *channel)
           v = sampler.uniform(0, 5);
     }},
};

class Implausible : public testing::TestWithParam<Case> {};

TEST_P(Implausible, is_told) {
  const Case &what = GetParam();
  Sampler sampler(SensorPair{}, fresh_seed());
  Capture c = sampler.capture(5000, 2, constant_speed(3));
  what.change(c, sampler);
  const Health health = check_health(c, nullptr);
  EXPECT_EQ(health.sound(), what.check == nullptr) << health_text(health);
  if (what.check != nullptr) {
    EXPECT_EQ(find(health, what.check).state, HealthState::failed) << health_text(health);
  }
}

INSTANTIATE_TEST_SUITE_P(Captures, Implausible, testing::ValuesIn(kCases),
                         [](const auto &i) { return std::string(i.param.name); });

} // namespace
} // namespace ada::test

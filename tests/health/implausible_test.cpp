// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What cannot be, at the supply and the converter that the capture states.

#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "base/error.h"
#include "calibration/single.h"
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

/// Of 1.45 V about 2.5 V, by turns.
double triangle(double turns) {
  const double part = turns - std::floor(turns);
  return 2.5 + 1.45 * (part < 0.5 ? 4 * part - 1 : 3 - 4 * part);
}

/// A converter of so many bits and 5 V, with some wild samples.
std::function<void(Capture &, Sampler &)> in_steps(int bits, std::size_t wild) {
  return [bits, wild](Capture &c, Sampler &s) {
    c.meta.adc_bits = bits;
    c.meta.adc_reference_v = 5;
    const double step = 5 / std::exp2(bits);
    for (auto *channel : {&c.vsin_v, &c.vcos_v})
      for (double &v : *channel)
        v = step * std::round(v / step);
    for (std::size_t i = 0; i < wild; ++i)
      c.vsin_v[i * 999] = s.uniform(-1e6, 1e6);
  };
}

std::function<void(Capture &, Sampler &)> vtemp(std::function<double(double, Sampler &)> of_time) {
  return [of_time](Capture &c, Sampler &s) {
    for (const double t : c.time_s)
      c.vtemp_v.push_back(of_time(t, s));
  };
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
    {"triangles", "rotation",
     [](Capture &c, Sampler &s) {
       for (std::size_t i = 0; i < c.size(); ++i) {
         const double turns = 0.0041 * static_cast<double>(i);
         c.vsin_v[i] = triangle(turns) + s.noise(0.0005);
         c.vcos_v[i] = triangle(turns + 0.25) + s.noise(0.0005);
       }
     }},
    {"one_triangle", "rotation",
     [](Capture &c, Sampler &s) {
       for (std::size_t i = 0; i < c.size(); ++i) {
         const double turns = 0.0041 * static_cast<double>(i);
         c.vsin_v[i] = triangle(turns) + s.noise(0.0005);
         c.vcos_v[i] = 2.5 + 1.45 * std::cos(kTwoPi * turns) + s.noise(0.0005);
       }
     }},
    {"a_third_harmonic_of_a_weak_magnet", nullptr,
     [](Capture &c, Sampler &) {
       for (std::size_t i = 0; i < c.size(); ++i) {
         const double psi = std::atan2(c.vsin_v[i] - 2.5, c.vcos_v[i] - 2.5);
         c.vsin_v[i] += 0.04 * std::sin(3 * psi);
         c.vcos_v[i] += 0.04 * std::cos(3 * psi);
       }
     }},
    {"one_bit", "range", [](Capture &c, Sampler &) { c.meta.adc_bits = 1; }},
    {"eight_bits_of_more", "range", [](Capture &c, Sampler &) { c.meta.adc_bits = 8; }},
    {"eight_bits", nullptr, in_steps(8, 0)},
    {"twelve_bits", nullptr, in_steps(12, 0)},
    {"twelve_bits_and_wild_ones", nullptr, in_steps(12, 3)},
    {"vtemp", nullptr, vtemp([](double, Sampler &s) { return 1.58 + s.noise(0.0002); })},
    {"vtemp_that_warms", nullptr,
     vtemp([](double t, Sampler &s) { return 1.2 + 0.5 * t + s.noise(0.0002); })},
    {"vtemp_with_wild_ones", nullptr,
     [](Capture &c, Sampler &s) {
       vtemp([](double, Sampler &r) { return 1.58 + r.noise(0.0002); })(c, s);
       c.vtemp_v[0] = 1e6;
       for (std::size_t i = 5000; i < 5003; ++i)
         c.vtemp_v[i] = -7;
     }},
    {"vtemp_constant_to_a_wide_step", nullptr,
     [](Capture &c, Sampler &s) {
       in_steps(12, 0)(c, s);
       c.vtemp_v.assign(c.size(), 1.58);
     }},
    {"vtemp_constant", "vtemp",
     [](Capture &c, Sampler &s) {
       in_steps(16, 0)(c, s);
       c.vtemp_v.assign(c.size(), 1.58);
     }},
    {"vtemp_constant_but_for_wild_ones", "vtemp",
     [](Capture &c, Sampler &s) {
       in_steps(16, 0)(c, s);
       c.vtemp_v.assign(c.size(), 1.58);
       c.vtemp_v[0] = c.vtemp_v[700] = 3;
     }},
    {"vtemp_at_ground", "vtemp", vtemp([](double, Sampler &s) { return s.noise(0.0002); })},
    {"vtemp_at_vdd", "vtemp", vtemp([](double, Sampler &s) { return 5 + s.noise(0.0002); })},
    {"vtemp_noise", "vtemp", vtemp([](double, Sampler &s) { return s.uniform(0, 5); })},
    {"vtemp_noise_of_three_degrees", "vtemp",
     vtemp([](double, Sampler &s) { return 1.58 + s.noise(0.05); })},
    {"vtemp_square_wave", "vtemp", vtemp([](double t, Sampler &s) {
       return (std::fmod(t, 0.1) < 0.05 ? 1.2 : 2.0) + s.noise(0.0002);
     })},
    {"vtemp_square_wave_without_noise", "vtemp",
     vtemp([](double t, Sampler &) { return std::fmod(t, 0.7) < 0.3 ? 1.4 : 1.6; })},
    {"vtemp_fast_square_wave", "vtemp",
     vtemp([](double t, Sampler &) { return std::fmod(t, 0.0008) < 0.0004 ? 1.4 : 1.6; })},
    {"vtemp_that_steps_once", "vtemp",
     vtemp([](double t, Sampler &s) { return (t < 1.3 ? 1.5 : 1.7) + s.noise(0.0002); })},
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

/// What is wrong with a capture, and what is not: no other part is accused.
struct Innocent {
  const char *name;
  std::vector<const char *> failed; ///< any of these, and no others
  std::function<void(Capture &, Sampler &)> change;
};

void fill(Capture &c, const std::function<double(double)> &sin,
          const std::function<double(double)> &cos) {
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double turns = 3 * 2 * c.time_s[i];
    c.vsin_v[i] = sin(turns);
    c.vcos_v[i] = cos(turns);
  }
}

double wave(double turns) {
  return 2.5 + 1.45 * std::sin(kTwoPi * turns);
}
double saw(double turns) {
  return 2.5 + 2.9 * (turns - std::floor(turns) - 0.5);
}

/// Where a change of a channel moves the angle.
std::size_t place(Sampler &s, const std::function<double(std::size_t)> &moves_v) {
  for (;;)
    if (const auto i = static_cast<std::size_t>(s.uniform(200, 9800)); std::abs(moves_v(i)) > 0.3)
      return i;
}

const Innocent kInnocents[] = {
    {"noise_beside_a_sine",
     {"rotation", "radius", "rails"},
     [](Capture &c, Sampler &s) { fill(c, wave, [&](double) { return s.uniform(0, 5); }); }},
    {"noise_beside_a_cosine",
     {"rotation", "radius", "rails"},
     [](Capture &c, Sampler &s) {
       fill(
           c, [&](double) { return s.uniform(0, 5); }, wave);
     }},
    {"another_frequency",
     {"rotation", "radius"},
     [](Capture &c, Sampler &s) {
       const double times = s.uniform(2.2, 5);
       fill(
           c, [&](double t) { return wave(t) + s.noise(5e-4); },
           [&](double t) { return wave(times * t) + s.noise(5e-4); });
     }},
    {"saws",
     {"rotation", "radius", "clipping", "spikes"},
     [](Capture &c, Sampler &s) {
       fill(
           c, [&](double t) { return saw(t) + s.noise(5e-4); },
           [&](double t) { return saw(t + 0.25) + s.noise(5e-4); });
     }},
    {"levels",
     {"rotation", "radius"},
     [](Capture &c, Sampler &) {
       fill(
           c, [](double t) { return wave(t) > 2.5 ? 4.0 : 1.0; },
           [](double t) { return wave(t + 0.25) > 2.5 ? 4.0 : 1.0; });
     }},
    {"rest_at_equal_voltages_with_strays",
     {"spikes", "rotation", "radius", "reference"},
     [](Capture &c, Sampler &s) {
       const double at = 2.5 + 1.45 * std::sqrt(0.5);
       for (std::size_t i = 0; i < c.size(); ++i) {
         const double psi = s.uniform(0, kTwoPi);
         const bool stray = i % 60 == 0;
         c.vsin_v[i] = stray ? 2.5 + 1.45 * std::sin(psi) : at + s.noise(5e-4);
         c.vcos_v[i] = stray ? 2.5 + 1.45 * std::cos(psi) : at + s.noise(5e-4);
       }
     }},
    {"exchanged_half_way",
     {"rotation"},
     [](Capture &c, Sampler &s) {
       for (std::size_t i = place(s, [&](std::size_t at) { return c.vsin_v[at] - c.vcos_v[at]; });
            i < c.size(); ++i)
         std::swap(c.vsin_v[i], c.vcos_v[i]);
       c.reference_deg.clear();
     }},
    {"sine_inverted_half_way",
     {"rotation"},
     [](Capture &c, Sampler &s) {
       for (std::size_t i = place(s, [&](std::size_t at) { return c.vsin_v[at] - 2.5; });
            i < c.size(); ++i)
         c.vsin_v[i] = 5 - c.vsin_v[i];
       c.reference_deg.clear();
     }},
    {"cosine_inverted_half_way",
     {"rotation"},
     [](Capture &c, Sampler &s) {
       for (std::size_t i = place(s, [&](std::size_t at) { return c.vcos_v[at] - 2.5; });
            i < c.size(); ++i)
         c.vcos_v[i] = 5 - c.vcos_v[i];
       c.reference_deg.clear();
     }},
    {"far_off_quadrature",
     {"rotation", "radius"},
     [](Capture &c, Sampler &s) {
       const double off = s.uniform(35, 60) / 360;
       fill(
           c, [&](double t) { return wave(t + off) + s.noise(5e-4); },
           [&](double t) { return wave(t + 0.25) + s.noise(5e-4); });
       c.reference_deg.clear();
     }},
};

class WrongAccusation : public testing::TestWithParam<Innocent> {};

TEST_P(WrongAccusation, is_not_made) {
  const Innocent &what = GetParam();
  Sampler sampler(SensorPair{.offset_sin_v = 0, .offset_cos_v = 0}, fresh_seed());
  Capture c = sampler.capture(5000, 2, constant_speed(3));
  what.change(c, sampler);
  const Health health = check_health(c, nullptr);
  EXPECT_FALSE(health.sound()) << health_text(health);
  for (const HealthCheck &check : health.checks)
    if (check.state == HealthState::failed) {
      EXPECT_TRUE(std::any_of(what.failed.begin(), what.failed.end(),
                              [&](const char *id) { return check.id == id; }))
          << check.id << "\n"
          << health_text(health);
    }
  try {
    calibrate_single(c, CalibrationMethod::fit);
  } catch (const Error &e) {
    for (const char *word : {"stuck", "short"})
      EXPECT_EQ(std::string(e.what()).find(word), std::string::npos) << e.what();
  }
}

INSTANTIATE_TEST_SUITE_P(Captures, WrongAccusation, testing::ValuesIn(kInnocents),
                         [](const auto &i) { return std::string(i.param.name); });

/// A shaft may turn back as fast as shafts do, and a magnet may slip.
TEST(SenseOfRotation, changes_as_a_shaft_changes_it) {
  Sampler sampler(SensorPair{}, fresh_seed());
  for (const double rpm : {20.0, 600.0, 6000.0})
    for (const double back_s : {0.01, 0.1}) {
      const double w = kTwoPi * rpm / 60;
      const Capture c = sampler.capture(10000, 2, [&](double t) {
        return w * (t < 1 ? t : t < 1 + back_s ? t - (t - 1) * (t - 1) / back_s : 2 - t + back_s);
      });
      const Health health = check_health(c, nullptr);
      EXPECT_EQ(find(health, "rotation").state, HealthState::passed) << rpm << health_text(health);
    }
}

/// Of such a thing no calibration is right.
TEST(Calibrate, refuses_a_shape_and_a_supply_that_cannot_be) {
  Sampler sampler(SensorPair{}, fresh_seed());
  const Capture sound = sampler.capture(5000, 2, constant_speed(3));
  const auto why = [](const Capture &c) {
    std::string said;
    for (const auto method :
         {CalibrationMethod::fit, CalibrationMethod::mean, CalibrationMethod::extrema})
      try {
        calibrate_single(c, method);
        ADD_FAILURE() << method_name(method);
      } catch (const Error &e) {
        EXPECT_EQ(e.status(), ADA4571_ERROR_UNUSABLE_DATA);
        said = e.what();
      }
    return said;
  };
  Capture c = sound;
  fill(c, triangle, [](double t) { return triangle(t + 0.25); });
  EXPECT_NE(why(c).find("lie on no circle"), std::string::npos) << why(c);
  for (const double supply : {30.0, 100.0}) {
    c = sound;
    c.meta.supply_v = supply;
    EXPECT_NE(why(c).find("supply_v or the scale is wrong"), std::string::npos) << why(c);
  }
}

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

TEST(ImplausibleReference, is_told_with_the_periods_that_would_fit) {
  for (const int stated : {1, 3, 4}) {
    Sampler sampler(SensorPair{}, fresh_seed());
    Capture c = sampler.capture(5000, 2, constant_speed(3));
    c.meta.periods_per_turn = stated;
    const std::string said = find(check_health(c, nullptr), "reference").explanation;
    EXPECT_NE(said.find("makes 2 periods a turn"), std::string::npos) << said;
  }
}

INSTANTIATE_TEST_SUITE_P(Captures, Implausible, testing::ValuesIn(kCases),
                         [](const auto &i) { return std::string(i.param.name); });

} // namespace
} // namespace ada::test

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/dual.h"

#include <cmath>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "base/error.h"
#include "calibration/single.h"
#include "conversion/frame_converter.h"
#include "support/angle_error.h"
#include "support/effect_value.h"
#include "support/seed.h"
#include "support/sensor_pair.h"

namespace ada::test {
namespace {

SensorPair drifting_pair(Sampler &draw) {
  SensorPair pair;
  pair.offset_sin_v = draw.uniform(-0.1, 0.1);
  pair.offset_cos_v = draw.uniform(-0.1, 0.1);
  pair.tc_sin = draw.uniform(-0.02, 0.02); // up to 33 mV over 100 K
  pair.tc_cos = draw.uniform(-0.02, 0.02);
  pair.k = draw.uniform(-0.01, 0.01);
  pair.delta_rad = draw.uniform(-0.05, 0.05) * kRadPerDeg;
  return pair;
}

Capture at(const SensorPair &pair, double deg_c, std::uint64_t seed) {
  return Sampler(pair, seed).capture(10000, 3.0, swinging_speed(9.7, 0.4, 0.7), [=](double) {
    return deg_c;
  });
}

TEST(Dual, stays_within_the_limit_from_minus_20_to_100_degrees) {
  const std::uint64_t seed = fresh_seed();
  Sampler draw(SensorPair{}, seed);
  for (int i = 0; i < 4; ++i) {
    SensorPair pair = drifting_pair(draw);
    pair.tc_amplitude = i % 2 ? -0.18 : 0.0; // gain control off and on
    const Model model = calibrate_dual(at(pair, 0, seed + 10 + i), at(pair, 110, seed + 20 + i),
                                       CalibrationMethod::fit);
    Sampler sampler(pair, seed + 30 + i);
    const Capture test = sampler.capture(10000, 6.0, swinging_speed(17.0, 0.5, 0.37),
                                         [](double t) { return -20 + 20 * t; });
    std::vector<ada4571_angle> angles(test.size());
    FrameConverter(model).capture(test, angles);
    const double error = rms_error_deg(angles, test);
    // The floor grows as the amplitude falls with temperature.
    double floor = 0;
    for (const double v : test.vtemp_v)
      floor += std::pow(1 + pair.tc_amplitude * (v - pair.vtemp_reference_v), -2);
    floor = std::sqrt(floor / static_cast<double>(test.size()));
    std::printf("  dual: %.5f deg rms, mean noise gain %.3f\n", error, floor);
    EXPECT_LT(error, 0.0115 * floor);
    EXPECT_EQ(test::effect_value(model, "amplitude-temperature-drift", "tc_amplitude").has_value(),
              pair.tc_amplitude != 0);
  }
}

TEST(Dual, order_of_the_captures_does_not_matter) {
  SensorPair pair;
  pair.tc_sin = 0.01;
  const Capture cold = at(pair, 0, 1), hot = at(pair, 110, 2);
  const Model a = calibrate_dual(cold, hot, CalibrationMethod::fit);
  const Model b = calibrate_dual(hot, cold, CalibrationMethod::fit);
  EXPECT_NEAR(*test::effect_value(a, "offset-temperature-drift", "tc_sin"),
              *test::effect_value(b, "offset-temperature-drift", "tc_sin"), 1e-12);
  EXPECT_NEAR(*test::effect_value(a, "offset-temperature-drift", "tc_sin"), 0.01, 0.0001);
}

void expect_refusal(const Capture &cold, const Capture &hot, const std::string &reason) {
  try {
    calibrate_dual(cold, hot, CalibrationMethod::fit);
    ADD_FAILURE() << "not refused: " << reason;
  } catch (const Error &e) {
    EXPECT_EQ(e.status(), ADA4571_ERROR_UNUSABLE_DATA);
    EXPECT_NE(std::string(e.what()).find(reason), std::string::npos) << e.what();
  }
}

TEST(DualGuards, each_refuses_with_its_reason) {
  const SensorPair pair;
  const Capture cold = at(pair, 20, 1), near = at(pair, 25, 2), hot = at(pair, 80, 3);
  expect_refusal(cold, near, "too close");
  Capture blind = hot;
  blind.vtemp_v.clear();
  expect_refusal(cold, blind, "the hot capture: it has no VTEMP");
  Capture stranger = hot, known = cold;
  known.meta.serial = "A";
  stranger.meta.serial = "B";
  expect_refusal(known, stranger, "different sensors");
  Capture on = hot, off = cold;
  on.meta.gain_control = true;
  off.meta.gain_control = false;
  expect_refusal(off, on, "gain control");
  Capture short_arc = hot;
  for (auto *column : {&short_arc.time_s, &short_arc.vsin_v, &short_arc.vcos_v, &short_arc.vtemp_v,
                       &short_arc.reference_deg})
    column->resize(20);
  expect_refusal(cold, short_arc, "the hot capture: ");
}

TEST(Dual, a_capture_without_vtemp_cannot_be_converted) {
  SensorPair pair;
  pair.tc_sin = 0.01;
  const Model model = calibrate_dual(at(pair, 0, 1), at(pair, 110, 2), CalibrationMethod::fit);
  const Capture blind = Sampler(pair, 3).capture(1000, 0.1, constant_speed(5));
  std::vector<ada4571_angle> angles(blind.size());
  EXPECT_THROW(FrameConverter(model).capture(blind, angles), Error);
}

} // namespace
} // namespace ada::test

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <gtest/gtest.h>

#include "base/error.h"
#include "capi/driver_calibration.h"
#include "model/effect.h"

using namespace ada;

namespace {

DriverCalibration fresh_driver(double volts_per_count = 5.0 / 65536.0) {
  DriverCalibration c;
  c.sin = c.cos = {0.0, 1.0, volts_per_count};
  return c;
}

TEST(DriverCalibrationTest, OffsetsBecomeCountsAndAmplitudesBecomeScales) {
  Model model;
  model.baseline = {1.40, 0.05, -0.02, 0.0};
  model.effects.push_back({find_effect("amplitude-mismatch"), {0.02}, {}});
  const DriverCalibration c = driver_calibration_of(model, fresh_driver(0.001), 5.0);
  EXPECT_EQ(c.sin.bias, -50.0);
  EXPECT_EQ(c.cos.bias, 20.0);
  EXPECT_NEAR(*c.sin.scale, 1.45 / (1.40 * 1.01), 5e-7);
  EXPECT_NEAR(*c.cos.scale, 1.45 / (1.40 * 0.99), 5e-7);
}

TEST(DriverCalibrationTest, ACorrectedReadingIsCentredAndOfTheNominalAmplitude) {
  Model model;
  model.baseline = {1.38, 0.0371, -0.0123, 0.0};
  model.effects.push_back({find_effect("amplitude-mismatch"), {-0.013}, {}});
  const DriverCalibration c = driver_calibration_of(model, fresh_driver(), 5.0);
  const double lsb = 5.0 / 65536.0;
  const auto corrected = [&](double v, const DriverCalibration::Channel &ch) {
    return (v / lsb + *ch.bias) * lsb * *ch.scale; // about mid-supply, in volts
  };
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_NEAR(corrected(0.0371 + sign * 1.38 * (1 - 0.0065), c.sin), sign * 1.45, lsb);
    EXPECT_NEAR(corrected(-0.0123 + sign * 1.38 * (1 + 0.0065), c.cos), sign * 1.45, lsb);
  }
}

TEST(DriverCalibrationTest, WhatWasWrittenIsReadBackToHalfACount) {
  Model model;
  model.supply_v = 5.0;
  model.baseline = {1.38, 0.0371, -0.0123, 0.0};
  model.effects.push_back({find_effect("amplitude-mismatch"), {-0.013}, {}});
  const double supply = 3.3; // the model is ratiometric: another supply scales it
  const Model back = model_of(driver_calibration_of(model, fresh_driver(), supply), supply, 2);
  const double half_count = 0.5 * 5.0 / 65536.0;
  EXPECT_NEAR(back.baseline.offset_sin_v, 0.0371 * 3.3 / 5, half_count);
  EXPECT_NEAR(back.baseline.offset_cos_v, -0.0123 * 3.3 / 5, half_count);
  EXPECT_NEAR(back.baseline.amplitude_v, 1.38 * 3.3 / 5, 2e-6);
  ASSERT_EQ(back.effects.size(), 1u);
  EXPECT_NEAR(back.effects[0].values[0], -0.013, 3e-6);
  EXPECT_EQ(back.supply_v, supply);
}

TEST(DriverCalibrationTest, DefaultsAreNoCalibration) {
  try {
    model_of(fresh_driver(), 5.0, 2);
    FAIL();
  } catch (const Error &e) {
    EXPECT_EQ(e.status(), ADA4571_ERROR_NOT_FOUND);
  }
}

TEST(DriverCalibrationTest, AttributesThatTheDriverLacksStayAbsent) {
  DriverCalibration present = fresh_driver();
  present.sin.scale = present.cos.scale = std::nullopt;
  Model model;
  model.baseline.offset_sin_v = 0.1;
  const DriverCalibration c = driver_calibration_of(model, present, 5.0);
  EXPECT_FALSE(c.sin.scale);
  EXPECT_TRUE(c.sin.bias);
}

TEST(DriverCalibrationTest, ValuesWithoutSenseAreRefused) {
  DriverCalibration c = fresh_driver();
  c.sin.scale = -1.0;
  EXPECT_THROW(model_of(c, 5.0, 2), Error);
  Model model;
  model.baseline.amplitude_v = 0.0;
  EXPECT_THROW(driver_calibration_of(model, fresh_driver(), 5.0), Error);
}

} // namespace

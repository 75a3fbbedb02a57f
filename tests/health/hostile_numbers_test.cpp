// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Hostile numbers through check, calibrate and convert: each gives an answer or a reason, every
// number of an answer is one, and nothing goes on for ever.

#include <cmath>

#include <gtest/gtest.h>

#include "base/error.h"
#include "calibration/dual.h"
#include "calibration/single.h"
#include "conversion/frame_converter.h"
#include "health/health.h"
#include "support/hostile_numbers.h"
#include "support/seed.h"

namespace ada::test {
namespace {

class HostileNumbers : public testing::TestWithParam<Hostile> {};

void expect_sane(const Model &model) {
  const Baseline &b = model.baseline;
  EXPECT_TRUE(std::isfinite(b.amplitude_v + b.offset_sin_v + b.offset_cos_v));
  EXPECT_GT(b.amplitude_v, 0);
  for (const EffectInstance &e : model.effects)
    for (std::size_t i = 0; i < e.values.size(); ++i) {
      EXPECT_TRUE(std::isfinite(e.values[i]));
      EXPECT_TRUE(std::isfinite(e.std_errors[i]) && e.std_errors[i] >= 0) << e.std_errors[i];
    }
}

/// Runs it; a refusal with a sentence is as good as an answer, but the caller did nothing wrong.
template <class Work> void answer_or_reason(Work work) {
  try {
    work();
  } catch (const Error &e) {
    EXPECT_EQ(e.status(), ADA4571_ERROR_UNUSABLE_DATA) << e.what();
    EXPECT_STRNE(e.what(), "");
  }
}

TEST_P(HostileNumbers, get_an_answer_or_a_reason) {
  std::mt19937_64 rng(fresh_seed());
  Capture sound = hostile_capture(Hostile::constant, 0, 2000, rng);
  for (const std::size_t samples : {40u, 2000u})
    for (unsigned columns = 1; columns < 64; ++columns) {
      SCOPED_TRACE("columns " + std::to_string(columns));
      const Capture c = hostile_capture(GetParam(), columns, samples, rng);
      answer_or_reason([&] {
        const Health health = check_health(c, nullptr);
        EXPECT_EQ(health_text(health).find("nan"), std::string::npos) << health_text(health);
        EXPECT_EQ(health_json(health).find("nan"), std::string::npos);
      });
      for (const auto method :
           {CalibrationMethod::fit, CalibrationMethod::mean, CalibrationMethod::extrema})
        answer_or_reason([&] {
          const Model model = calibrate_single(c, method);
          expect_sane(model);
          std::vector<ada4571_angle> angles(c.size());
          FrameConverter(model).capture(c, angles);
          for (const ada4571_angle &a : angles)
            EXPECT_TRUE(std::isfinite(a.angle_deg) || a.status != 0);
        });
      answer_or_reason([&] { expect_sane(calibrate_dual(sound, c, CalibrationMethod::fit)); });
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, HostileNumbers, testing::ValuesIn(kHostile),
                         [](const auto &kind) { return name_of(kind.param); });

} // namespace
} // namespace ada::test

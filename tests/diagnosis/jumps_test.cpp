// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "diagnosis/captures.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/events/jump_gap.h"
#include "support/seed.h"

namespace ada::test {
namespace {

constexpr double kRate = 5000.0, kRest = 3.0, kRamp = 1.5, kEnd = 9.0, kOmega = 60.0;

/// At rest, then gathering speed, then steady; s to rad.
double angle_at(double t) {
  if (t < kRest)
    return 0.0;
  const double since = t - kRest;
  return since < kRamp ? 0.5 * kOmega / kRamp * since * since : kOmega * (since - 0.5 * kRamp);
}

/// The magnet slips at a moment; no reference.
Capture slipping(double moment, double slip_deg, std::mt19937_64 &rng) {
  const auto n = static_cast<std::size_t>(kEnd * kRate);
  const double start = std::uniform_real_distribution<>(0.0, kTwoPi)(rng);
  ShaftMotion shaft;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / kRate;
    shaft.alpha.push_back(start + angle_at(t) + (t >= moment ? slip_deg * kRadPerDeg : 0.0));
  }
  shaft.omega.assign(n, 0.0); // no effect of the model depends on it
  shaft.direction.assign(n, 1);
  return pair_of(plain_sensor(), shaft, kRate, 5e-4, rng);
}

class SlipWithoutReference : public testing::TestWithParam<double> {};

TEST_P(SlipWithoutReference, is_found_whatever_the_shaft_does) {
  std::mt19937_64 rng(fresh_seed());
  const Diagnosis d = diagnose(slipping(GetParam(), -0.8, rng), {});
  ASSERT_EQ(d.findings.size(), 1u);
  EXPECT_EQ(d.findings[0].effect, find_effect("angle-slip"));
  EXPECT_NEAR(d.findings[0].values[0], GetParam(), 2.0 / kRate);
  EXPECT_NEAR(d.findings[0].values[1], -0.8, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Moments, SlipWithoutReference,
                         testing::Values(0.5 * kRest, kRest + 0.4 * kRamp, kRest + 0.8 * kRamp,
                                         0.6 * (kRest + kRamp) + 0.4 * kEnd));

TEST(Slip, none_is_seen_in_a_start_from_rest) {
  std::mt19937_64 rng(fresh_seed());
  const Diagnosis d = diagnose(slipping(0.0, 0.0, rng), {});
  EXPECT_TRUE(d.findings.empty());
}

TEST(Gap, is_known_to_its_error_while_the_shaft_gathers_speed) {
  constexpr int kDraws = 300;
  constexpr std::size_t kSamples = 3000, kAt = 1400;
  constexpr double kNoise = 2e-4; // rad
  std::mt19937_64 rng(fresh_seed());
  std::uniform_real_distribution<> any(-1.0, 1.0);
  std::normal_distribution<> noise(0.0, kNoise);
  const std::vector<char> usable(kSamples, 1);
  double squares = 0.0, errors = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const double speed = 50.0 * any(rng), rise = 20.0 * any(rng), size = 0.02 * any(rng);
    std::vector<double> time, angle;
    for (std::size_t i = 0; i < kSamples; ++i) {
      const double t = static_cast<double>(i) / kRate;
      time.push_back(t);
      angle.push_back(speed * t + rise * t * t + (i >= kAt ? size : 0.0) + noise(rng));
    }
    const Gap gap = gap_at(time, angle, usable, kAt);
    squares += std::pow((gap.size - size) / gap.error, 2);
    errors += gap.error;
  }
  EXPECT_NEAR(std::sqrt(squares / kDraws), 1.0, 0.2);
  EXPECT_LT(errors / kDraws, 0.25 * kNoise); // far better than from a few samples
}

} // namespace
} // namespace ada::test

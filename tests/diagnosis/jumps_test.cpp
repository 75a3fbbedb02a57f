// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "diagnosis/captures.h"
#include "diagnosis/diagnose.h"
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
  const Model model = sound_sensor();
  const auto n = static_cast<std::size_t>(kEnd * kRate);
  const double start = std::uniform_real_distribution<>(0.0, kTwoPi)(rng);
  Capture c;
  c.meta.supply_v = model.supply_v;
  c.meta.periods_per_turn = model.periods_per_turn;
  c.meta.noise_rms_v = 5e-4;
  c.meta.sample_rate_hz = kRate;
  std::vector<double> alpha;
  for (std::size_t i = 0; i < n; ++i) {
    c.time_s.push_back(static_cast<double>(i) / kRate);
    alpha.push_back(start + angle_at(c.time_s[i]) +
                    (c.time_s[i] >= moment ? slip_deg * kRadPerDeg : 0.0));
  }
  const std::vector<double> omega(n, 0.0); // no effect of the model depends on it
  const std::vector<signed char> direction(n, 1);
  c.vsin_v.resize(n);
  c.vcos_v.resize(n);
  const Conditions at{.n = n,
                      .time = c.time_s.data(),
                      .alpha = alpha.data(),
                      .omega = omega.data(),
                      .direction = direction.data(),
                      .frame_period_s = 1.0 / kRate};
  ForwardModel(model, AlphaIs::reference).evaluate(at, c.vsin_v.data(), c.vcos_v.data());
  std::normal_distribution<> noise(0.0, 5e-4);
  for (std::size_t i = 0; i < n; ++i) {
    c.vsin_v[i] += noise(rng);
    c.vcos_v[i] += noise(rng);
  }
  return c;
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

} // namespace
} // namespace ada::test

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The course of a capture over the turn, and what each calibration leaves of it, on pairs whose
// angle error is known.

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "study/signature.h"
#include "support/seed.h"

namespace ada::study {
namespace {

struct Pair {
  double k = 0.0, delta_deg = 0.0, offset_sin = 0.0, offset_cos = 0.0;
  double third = 0.0;        ///< third harmonic, -q sin 3 psi and q cos 3 psi
  double off_axis_deg = 0.0; ///< order 2 of the turn: order 1 of psi for two periods
  double sense = 1.0;
};

Capture capture_of(const Pair &p, int periods, double noise_v, std::mt19937_64 &rng) {
  std::normal_distribution<double> noise(0.0, noise_v);
  Capture c;
  c.meta.periods_per_turn = periods;
  for (int i = 0; i < 8000; ++i) {
    const double alpha = 0.00937 * i, h = 0.5 * p.delta_deg * kRadPerDeg;
    const double shown = alpha + p.off_axis_deg * kRadPerDeg * std::sin(2.0 * alpha);
    const double psi = p.sense * periods * shown + 0.4;
    c.time_s.push_back(1e-3 * i);
    c.vsin_v.push_back(2.5 + p.offset_sin +
                       1.4 * ((1.0 + 0.5 * p.k) * std::sin(psi + h) - p.third * std::sin(3 * psi)) +
                       noise(rng));
    c.vcos_v.push_back(2.5 + p.offset_cos +
                       1.4 * ((1.0 - 0.5 * p.k) * std::cos(psi - h) + p.third * std::cos(3 * psi)) +
                       noise(rng));
    c.reference_deg.push_back(wrap(alpha * kDegPerRad, 360.0));
  }
  return c;
}

class SignatureTest : public ::testing::TestWithParam<double> {
protected:
  std::mt19937_64 rng{test::fresh_seed()};
};

TEST_P(SignatureTest, LearnsTheEllipseWhicheverWayItTurns) {
  const Pair p{0.03, 2.0, 0.02, -0.015, 0.0, 0.0, GetParam()};
  const Learned l = learn(signature_of(capture_of(p, 2, 1e-5, rng)), 0);
  // 4000 samples of 1e-5 V: a coefficient has an error of 1e-5 / 1.4 * sqrt(2 / 4000).
  EXPECT_NEAR(l[0], 0.02 / 1.4, 2e-6);
  EXPECT_NEAR(l[1], -0.015 / 1.4, 2e-6);
  EXPECT_NEAR(l[2], 0.03, 4e-6);
  EXPECT_NEAR(l[3] * kDegPerRad, 2.0, 4e-4);
}

TEST_P(SignatureTest, EachCalibrationTakesWhatItCan) {
  const Pair p{0.03, 2.0, 0.02, -0.015, 0.01, 0.0, GetParam()};
  const Signature s = signature_of(capture_of(p, 2, 1e-6, rng));
  const Learned l = learn(s, 0);
  const double none = angle_rms_deg(s, 1, l, Calibration::none);
  const double offsets = angle_rms_deg(s, 1, l, Calibration::offsets);
  const double ellipse = angle_rms_deg(s, 1, l, Calibration::ellipse);
  const double table = angle_rms_deg(s, 1, l, Calibration::table8);
  // First order, electrical: offsets o / A each at order 1, k / 2 and d / 2 at order 2, q at
  // order 4.
  const double ring = 0.01, k = 0.5 * 0.03, d = 1.0 * kRadPerDeg;
  const double o2 = (0.02 * 0.02 + 0.015 * 0.015) / (1.4 * 1.4);
  const auto degrees = [](double square) { return std::sqrt(0.5 * square) / 2.0 * kDegPerRad; };
  // Second-order terms are products of these sizes, each below 0.03.
  EXPECT_NEAR(none, degrees(o2 + k * k + d * d + ring * ring), 0.03 * none);
  EXPECT_NEAR(offsets, degrees(k * k + d * d + ring * ring), 0.04 * offsets);
  EXPECT_NEAR(ellipse, degrees(ring * ring), 0.04 * ellipse);
  EXPECT_LT(table, 0.01 * ellipse);
}

TEST_P(SignatureTest, WhatIsNotTheSameInEachPartOfTheTurnStays) {
  Pair p;
  p.sense = GetParam();
  Capture c = capture_of(p, 2, 1e-6, rng);
  for (std::size_t i = 0; i < c.size(); ++i) // the reference is off centre: order 1 of the turn
    c.reference_deg[i] += 0.5 * std::sin(c.reference_deg[i] * kRadPerDeg);
  const Signature s = signature_of(c);
  const Learned l = learn(s, 0);
  EXPECT_NEAR(angle_rms_deg(s, 1, l, Calibration::table8), 0.5 / std::sqrt(2.0), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Senses, SignatureTest, ::testing::Values(1.0, -1.0));

TEST(SignatureOf, NeedsAReferenceAndTheWholeTurn) {
  std::mt19937_64 rng(1);
  Capture c = capture_of({}, 2, 1e-4, rng);
  EXPECT_TRUE(signature_of(c).consistent());
  EXPECT_FALSE(signature_of(c).empty());
  Capture part = c;
  for (double &r : part.reference_deg)
    r = 0.5 * r;
  EXPECT_TRUE(signature_of(part).empty());
  c.reference_deg.clear();
  EXPECT_TRUE(signature_of(c).empty());
}

} // namespace
} // namespace ada::study

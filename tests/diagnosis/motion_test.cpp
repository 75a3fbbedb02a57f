// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "base/sincos.h"
#include "motion/followed_gaps.h"
#include "motion/kinematics.h"
#include "motion/spline.h"
#include "support/seed.h"

namespace ada::test {
namespace {

TEST(SinCos, is_that_of_the_standard_library) {
  std::mt19937_64 rng(fresh_seed());
  std::vector<double> x{0.0, -0.0, 1e-300, kTwoPi, -0.25 * kTwoPi};
  for (double range : {1.0, 1e3, 1e8})
    for (int k = 0; k < 1003; ++k)
      x.push_back(std::uniform_real_distribution<>(-range, range)(rng));
  std::vector<double> s(x.size()), c(x.size());
  sincos_of(x.data(), x.size(), s.data(), c.data());
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(s[i], std::sin(x[i]), 4e-16) << x[i];
    EXPECT_NEAR(c[i], std::cos(x[i]), 4e-16) << x[i];
  }
}

TEST(SinCos, not_finite_gives_nan_and_may_work_in_place) {
  std::vector<double> x{std::nan(""), INFINITY, -INFINITY, 1.0}, c(4);
  sincos_of(x.data(), x.size(), x.data(), c.data());
  for (int k = 0; k < 3; ++k) {
    EXPECT_TRUE(std::isnan(x[k]));
    EXPECT_TRUE(std::isnan(c[k]));
  }
  EXPECT_NEAR(x[3], std::sin(1.0), 4e-16);
}

TEST(Spline, gives_back_a_cubic_and_the_terms_beside_it) {
  CubicSpline spline(CubicSpline::uniform(0.0, 10.0, 7));
  std::vector<double> x, y;
  for (int i = 0; i <= 500; ++i) {
    const double t = i / 50.0;
    x.push_back(t);
    y.push_back(1.0 + 0.5 * t - 0.2 * t * t + 0.01 * t * t * t + 0.3 * std::sin(9.0 * t));
  }
  spline.fit(x, y, {}, 1, [&](std::size_t i, double *term) { *term = std::sin(9.0 * x[i]); });
  EXPECT_NEAR(spline.term_coefficients()[0], 0.3, 1e-9);
  for (double t : {0.0, 3.3, 10.0}) {
    EXPECT_NEAR(spline.value(t), 1.0 + 0.5 * t - 0.2 * t * t + 0.01 * t * t * t, 1e-6);
    EXPECT_NEAR(spline.slope(t), 0.5 - 0.4 * t + 0.03 * t * t, 1e-6);
  }
}

TEST(SmoothMotion, leaves_a_ripple_of_the_turn_to_the_ripple) {
  std::vector<double> time, angle;
  for (int i = 0; i < 20000; ++i) {
    const double t = i * 1e-3;
    const double a = 20.0 * t + 0.4 * t * t / 2.0;
    time.push_back(t);
    angle.push_back(a + 0.01 * std::cos(a) + 0.004 * std::sin(3.0 * a));
  }
  std::vector<char> usable(time.size(), 1);
  const SmoothMotion m = smooth_motion(time, angle, usable, 6);
  // The ripple is a function of the measured angle here, so the terms are right to second order.
  EXPECT_NEAR(m.cos[0], 0.01, 3e-4);
  EXPECT_NEAR(m.sin[2], 0.004, 3e-4);
  for (std::size_t i = 2000; i < time.size() - 2000; i += 500)
    EXPECT_NEAR(m.motion.omega[i], 20.0 + 0.4 * time[i], 0.02);
}

/// A shaft that speeds up, the pair of it in stretches of which the gaps hold several turns.
TEST(FollowedGaps, join_stretches_to_one_motion) {
  std::mt19937_64 rng(fresh_seed());
  std::normal_distribution<> noise(0.0, 5e-4);
  const double direction = std::bernoulli_distribution(0.5)(rng) ? 1.0 : -1.0;
  constexpr std::size_t kAll = 100'000, kStretch = 4000, kEvery = 20'000;
  const auto psi = [&](std::size_t i) {
    const double t = static_cast<double>(i) * 1e-4;
    return direction * (60.0 * t + 4.0 * t * t);
  };
  Capture all, part;
  for (std::size_t i = 0; i < kAll; ++i) {
    all.time_s.push_back(static_cast<double>(i) * 1e-4);
    all.vsin_v.push_back(2.51 + 1.4 * std::sin(psi(i)) + noise(rng));
    all.vcos_v.push_back(2.48 + 1.5 * std::cos(psi(i)) + noise(rng));
  }
  std::vector<LeftOut> left_out;
  std::vector<double> angle;
  for (std::size_t start = 0; start < kAll; start += kEvery) {
    if (start > 0) {
      part.gaps.push_back(part.size());
      left_out.push_back({start - kEvery + kStretch - 1, start});
    }
    for (std::size_t i = start; i < start + kStretch; ++i) {
      part.time_s.push_back(all.time_s[i]);
      part.vsin_v.push_back(all.vsin_v[i]);
      part.vcos_v.push_back(all.vcos_v[i]);
      angle.push_back(std::atan2((all.vsin_v[i] - 2.51) / 1.4, (all.vcos_v[i] - 2.48) / 1.5));
    }
  }
  all.vsin_v[kStretch + 100] = 2.49; // in a gap, and on no circle
  all.vcos_v[kStretch + 100] = 2.47;
  part.turned_rad = turned_in(*recording_of(all), RoughCircle(part), left_out);
  unwrap(angle, kTwoPi);
  follow_through_gaps(part, kTwoPi, angle);
  for (std::size_t i = 0; i < angle.size(); ++i) {
    const std::size_t at = i / kStretch * kEvery + i % kStretch;
    ASSERT_NEAR(angle[i] - angle[0], psi(at) - psi(0), 0.02) << at;
  }
}

TEST(SmoothMotion, stretches_with_turns_between_them_need_not_fit_together) {
  std::vector<double> time, angle;
  for (int stretch = 0; stretch < 12; ++stretch)
    for (int i = 0; i < 2000; ++i) {
      const double t = stretch + i * 1e-4, u = t - 6.0;
      const double a = 120.0 * t + 9.0 * std::sin(3.0 * u); // the speed wanders in the gaps
      time.push_back(t);
      angle.push_back(a + 0.01 * std::cos(a));
    }
  std::vector<char> usable(time.size(), 1);
  const SmoothMotion m = smooth_motion(time, angle, usable, 4);
  EXPECT_NEAR(m.cos[0], 0.01, 3e-4);
  EXPECT_LT(m.residual_rms_rad, 5e-4);
}

TEST(SmoothMotion, what_is_rough_everywhere_is_not_left_out) {
  std::mt19937_64 rng(fresh_seed());
  std::normal_distribution<> noise(0.0, 0.05);
  std::vector<double> time, angle;
  double wander = 0.0;
  for (int i = 0; i < 20000; ++i) {
    time.push_back(i * 1e-3);
    wander = 0.995 * wander + 0.1 * noise(rng);
    angle.push_back(30.0 * time.back() + wander);
  }
  std::vector<char> usable(time.size(), 1);
  smooth_motion(time, angle, usable, 4);
  EXPECT_GE(std::count(usable.begin(), usable.end(), 1), 8000);
}

} // namespace
TEST(Senses, of_an_exact_angle_turn_at_each_reversal_however_far_it_is) {
  // Without any noise, and so far out that neighbours of the furthest angle are rounded to it.
  std::vector<double> alpha;
  constexpr std::size_t kLeg = 3000;
  for (std::size_t i = 0; i < 6 * kLeg; ++i) {
    const auto leg = i / kLeg, at = i % kLeg;
    alpha.push_back(1e-2 * static_cast<double>(leg % 2 == 0 ? at : kLeg - at) + 20.0);
  }
  const std::vector<signed char> sense = ada::senses_of(alpha);
  for (std::size_t i = 0; i < alpha.size(); ++i)
    if (i % kLeg > 2 && i % kLeg + 2 < kLeg) {
      ASSERT_EQ(sense[i], i / kLeg % 2 == 0 ? 1 : -1) << i;
    }
}

} // namespace ada::test

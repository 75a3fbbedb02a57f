// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The periodic remainder in the forward model, against its definition.

#include "model/remainder.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "base/error.h"
#include "model/effect_text.h"
#include "model/forward.h"
#include "support/remainder.h"
#include "support/seed.h"

namespace ada::test {
namespace {

/// Off the vector width and off the block length.
constexpr std::size_t kSamples = 1013;

struct Pair {
  std::vector<double> sin_v, cos_v;
};

class RemainderTest : public testing::Test {
protected:
  RemainderTest() {
    std::uniform_real_distribution<double> turns(-40.0, 40.0);
    for (std::size_t i = 0; i < kSamples; ++i) {
      time_.push_back(1e-4 * static_cast<double>(i));
      alpha_.push_back(kTwoPi * turns(rng_));
    }
    omega_.assign(kSamples, 20.0f);
    model_.periods_per_turn = 1 + static_cast<int>(rng_() % 3);
    model_.baseline = {1.2, 0.03, -0.02, 77.0};
  }

  Pair evaluate() const {
    Pair p{std::vector<double>(kSamples), std::vector<double>(kSamples)};
    const Conditions at{
        .n = kSamples, .time = time_.data(), .alpha = alpha_.data(), .omega = omega_.data()};
    ForwardModel(model_).evaluate(at, p.sin_v.data(), p.cos_v.data());
    return p;
  }

  /// What the remainder adds to VSIN and VCOS when the magnet is at `alpha`, term by term.
  std::pair<double, double> direct(double alpha) const {
    const PeriodicRemainder &r = *model_.remainder;
    const double zeroed = alpha + model_.baseline.angle_zero_deg * kRadPerDeg;
    const double x = r.electrical ? model_.periods_per_turn * zeroed : zeroed;
    double s = 0, c = 0;
    for (std::size_t i = 0; i < r.orders(); ++i) {
      const double n = static_cast<double>(i + 1);
      s += r.sin_cos[i] * std::cos(n * x) + r.sin_sin[i] * std::sin(n * x);
      c += r.cos_cos[i] * std::cos(n * x) + r.cos_sin[i] * std::sin(n * x);
    }
    return {model_.baseline.amplitude_v * s, model_.baseline.amplitude_v * c};
  }

  std::mt19937_64 rng_{fresh_seed()};
  Model model_;
  std::vector<double> time_, alpha_;
  std::vector<float> omega_;
};

/// The angle itself is rounded to 40 turns * 2^-53 * 2 = 6e-14 rad, order 256 of psi multiplies
/// that by up to 768, and the powers add 256 * 2e-16; the coefficients' sum is below 1.
constexpr double kRounding = 1e-10;

TEST_F(RemainderTest, AddsTheSumOfItsTerms) {
  for (const bool electrical : {false, true})
    for (const std::size_t orders :
         {std::size_t{1}, std::size_t{2}, std::size_t{64}, PeriodicRemainder::kHighestOrder}) {
      model_.remainder.reset();
      const Pair without = evaluate();
      model_.remainder = drawn_remainder(rng_, orders, 0.05, electrical);
      const Pair with = evaluate();
      for (std::size_t i = 0; i < kSamples; ++i) {
        const auto [s, c] = direct(alpha_[i]);
        ASSERT_NEAR(with.sin_v[i] - without.sin_v[i], s, kRounding) << orders;
        ASSERT_NEAR(with.cos_v[i] - without.cos_v[i], c, kRounding) << orders;
      }
    }
}

TEST_F(RemainderTest, TurnsWithTheMagnetAndPassesTheDelay) {
  model_.remainder = drawn_remainder(rng_, 16, 0.05, false);
  add_effect(model_, parse_effect("propagation-delay:tau_s=0.001"));
  const Pair late = evaluate();
  model_.effects.clear();
  for (double &a : alpha_)
    a -= 0.001 * omega_[0];
  const Pair before = evaluate();
  for (std::size_t i = 0; i < kSamples; ++i) {
    ASSERT_NEAR(late.sin_v[i], before.sin_v[i], kRounding);
    ASSERT_NEAR(late.cos_v[i], before.cos_v[i], kRounding);
  }
}

TEST_F(RemainderTest, IsAFractionOfTheSupplyLikeTheRest) {
  model_.remainder = drawn_remainder(rng_, 8, 0.05, false);
  const Pair at5 = evaluate();
  model_ = model_.at_supply(2.0 * model_.supply_v);
  const Pair at10 = evaluate();
  for (std::size_t i = 0; i < kSamples; ++i)
    ASSERT_NEAR(at10.sin_v[i], 2.0 * at5.sin_v[i], kRounding);
}

TEST_F(RemainderTest, KnowsItsRms) {
  model_.remainder = drawn_remainder(rng_, 30, 0.04, true);
  const double a = model_.baseline.amplitude_v;
  double sum = 0.0; // more points than twice the highest order: exact
  for (int k = 0; k < 100; ++k) {
    const auto [s, c] = direct(kTwoPi * k / 100 / model_.periods_per_turn);
    sum += (s * s + c * c) / (a * a);
  }
  EXPECT_NEAR(model_.remainder->rms(), std::sqrt(sum / 200), 1e-12);
}

TEST_F(RemainderTest, RefusesSeriesThatDoNotFitTogether) {
  const PeriodicRemainder good = drawn_remainder(rng_, 3, 0.01, false);
  const auto refused = [&](auto change) {
    model_.remainder = good;
    change(*model_.remainder);
    EXPECT_THROW(ForwardModel{model_}, Error);
  };
  refused([](auto &r) { r.cos_sin.pop_back(); });
  refused([](auto &r) { r.sin_cos.push_back(0); });
  refused([](auto &r) { r = {}; });
  refused([](auto &r) {
    for (auto *s : {&r.sin_cos, &r.sin_sin, &r.cos_cos, &r.cos_sin})
      s->resize(PeriodicRemainder::kHighestOrder + 1);
  });
}

} // namespace
} // namespace ada::test

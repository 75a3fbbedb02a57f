// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <cmath>
#include <complex>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "model/effect_text.h"
#include "model/forward.h"
#include "motion/surroundings.h"
#include "support/seed.h"

namespace ada::test {
namespace {

/// A supply that ripples while the shaft stands still, as it is recorded.
struct Ripple {
  double hz, rate_hz;
  std::vector<double> time;
  std::vector<float> unit;
  Ripple(double hz_, double rate_hz_) : hz(hz_), rate_hz(rate_hz_) {
    for (int i = 0; i < 2000; ++i) {
      time.push_back(i / rate_hz);
      unit.push_back(static_cast<float>(std::sqrt(2.0) * std::sin(kTwoPi * hz * time.back())));
    }
  }
};

TEST(Derivatives, are_those_of_a_ripple) {
  std::mt19937_64 rng(fresh_seed());
  for (double rate_hz : {1000.0, 2000.0, 10000.0, 50000.0}) {
    const double hz = std::uniform_real_distribution<>(40.0, 125.0)(rng), w = kTwoPi * hz;
    const Ripple ripple(hz, rate_hz);
    const Derivatives of(ripple.time, ripple.unit);
    double rate = 0.0, bend = 0.0;
    for (std::size_t i = 100; i < 1900; ++i) {
      const double a = w * ripple.time[i];
      rate = std::max(rate,
                      std::abs(static_cast<double>(of.rate[i]) / w - std::sqrt(2.0) * std::cos(a)));
      bend = std::max(
          bend, std::abs(static_cast<double>(of.bend[i]) / (w * w) + std::sqrt(2.0) * std::sin(a)));
    }
    // Five samples about one reach the fourth order; the rest is (w h)^4 / 30 and / 90 of it.
    const double wh = w / std::min(rate_hz, 2000.0);
    EXPECT_LT(rate, 0.01 + std::pow(wh, 4) / 10.0) << hz << " Hz at " << rate_hz << " S/s";
    EXPECT_LT(bend, 0.03 + std::pow(wh, 4) / 20.0) << hz << " Hz at " << rate_hz << " S/s";
  }
}

TEST(FilteredSupply, reaches_the_converter_as_the_filter_lets_it) {
  std::mt19937_64 rng(fresh_seed());
  const double corner = std::uniform_real_distribution<>(600.0, 1200.0)(rng);
  const double rms = 0.01, hz = 100.0;
  const Ripple ripple(hz, 5000.0);
  const Derivatives of(ripple.time, ripple.unit);
  Model model;
  model.supply_v = 5.0;
  model.baseline = {1.45, 0.0, 0.0, 0.0};
  add_effect(model, parse_effect(
                        std::string("supply-variation:rms_fraction=").append(std::to_string(rms))));
  add_effect(model, parse_effect(
                        std::string("low-pass-rolloff:corner_hz=").append(std::to_string(corner))));
  const std::size_t n = ripple.time.size();
  const double alpha = std::uniform_real_distribution<>(0.0, kTwoPi)(rng);
  const std::vector<double> angle(n, alpha);
  const std::vector<float> omega(n, 0.0f);
  const std::vector<signed char> direction(n, 1);
  std::vector<double> sin(n), cos(n);
  const Conditions at{.n = n,
                      .time = ripple.time.data(),
                      .alpha = angle.data(),
                      .omega = omega.data(),
                      .direction = direction.data(),
                      .supply = ripple.unit.data(),
                      .supply_rate = of.rate.data(),
                      .supply_bend = of.bend.data(),
                      .frame_period_s = 1.0 / ripple.rate_hz};
  ForwardModel(model, AlphaIs::shaft).evaluate(at, sin.data(), cos.data());
  const std::complex<double> pass = 1.0 / std::complex(1.0, hz / corner);
  double worst = 0.0, ignored = 0.0;
  for (std::size_t i = 100; i + 100 < n; ++i) {
    const double a = kTwoPi * hz * ripple.time[i];
    const auto expected = [&](double factor, double phase) {
      return (2.5 + 1.45 * std::sin(2.0 * alpha)) *
             (1.0 + rms * std::sqrt(2.0) * factor * std::sin(a + phase));
    };
    worst = std::max(worst, std::abs(sin[i] - expected(std::abs(pass), std::arg(pass))));
    ignored = std::max(ignored, std::abs(sin[i] - expected(1.0, 0.0)));
  }
  // The next term of the series, and a little for the derivatives.
  const double most = 4.0 * rms * std::sqrt(2.0);
  EXPECT_LT(worst, most * (std::pow(hz / corner, 3) + 2e-3)) << corner << " Hz";
  EXPECT_GT(ignored, 3.0 * worst);
}

} // namespace
} // namespace ada::test

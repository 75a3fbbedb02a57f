// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Fewer delayed copies do the same to every signal that the model can send through them.

#include <cmath>
#include <complex>
#include <random>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "model/effect.h"
#include "model/taps.h"
#include "support/seed.h"

namespace ada::test {
namespace {

std::complex<double> response(const std::vector<Tap> &taps, double omega) {
  std::complex<double> out;
  for (const Tap &tap : taps)
    out += tap.weight * std::polar(1.0, -omega * tap.delay_s);
  return out;
}

TEST(Taps, fewer_pass_each_harmonic_alike) {
  std::mt19937_64 rng(fresh_seed());
  std::uniform_real_distribution<> unit(0.0, 1.0);
  std::size_t most = 0, fewest = 100;
  for (int draw = 0; draw < 300; ++draw) {
    const double tau = 1e-4 * std::pow(100.0, unit(rng) - 0.5), skew = 1e-5 * unit(rng);
    const double fastest = std::pow(10.0, -3.0 * unit(rng)) / tau; // omega tau from 0.001 to 1
    Taps taps;
    find_effect("low-pass-rolloff")->dynamics(std::vector{1.0 / (kTwoPi * tau)}, taps);
    find_effect("channel-skew")->dynamics(std::vector{skew}, taps);
    const Taps few = taps.fewest(4.0 * fastest);
    EXPECT_LE(few.sin.size(), taps.sin.size());
    most = std::max(most, few.sin.size());
    fewest = std::min(fewest, few.sin.size());
    for (int harmonic = 1; harmonic <= 4; ++harmonic)
      for (double part : {0.1, 0.5, 1.0}) {
        const double omega = part * harmonic * fastest;
        const double nodes = static_cast<double>(few.sin.size());
        const double allowed = 1e-6 * std::pow(harmonic / 4.0, 2.0 * nodes) + 1e-12;
        EXPECT_LT(std::abs(response(few.sin, omega) - response(taps.sin, omega)), allowed);
        EXPECT_LT(std::abs(response(few.cos, omega) - response(taps.cos, omega)), allowed);
      }
  }
  EXPECT_LE(fewest, 2u); // slow, nearly a delay
  EXPECT_EQ(most, 10u);  // fast: as they were
}

TEST(Taps, at_rest_the_square_of_the_delay_stays) {
  std::mt19937_64 rng(fresh_seed());
  const double tau = std::uniform_real_distribution<>(1e-5, 1e-3)(rng);
  Taps taps;
  find_effect("low-pass-rolloff")->dynamics(std::vector{1.0 / (kTwoPi * tau)}, taps);
  const Taps few = taps.fewest(0.0);
  ASSERT_EQ(few.sin.size(), 2u);
  const auto moment = [&](const std::vector<Tap> &of, int power) {
    double out = 0.0;
    for (const Tap &tap : of)
      out += tap.weight * std::pow(tap.delay_s / tau, power);
    return out;
  };
  for (int power = 0; power <= 3; ++power)
    EXPECT_NEAR(moment(few.sin, power), moment(taps.sin, power), 1e-9) << power;
}

TEST(Taps, what_is_one_copy_stays_it) {
  Taps taps;
  EXPECT_EQ(taps.fewest(1000.0), taps);
  taps.pass(std::vector<Tap>{{1e-4, 1.0}});
  EXPECT_EQ(taps.fewest(1000.0), taps);
}

} // namespace
} // namespace ada::test

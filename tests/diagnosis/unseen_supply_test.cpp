// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/unseen_supply.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "diagnosis/captures.h"
#include "support/seed.h"

namespace ada::test {
namespace {

enum class Moves { nothing, supply, gain, offset };

constexpr double kSlowly = 0.7; // Hz

double ratio_at(double hz, double time) {
  return 0.01 * std::sin(kTwoPi * hz * time);
}

Capture moved(Moves what, std::mt19937_64 &rng, double hz = kSlowly) {
  Drive drive;
  drive.turns_back = false;
  Capture c = capture_of(plain_sensor(), drive, rng);
  c.reference_deg.clear();
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double u = ratio_at(hz, c.time_s[i]);
    for (double *v : {&c.vsin_v[i], &c.vcos_v[i]})
      *v += what == Moves::supply   ? u * *v
            : what == Moves::gain   ? u * (*v - 2.5)
            : what == Moves::offset ? u
                                    : 0.0;
  }
  return c;
}

/// Rms error of the supply that was seen, of its mean.
double error_of(const Capture &seen, double hz) {
  double off = 0.0;
  for (std::size_t i = 0; i < seen.size(); ++i)
    off += std::pow(seen.vdd_v[i] / 5.0 - 1.0 - ratio_at(hz, seen.time_s[i]), 2);
  return std::sqrt(off / static_cast<double>(seen.size()));
}

/// Far faster than the shaft turns.
double ripple_hz(std::mt19937_64 &rng) {
  return std::uniform_real_distribution<>(40.0, 130.0)(rng);
}

TEST(UnseenSupply, is_seen_through_the_radius) {
  std::mt19937_64 rng(fresh_seed());
  const auto seen = with_unseen_supply(moved(Moves::supply, rng));
  ASSERT_TRUE(seen);
  EXPECT_LT(error_of(*seen, kSlowly), 1e-3);
}

TEST(UnseenSupply, is_seen_when_it_is_a_ripple) {
  std::mt19937_64 rng(fresh_seed());
  const double hz = ripple_hz(rng), ratio_rms = 0.01 / std::sqrt(2.0);
  const auto seen = with_unseen_supply(moved(Moves::supply, rng, hz));
  ASSERT_TRUE(seen) << hz << " Hz";
  EXPECT_LT(error_of(*seen, hz), 0.05 * ratio_rms) << hz << " Hz";
}

TEST(UnseenSupply, is_no_tone_and_no_ripple_of_the_gain) {
  std::mt19937_64 rng(fresh_seed());
  const double hz = ripple_hz(rng);
  for (Moves what : {Moves::gain, Moves::offset})
    EXPECT_FALSE(with_unseen_supply(moved(what, rng, hz)))
        << static_cast<int>(what) << " at " << hz << " Hz";
}

TEST(UnseenSupply, is_no_gain_no_offset_and_no_noise) {
  std::mt19937_64 rng(fresh_seed());
  for (Moves what : {Moves::nothing, Moves::gain, Moves::offset})
    EXPECT_FALSE(with_unseen_supply(moved(what, rng))) << static_cast<int>(what);
}

TEST(UnseenSupply, is_not_looked_for_beside_a_vdd_column) {
  std::mt19937_64 rng(fresh_seed());
  Capture c = moved(Moves::supply, rng);
  c.vdd_v.assign(c.size(), 5.0);
  EXPECT_FALSE(with_unseen_supply(c));
}

} // namespace
} // namespace ada::test

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Benches whose residual looks like noise or like a slow process, and is something else: noise of
// its own place in the turn, sparks of brushes, offsets that follow the speed.

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

constexpr double kSpan = 8.0; // s
constexpr std::size_t kSamples = 24000;

/// There and back at a speed that wanders.
std::function<double(double)> motion(Bench &bench) {
  const auto there = wandering(bench, bench.within(6.0, 12.0), 0.2, 0.3),
             back = wandering(bench, bench.within(2.0, 5.0), 0.2, 0.3);
  return [=](double t) {
    constexpr double kTurn = 0.5 * kSpan;
    return t < kTurn ? there(t) : there(kTurn) - (back(t) - back(kTurn));
  };
}

bool leaves(const Diagnosis &d, const char *words) {
  return left_of(d).find(words) != std::string::npos;
}

std::mt19937_64 generator(Bench &bench) {
  return std::mt19937_64(static_cast<std::uint64_t>(bench.within(0.0, 1e15)));
}

KIND(sparks_of_two_brushes_are_told_with_their_places) {
  Bench bench;
  Capture c = bench.capture(kSamples, kSamples / kSpan, 2, motion(bench));
  std::mt19937_64 rng = generator(bench);
  const double place = bench.within(0.0, 360.0),
               size = bench.within(8.0, 15.0) * bench.pair.noise_v;
  std::normal_distribution<> spark(0.0, size);
  std::bernoulli_distribution strikes(0.3);
  for (std::size_t i = 0; i < c.size(); ++i)
    if (wrap(c.reference_deg[i] - place, 180.0) < 10.0 && strikes(rng)) {
      c.vsin_v[i] += spark(rng);
      c.vcos_v[i] += spark(rng);
    }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_FALSE(named(d, "impulse-noise")) << left_of(d);
  EXPECT_EQ(d.verdict, Verdict::partly_explained) << left_of(d);
  EXPECT_TRUE(leaves(d, "at the same places in the turn") ||
              leaves(d, "with the place in the turn"))
      << left_of(d);
}

KIND(noise_of_one_half_of_a_channel_is_no_noise_along_the_vector) {
  Bench bench;
  Capture c = bench.capture(kSamples, kSamples / kSpan, 2, motion(bench));
  std::mt19937_64 rng = generator(bench);
  std::normal_distribution<> more(0.0, bench.within(3.0, 5.0) * bench.pair.noise_v);
  for (double &v : c.vsin_v)
    if (v > 2.5)
      v += more(rng);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_FALSE(named(d, "amplitude-noise") || named(d, "angle-noise")) << left_of(d);
  EXPECT_EQ(d.verdict, Verdict::partly_explained) << left_of(d);
  EXPECT_TRUE(leaves(d, "with the place in the turn")) << left_of(d);
}

/// Two channels of different noise, and an angle that scatters: no place has a noise of its own.
KIND(noise_of_any_shape_that_the_catalogue_has_goes_with_no_place) {
  Bench bench;
  Capture c = bench.capture(kSamples, kSamples / kSpan, 2, motion(bench));
  std::mt19937_64 rng = generator(bench);
  const double a = bench.pair.amplitude_v;
  std::normal_distribution<> of_sin(0.0, bench.within(0.0, 2.0) * bench.pair.noise_v),
      of_angle(0.0, bench.within(1.0, 4.0) * bench.pair.noise_v / (2.0 * a));
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.vsin_v[i] += of_sin(rng);
    c.reference_deg[i] = wrap(c.reference_deg[i] + of_angle(rng) * kDegPerRad, 360.0);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_EQ(d.verdict, Verdict::explained) << left_of(d);
}

KIND(offsets_that_follow_the_speed_do_not_wander) {
  Bench bench;
  const auto angle = motion(bench);
  Capture c = bench.capture(kSamples, kSamples / kSpan, 2, angle);
  const double per_hz = bench.within(1.0, 3.0) * bench.pair.noise_v / 10.0;
  constexpr double kStep = 1e-3; // s
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double t = c.time_s[i];
    c.vsin_v[i] += per_hz * (angle(t + kStep) - angle(t - kStep)) / (2.0 * kStep * kTwoPi);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_FALSE(named(d, "offset-wander")) << left_of(d);
  EXPECT_TRUE(std::any_of(d.structure.begin(), d.structure.end(), [](const Structure &s) {
    return s.along == "speed";
  })) << left_of(d);
}

KIND(offsets_that_wander_do_so_whatever_the_speed) {
  Bench bench;
  Capture c = bench.capture(kSamples, kSamples / kSpan, 2, motion(bench));
  std::mt19937_64 rng = generator(bench);
  const double size = bench.within(2.0, 5.0) * bench.pair.noise_v, tau = bench.within(1.5, 4.0);
  // A process of first order, stationary from the start.
  const double keeps = std::exp(-kSpan / kSamples / tau), adds = std::sqrt(1.0 - keeps * keeps);
  std::normal_distribution<> unit;
  double sin = unit(rng), cos = unit(rng);
  for (std::size_t i = 0; i < c.size(); ++i) {
    sin = keeps * sin + adds * unit(rng);
    cos = keeps * cos + adds * unit(rng);
    c.vsin_v[i] += size * sin;
    c.vcos_v[i] += size * cos;
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_TRUE(named(d, "offset-wander")) << left_of(d);
}

} // namespace
} // namespace ada::test

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// What real benches add, as the engine makes it, is what the effect catalogue says.

#include "hidden_effects.h"
#include "outside.h"
#include "random.h"
#include "scenario.h"

#include <cmath>

#include <gtest/gtest.h>

namespace truth {
namespace {

/// A capture without any noise, at constant speed.
Bench silent_bench(double rpm) {
  Bench bench;
  bench.samples = 20000;
  bench.sampler.rate = 5000;
  bench.sampler.jitter = 0.0;
  bench.motion.hold(bench.duration(), rpm * kRpm);
  bench.thermal.duration = bench.duration();
  bench.converter.bits = 40;
  bench.converter.noise = bench.converter.vtemp_noise = bench.converter.vdd_noise = 0.0;
  bench.record.reference_noise = 0.0;
  return bench;
}

/// How much more the reference reads than the shaft stands at, degrees.
std::vector<double> reference_error(const Capture &capture) {
  std::vector<double> out;
  for (std::size_t i = 0; i < capture.time.size(); ++i)
    out.push_back(std::remainder(capture.reference[i] - capture.shaft[i] / kDegree, 360.0));
  return out;
}

double rms(const std::vector<double> &x) {
  double sum = 0.0;
  for (double v : x)
    sum += v * v / static_cast<double>(x.size());
  return std::sqrt(sum);
}

/// Five standard errors of an rms of so many normal numbers, relative.
double five_sigma(std::size_t n) {
  return 5.0 / std::sqrt(2.0 * static_cast<double>(n));
}

TEST(Reference, ErrsWithAnyOrder) {
  Bench bench = silent_bench(100);
  bench.record.reference_lines.push_back({7.25, 0.3 * kDegree, 1.0});
  const Capture capture = simulate(bench);
  const std::vector<double> error = reference_error(capture);
  for (std::size_t i = 0; i < error.size(); i += 7)
    ASSERT_NEAR(error[i], 0.3 * std::sin(7.25 * capture.shaft[i] + 1.0), 1e-9);
}

TEST(Reference, IsReadLateOrEarly) {
  for (double tau : {1e-3, -1e-3}) {
    Bench bench = silent_bench(100);
    bench.record.reference_delay = tau;
    const std::vector<double> error = reference_error(simulate(bench));
    for (std::size_t i = 10; i + 10 < error.size(); i += 7)
      ASSERT_NEAR(error[i], 600 * tau, 1e-9);
  }
}

TEST(Reference, CountsInSteps) {
  Bench bench = silent_bench(3);
  bench.record.reference_step = 0.36;
  const Capture capture = simulate(bench);
  for (double r : capture.reference)
    ASSERT_NEAR(r / 0.36, std::round(r / 0.36), 1e-6);
  for (double e : reference_error(capture))
    ASSERT_TRUE(e <= 1e-9 && e > -0.36 - 1e-9);
}

TEST(Reference, ReadAtMomentsThatScatterErrsWithTheSpeed) {
  for (double rpm : {50.0, 500.0}) {
    Bench bench = silent_bench(rpm);
    bench.record.reference_jitter = 1e-5;
    const double expected = 6 * rpm * 1e-5;
    EXPECT_NEAR(rms(reference_error(simulate(bench))), expected, expected * five_sigma(20000));
  }
}

TEST(Noise, OfTheGainLiesAlongTheVector) {
  Bench bench = silent_bench(100);
  bench.gain_noise = 1e-3;
  const Capture capture = simulate(bench);
  std::vector<double> along;
  for (std::size_t i = 0; i < capture.time.size(); ++i) {
    const double s = capture.vsin[i] - 2.5, c = capture.vcos[i] - 2.5;
    along.push_back(std::hypot(s, c) / bench.chain.amplitude - 1);
    ASSERT_NEAR(std::remainder(std::atan2(s, c) - 2 * capture.shaft[i], kTurn), 0.0, 1e-9);
  }
  EXPECT_NEAR(rms(along), 1e-3, 1e-3 * five_sigma(along.size()));
}

TEST(Wander, ActsOnOffsetsAndGain) {
  Bench bench = silent_bench(100);
  const Capture clean = simulate(bench);
  bench.wander.sine = [](double t) { return 0.01 * t; };
  bench.wander.gain = [](double t) { return 0.02 * t; };
  const Capture capture = simulate(bench);
  for (std::size_t i = 0; i < capture.time.size(); i += 97) {
    const double t = capture.time[i];
    ASSERT_NEAR(capture.vsin[i] - 2.5, (clean.vsin[i] - 2.5) * (1 + 0.02 * t) + 0.01 * t, 1e-9);
    ASSERT_NEAR(capture.vcos[i] - 2.5, (clean.vcos[i] - 2.5) * (1 + 0.02 * t), 1e-9);
  }
}

TEST(Wander, SmoothWalkIsSlowAndHasItsRms) {
  Random random(7);
  const Track track = smooth_walk(random, 30.0, 0.5);
  std::vector<double> values;
  int crossings = 0;
  for (int i = 0; i < 3000; ++i) {
    values.push_back(track(30.0 * i / 3000));
    crossings += i > 0 && values[values.size() - 1] * values[values.size() - 2] < 0;
  }
  EXPECT_NEAR(rms(values), 0.5, 0.005);
  EXPECT_LE(crossings, 12); // at most one in each of its steps
}

TEST(Benches, EveryCauseCanBeHidden) {
  for (const std::string &cause : bench_causes())
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const Scenario scenario = random_scenario(seed, {"bench", cause});
      ASSERT_EQ(scenario.expectation.effects.size(), 1U);
      ASSERT_EQ(scenario.expectation.effects.front().cause, cause);
    }
}

TEST(Benches, EveryKindOutsideTheCatalogueHasAnEllipse) {
  for (const std::string &kind : outside_kinds()) {
    const Scenario scenario = random_scenario(3, {"outside", kind});
    ASSERT_EQ(scenario.expectation.effects.size(), 2U) << kind;
    EXPECT_FALSE(scenario.expectation.axis.empty());
    EXPECT_GT(std::abs(scenario.bench.chain.mismatch), 0.0);
  }
}

TEST(Benches, AnIndexingTableRestsWhereItIsRead) {
  const Scenario scenario = random_scenario(5, {"outside", "indexing-stops"});
  const Capture capture = simulate(scenario.bench);
  ASSERT_EQ(capture.shaft.size(), 170U);
  for (std::size_t i = 1; i < capture.shaft.size(); ++i)
    ASSERT_NEAR(std::abs(capture.shaft[i] - capture.shaft[i - 1]), i % 10 == 0 ? kTurn / 17 : 0.0,
                1e-9)
        << i;
}

TEST(Benches, OneTurnIsOne) {
  const Capture capture = simulate(random_scenario(5, {"outside", "one-turn"}).bench);
  ASSERT_EQ(capture.shaft.size(), 1000U);
  EXPECT_NEAR(std::abs(capture.shaft.back() - capture.shaft.front()), kTurn * 0.999, 1e-3);
}

} // namespace
} // namespace truth

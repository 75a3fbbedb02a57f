// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The capture that a diagnosis proposes tells apart what it could not. The signals are made here,
// and not by the model that is fitted to them.

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/bench.h"
#include "simulation/profile.h"

namespace ada::test {
namespace {

bool holds(const std::vector<std::string> &ids, std::string_view id) {
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

/// At one speed the angle between the channels may be a time between their samples. What is
/// proposed is made, of a pair that has the one or the other.
KIND(the_capture_that_is_proposed_tells_quadrature_from_skew) {
  Bench bench;
  constexpr int kPeriods = 2;
  constexpr double kRate = 1000.0; // no skew is longer than a sample takes
  const double hz = bench.within(15.0, 25.0);
  const Diagnosis one_speed =
      diagnose(bench.capture(6000, kRate, kPeriods, [&](double t) { return kTwoPi * hz * t; }), {});
  const Finding *seen = named(one_speed, "quadrature-error");
  ASSERT_TRUE(seen && holds(seen->alternatives, "channel-skew")) << left_of(one_speed);
  const auto &next = one_speed.next_experiments;
  const auto e = std::find_if(next.begin(), next.end(), [](const Experiment &x) {
    return holds(x.separates, "quadrature-error") && holds(x.separates, "channel-skew");
  });
  ASSERT_NE(e, next.end()) << left_of(one_speed);
  EXPECT_GT(e->expected_nats, 8.0);
  EXPECT_TRUE(e->record.empty()) << e->sentence;

  const PiecewiseLinear motion = parse_motion(e->motion, e->duration_s);
  const double rate_hz = std::min(kRate, 20000.0 / e->duration_s);
  const auto angle = [&](double t) { return motion.integral(t); };
  const bool skewed = bench.within(-1.0, 1.0) < 0.0;
  const double apart_s = bench.pair.delta_rad / (kPeriods * kTwoPi * hz);
  if (skewed)
    bench.pair.delta_rad = 0.0;
  Capture c =
      bench.capture(static_cast<std::size_t>(e->duration_s * rate_hz), rate_hz, kPeriods, angle);
  for (std::size_t i = 0; skewed && i < c.size(); ++i)
    c.vcos_v[i] = kMiddleV + bench.normal(bench.pair.noise_v) +
                  bench.pair.amplitude_v * (1.0 - 0.5 * bench.pair.k) *
                      std::cos(kPeriods * angle(c.time_s[i] - apart_s) + bench.pair.zero_rad);
  const Diagnosis told = diagnose(c, {});
  const char *right = skewed ? "channel-skew" : "quadrature-error",
             *wrong = skewed ? "quadrature-error" : "channel-skew";
  const Finding *f = named(told, right);
  ASSERT_TRUE(f) << right << " after " << e->motion << ": " << left_of(told);
  EXPECT_FALSE(holds(f->alternatives, wrong)) << e->motion << ": " << left_of(told);
  expect_none(told, {wrong});
  for (const Experiment &more : told.next_experiments)
    EXPECT_FALSE(holds(more.separates, wrong)) << more.sentence;
}

/// At one speed a line of the angle is one of the time. No capture at one speed is proposed, and
/// none at a speed that the shaft has not shown, however noisy it is.
KIND(a_harmonic_and_a_tone_ask_for_another_speed) {
  Bench bench;
  const double hz = bench.within(4.0, 10.0), order = 3.0,
               volts = bench.pair.amplitude_v * bench.within(0.02, 0.05);
  bench.pair.noise_v = bench.within(0.002, 0.01);
  Capture c = bench.capture(6000, 2000.0, 2, [&](double t) { return kTwoPi * hz * t; });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.vsin_v[i] += volts * std::sin(order * 2.0 * kTwoPi * hz * c.time_s[i]);
  const Diagnosis d = diagnose(c, {});
  const auto f = std::find_if(d.findings.begin(), d.findings.end(), [](const Finding &x) {
    return holds(x.alternatives, "periodic-interference");
  });
  ASSERT_NE(f, d.findings.end()) << left_of(d);
  const auto e =
      std::find_if(d.next_experiments.begin(), d.next_experiments.end(), [&](const Experiment &x) {
        return x.finding == static_cast<std::size_t>(f - d.findings.begin()) &&
               holds(x.separates, "periodic-interference");
      });
  ASSERT_NE(e, d.next_experiments.end()) << left_of(d);
  EXPECT_EQ(e->motion.find("constant"), std::string::npos) << e->sentence;
  const PiecewiseLinear motion = parse_motion(e->motion, e->duration_s);
  for (double t = 0.0; t < e->duration_s; t += 0.01 * e->duration_s)
    EXPECT_LE(std::abs(motion.value(t)), 1.02 * kTwoPi * hz) << e->sentence;
}

} // namespace
} // namespace ada::test

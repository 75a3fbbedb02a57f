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

} // namespace
} // namespace ada::test

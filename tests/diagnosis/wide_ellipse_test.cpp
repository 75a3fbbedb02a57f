// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Pairs that are far from a sine and a cosine, with no reference: two phases of three, sensors of
// unlike strength over a ring whose poles differ, heads that stand wrongly on their scale. What an
// ellipse fit reads of them must be named.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

/// A figure in the wide ranges of such pairs.
void make_wide(Bench &bench) {
  const auto either = [&](double low, double high) {
    return std::copysign(bench.within(low, high), bench.within(-1.0, 1.0));
  };
  bench.pair.k = either(0.05, 0.5);
  bench.pair.delta_rad = either(15.0, 60.0) * kRadPerDeg;
  bench.pair.noise_v = bench.within(5e-4, 4e-3) * bench.pair.amplitude_v;
}

/// Each channel's strength and middle change along the record by `rms` of the amplitude, as slowly
/// as a few periods.
void let_wander(Bench &bench, Capture &c, double periods, double rms) {
  const double span = c.time_s.back();
  for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
    for (const bool gain : {true, false}) {
      const double waves = bench.within(0.1, 0.3) * periods, at = bench.within(0.0, kTwoPi);
      for (std::size_t i = 0; i < v->size(); ++i) {
        const double by = rms * std::sqrt(2.0) * std::sin(kTwoPi * waves * c.time_s[i] / span + at);
        (*v)[i] += gain ? by * ((*v)[i] - 2.5) : 0.3 * by * bench.pair.amplitude_v;
      }
    }
}

/// As an ellipse fit would have them: what wanders by w leaves each of them uncertain by w or so.
void expect_ellipse(const Diagnosis &d, const Pair &pair, double close) {
  const Finding *k = named(d, "amplitude-mismatch"), *delta = named(d, "quadrature-error");
  ASSERT_TRUE(k && delta) << left_of(d) << d.reason;
  EXPECT_NEAR(k->values[0], pair.k, close) << left_of(d);
  EXPECT_NEAR(delta->values[0] * kRadPerDeg, pair.delta_rad, close) << left_of(d);
}

KIND(two_phases_of_a_steady_machine_are_read_as_the_ellipse_they_draw) {
  Bench bench;
  make_wide(bench);
  const double rows_a_period = bench.within(13.0, 60.0), rate = 1000.0;
  const auto n = static_cast<std::size_t>(bench.within(250.0, 900.0));
  const double hz = rate / rows_a_period;
  Capture c = bench.capture(n, rate, 1, [&](double t) { return kTwoPi * hz * t; });
  c.reference_deg.clear();
  const double rms = bench.within(0.0, 0.02);
  let_wander(bench, c, static_cast<double>(n) / rows_a_period, rms);
  const Diagnosis d = diagnose(c, {});
  expect_ellipse(d, bench.pair, 0.01 + 1.5 * rms);
  expect_none(d, {"offset-step", "angle-slip", "clipping", "impulse-noise", "sample-loss"});
}

KIND(heads_pulled_along_a_scale_by_hand_are_read_as_the_ellipse_they_draw) {
  Bench bench;
  make_wide(bench);
  const double turns = bench.within(8.0, 25.0), rate = 500.0;
  const auto n = static_cast<std::size_t>(turns * bench.within(30.0, 60.0));
  const double span = static_cast<double>(n) / rate, uneven = bench.within(0.1, 0.35),
               at = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(n, rate, 1, [&](double t) {
    return kTwoPi * turns * (t / span + uneven / kTwoPi * std::sin(kTwoPi * t / span + at));
  });
  c.reference_deg.clear();
  const double rms = bench.within(0.0, 0.03);
  let_wander(bench, c, turns, rms);
  const Diagnosis d = diagnose(c, {});
  expect_ellipse(d, bench.pair, 0.01 + 1.5 * rms);
  expect_none(d, {"offset-step", "angle-slip", "clipping", "impulse-noise", "sample-loss"});
}

} // namespace
} // namespace ada::test

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A tone near half the sample rate, as large as the pair; and captures in which rows differ as much
// from row to row for other reasons.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "diagnosis/bench.h"
#include "diagnosis/conditions/alternation.h"

namespace ada::test {
namespace {

constexpr double kRate = 100.0;

/// A meter driven by water: slow, uneven, at rest before it begins. What it draws from the mains
/// comes with the flow.
Capture meter(Bench &bench, std::size_t n, double part, double beside_hz) {
  const double turns = static_cast<double>(n) / bench.within(30.0, 60.0),
               uneven = bench.within(0.0, 0.6), at = bench.within(0.0, kTwoPi);
  const double rest = bench.within(0.0, 0.2) * static_cast<double>(n) / kRate;
  const double span = static_cast<double>(n) / kRate - rest;
  Capture c = bench.capture(n, kRate, 1, [&](double t) {
    const double way = kTwoPi * turns * std::max(0.0, t - rest) / span;
    return way + uneven * std::sin(way + at);
  });
  c.reference_deg.clear();
  const double direction = bench.within(0.0, kTwoPi), phase = bench.within(-0.5, 0.5);
  for (std::size_t i = 0; i < n; ++i) {
    const double t = c.time_s[i];
    if (t < rest)
      continue;
    const double tone =
        part * bench.pair.amplitude_v * std::cos(kTwoPi * (0.5 * kRate - beside_hz) * t + phase);
    c.vsin_v[i] += tone * std::sin(direction);
    c.vcos_v[i] += tone * std::cos(direction);
  }
  return c;
}

KIND(a_tone_as_large_as_the_pair_displaces_every_second_row) {
  Bench bench;
  bench.pair.noise_v = bench.within(0.005, 0.03) * bench.pair.amplitude_v;
  bench.pair.delta_rad = std::copysign(bench.within(6.0, 12.0) * kRadPerDeg, bench.pair.delta_rad);
  const double beside_hz = bench.within(0.0, 1.0) < 0.5 ? 0.0 : bench.within(0.2, 1.0);
  const auto n = static_cast<std::size_t>(bench.within(250.0, 800.0));
  const Diagnosis d = diagnose(meter(bench, n, bench.within(0.5, 1.3), beside_hz), {});
  const Finding *tone = named(d, "periodic-interference");
  ASSERT_TRUE(tone) << left_of(d) << d.reason;
  EXPECT_NEAR(tone->values[0], 0.5 * kRate - beside_hz, 3.0 * tone->std_errors[0]) << left_of(d);
  expect_none(d, {"offset-step", "angle-slip", "clipping", "stuck-channel", "sample-loss"});
  if (const Finding *delta = named(d, "quadrature-error")) {
    EXPECT_NEAR(delta->values[0], bench.pair.delta_rad * kDegPerRad,
                std::max(1.5, 3.0 * delta->std_errors[0]))
        << left_of(d);
  }
}

TEST(Alternation, of_what_is_no_number_there_is_none) {
  Bench bench;
  Capture c = meter(bench, 400, 1.0, 0.0);
  c.vsin_v[200] = std::nan("");
  EXPECT_FALSE(large_alternation(c));
}

KIND(what_differs_from_row_to_row_is_no_alternation_by_itself) {
  Bench bench;
  bench.pair.noise_v = bench.within(0.001, 0.1) * bench.pair.amplitude_v;
  const auto n = static_cast<std::size_t>(bench.within(120.0, 3000.0));
  const int kind = static_cast<int>(bench.within(0.0, 4.0));
  // A shaft of few rows a period, one that goes in coarse places, one at rest, one that turns
  // slowly in noise.
  const double step = kind == 0   ? bench.within(0.8, 3.1)
                      : kind == 3 ? bench.within(0.01, 0.2)
                                  : 0.0;
  const double places = std::floor(bench.within(5.0, 20.0)),
               held = std::floor(bench.within(1.0, 5.0));
  Capture c = bench.capture(n, kRate, 1, [&](double t) {
    const double row = t * kRate;
    return kind == 1 ? kTwoPi * std::floor((row + 0.5) / held) / places : step * row;
  });
  c.reference_deg.clear();
  EXPECT_FALSE(large_alternation(c)) << "kind " << kind << ", " << n << " rows, step " << step
                                     << ", " << places << " places of " << held;
}

KIND(a_peak_that_a_harmonic_flattens_is_not_clipped) {
  Bench bench;
  constexpr double kRows = 250.0;
  const double third = bench.within(0.003, 0.01), second = bench.within(0.003, 0.01),
               at = bench.within(0.0, kTwoPi), tone_hz = bench.within(0.2, 0.45) * kRows;
  Capture c = bench.capture(250, kRows, 1, [](double t) { return kTwoPi * t; });
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double psi = kTwoPi * c.time_s[i] + bench.pair.zero_rad, a = bench.pair.amplitude_v;
    const double tone = 1e-3 * a * std::sin(kTwoPi * tone_hz * c.time_s[i]);
    c.vsin_v[i] += a * (third * std::sin(3.0 * psi) + second * std::sin(2.0 * psi + at)) + tone;
    c.vcos_v[i] += a * (-third * std::cos(3.0 * psi) + second * std::cos(2.0 * psi + at)) + tone;
  }
  expect_none(diagnose(c, {}), {"clipping"});
}

KIND(peaks_that_are_cut_in_one_turn_are_clipped) {
  Bench bench;
  const double rows = std::floor(bench.within(250.0, 1000.0));
  Capture c =
      bench.capture(static_cast<std::size_t>(rows), rows, 1, [](double t) { return kTwoPi * t; });
  const double level = cut_upper_peaks(bench, c, bench.within(0.8, 0.93));
  expect_cut_at(diagnose(c, {}), level, bench.pair);
}

} // namespace
} // namespace ada::test

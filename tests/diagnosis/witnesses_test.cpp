// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What stands for something else where few rows, or one witness alone, speak: a steady spin at
// which sensor and reference both err, the few rows of one turn, a spike beside a fast turn, tables
// that go there and back, or whose few stops show three causes at once, and an amplitude that only
// looks like a low pass.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

constexpr double kErrors = 4.0; // that are stated, from the truth

bool is_alternative(const Finding &f, std::string_view id) {
  return std::find(f.alternatives.begin(), f.alternatives.end(), id) != f.alternatives.end();
}

KIND(a_steady_spin_at_which_both_err_blames_neither_for_all_of_it) {
  Bench bench;
  const double rps = bench.within(4.0, 9.0), b = bench.within(6e-4, 1.2e-3),
               gamma = bench.within(0.0, kTwoPi), e = bench.within(3e-4, 6e-4),
               phi = bench.within(0.0, kTwoPi);
  bench.pair.noise_v = 2e-4;
  const auto angle = [=](double t) { return rps * kTwoPi * t; };
  Capture c = bench.capture(12000, 2000.0, 2,
                            [&](double t) { return angle(t) + b * std::sin(gamma - angle(t)); });
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double at = angle(c.time_s[i]);
    c.reference_deg[i] = wrap((at + e * std::sin(at + phi)) * kDegPerRad, 360.0);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *stray = named(d, "stray-field"), *centre = named(d, "reference-eccentricity");
  ASSERT_TRUE(stray || centre) << left_of(d);
  if (stray && !centre) {
    EXPECT_TRUE(is_alternative(*stray, "reference-eccentricity")) << left_of(d);
  }
  if (centre && !stray) {
    EXPECT_TRUE(is_alternative(*centre, "stray-field")) << left_of(d);
  }
  if (stray) {
    EXPECT_NEAR(stray->values[0], b, kErrors * stray->std_errors[0]) << left_of(d);
  }
  if (centre) {
    EXPECT_NEAR(centre->values[0] * kRadPerDeg, e, kErrors * centre->std_errors[0] * kRadPerDeg)
        << left_of(d);
  }
}

KIND(few_rows_of_white_noise_are_no_structure) {
  Bench bench;
  bench.pair.k = bench.pair.delta_rad = 0.0;
  const auto rows = static_cast<std::size_t>(bench.within(150.0, 550.0));
  const double rate = 500.0, turns = 1.2, most = 1.5; // noise of the reference over the pair's
  const double of_reference_rad =
      bench.within(0.0, most) * bench.pair.noise_v / bench.pair.amplitude_v;
  Capture c = bench.capture(rows, rate, 1, [&](double t) {
    return turns * kTwoPi * t * rate / static_cast<double>(rows);
  });
  for (double &r : c.reference_deg)
    r = wrap(r + bench.normal(of_reference_rad) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(d.verdict == Verdict::no_discrepancy || named(d, "angle-noise")) << left_of(d);
}

KIND(a_spike_beside_a_fast_turn_is_no_slip) {
  Bench bench;
  bench.pair.noise_v = 2e-4;
  const double rate = 12000.0, rps = bench.within(600.0, 800.0);
  Capture c = bench.capture(12000, rate, 1, [&](double t) {
    return rps * kTwoPi * (t - 0.3 / 25.0 * std::cos(25.0 * t));
  });
  c.reference_deg.clear();
  for (std::size_t i = 0; i < c.size(); ++i)
    if (bench.within(0.0, 1.0) < 0.005)
      for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
        (*v)[i] += bench.normal(0.015);
  const Diagnosis d = diagnose(c, {});
  EXPECT_FALSE(named(d, "angle-slip")) << left_of(d);
  EXPECT_TRUE(named(d, "impulse-noise")) << left_of(d);
  expect_pair(d, bench.pair);
}

/// Readings of a table at rest at each of its places, of a sensor that sees `seen` of them.
template <class Seen>
Capture of_table(Bench &bench, const std::vector<double> &places_rad, std::size_t readings,
                 double reference_noise_rad, Seen seen) {
  const double rate = 50.0;
  Capture c = bench.capture(places_rad.size() * readings, rate, 2, [&](double t) {
    const auto row = static_cast<std::size_t>(std::lround(t * rate));
    return seen(std::min(row / readings, places_rad.size() - 1));
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] =
        wrap((places_rad[i / readings] + bench.normal(reference_noise_rad)) * kDegPerRad, 360.0);
  return c;
}

KIND(a_table_that_goes_there_and_back_trails_and_does_not_slip) {
  Bench bench;
  bench.pair.noise_v = 3e-4;
  const auto stops = static_cast<std::size_t>(bench.within(18.0, 30.0));
  const double width = bench.within(0.03, 0.08) * kRadPerDeg;
  std::vector<double> places;
  for (std::size_t k = 0; k < stops; ++k)
    places.push_back(0.97 * kTwoPi * static_cast<double>(k) / static_cast<double>(stops));
  for (std::size_t k = stops; k-- > 0;)
    places.push_back(places[k]);
  const Capture c = of_table(bench, places, 16, 5e-4, [&](std::size_t k) {
    return places[k] - 0.5 * width * (k < stops ? 1.0 : -1.0);
  });
  const Diagnosis d = diagnose(c, {});
  EXPECT_FALSE(named(d, "angle-slip")) << left_of(d);
  const Finding *f = named(d, "hysteresis");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0] * kRadPerDeg, width, kErrors * f->std_errors[0] * kRadPerDeg)
      << left_of(d);
  expect_pair(d, bench.pair, 1e-3);
}

KIND(three_causes_of_one_size_are_seen_at_the_few_stops_of_a_table) {
  Bench bench;
  bench.pair.noise_v = 2.5e-4;
  const double size = bench.within(6e-4, 1.2e-3);
  bench.pair.k = 2.0 * size * (bench.pair.k < 0.0 ? -1.0 : 1.0);
  bench.pair.delta_rad = 2.0 * size * (bench.pair.delta_rad < 0.0 ? -1.0 : 1.0);
  std::vector<double> places;
  constexpr std::size_t kStops = 18, kReadings = 17;
  for (std::size_t k = 0; k < kStops; ++k)
    places.push_back(-kTwoPi * static_cast<double>(k) / static_cast<double>(kStops));
  const double centre_rad = bench.within(5e-5, 1.5e-4); // of the table
  Capture c = of_table(bench, places, kReadings, 2e-4,
                       [&](std::size_t k) { return places[k] + centre_rad * std::sin(places[k]); });
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double psi = 2.0 * places[i / kReadings] + bench.pair.zero_rad;
    c.vsin_v[i] -= size * bench.pair.amplitude_v * std::sin(3.0 * psi);
    c.vcos_v[i] += size * bench.pair.amplitude_v * std::cos(3.0 * psi);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair, size);
  // x^3 has a quarter of its third harmonic the same way.
  const Finding *weak = named(d, "weak-field"), *cubic = named(d, "cubic-nonlinearity");
  ASSERT_TRUE(weak || cubic) << left_of(d);
  EXPECT_TRUE(is_alternative(weak ? *weak : *cubic, weak ? "cubic-nonlinearity" : "weak-field"))
      << left_of(d);
  const double quarter = weak ? 1.0 : 0.25;
  const Finding &f = weak ? *weak : *cubic;
  EXPECT_NEAR(quarter * f.values[0], size, kErrors * quarter * f.std_errors[0]) << left_of(d);
}

KIND(an_amplitude_that_falls_along_a_line_with_the_speed_is_no_low_pass) {
  Bench bench;
  bench.pair.noise_v = 2e-3;
  const double rate = 1600.0, rps = bench.within(12.0, 16.0), w = kTwoPi * bench.within(0.8, 1.1),
               less = bench.within(0.02, 0.03);
  Capture c = bench.capture(
      5400, rate, 2, [&](double t) { return rps * kTwoPi * (t - 0.5 / w * std::cos(w * t)); });
  c.reference_deg.clear();
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double speed = 1.0 + 0.5 * std::sin(w * c.time_s[i]); // of the mean
    for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
      (*v)[i] = kMiddleV + (1.0 - less * speed) * ((*v)[i] - kMiddleV);
  }
  const Diagnosis d = diagnose(c, {});
  EXPECT_FALSE(named(d, "low-pass-rolloff")) << left_of(d);
  EXPECT_NE(d.verdict, Verdict::explained) << left_of(d);
}

} // namespace
} // namespace ada::test

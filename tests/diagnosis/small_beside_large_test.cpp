// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What is small beside the ellipse of the pair, or shows across its vector only.

#include <cmath>
#include <cstddef>
#include <vector>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

/// Mismatch, quadrature and offsets make an ellipse of the circle in whatever order they act, and
/// nothing else: a field's second and third order show beside large ones, at a fifteenth of a
/// degree.
KIND(small_orders_of_the_field_show_beside_a_large_ellipse) {
  Bench bench;
  bench.pair.k = bench.within(0.07, 0.1);
  bench.pair.delta_rad = bench.within(3.0, 5.0) * kRadPerDeg;
  bench.pair.noise_v = 7e-4 * bench.pair.amplitude_v;
  constexpr std::size_t kPlaces = 60, kReadings = 10;
  const double off_rad = bench.within(0.06, 0.09) * kRadPerDeg, from = bench.within(0.0, kTwoPi);
  const double third_rad = bench.within(0.04, 0.06) * kRadPerDeg;
  const auto place = [=](double t) { return kTwoPi * std::floor(t / kReadings + 1e-6) / kPlaces; };
  Capture c = bench.capture(kPlaces * kReadings, 1.0, 1, [=](double t) {
    const double a = place(t);
    return a + off_rad * std::sin(2.0 * a + from) + third_rad * std::cos(3.0 * a);
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(place(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  const Finding *second = named(d, "sensor-off-axis"), *third = named(d, "field-direction-error");
  ASSERT_TRUE(second && third) << left_of(d);
  EXPECT_NEAR(second->values[0] * kRadPerDeg, off_rad, 0.2 * off_rad) << names(d);
  EXPECT_EQ(third->values[0], 3.0) << names(d);
  EXPECT_NEAR(third->values[1] * kRadPerDeg, third_rad, 0.25 * third_rad) << names(d);
  expect_pair(d, bench.pair, 0.002);
}

/// A quadrature error that is smaller than the products of all else keeps no name. What it leaves
/// does not bend the field that is named beside it.
KIND(what_is_too_small_for_a_name_bends_nothing_that_is_large) {
  Bench bench;
  bench.pair.k = bench.within(0.03, 0.04);
  bench.pair.delta_rad = bench.within(0.013, 0.018) * kRadPerDeg;
  bench.pair.noise_v = 1.8e-4 * bench.pair.amplitude_v;
  const double b = bench.within(0.01, 0.02), from = bench.within(0.0, kTwoPi);
  constexpr double kRate = 3.0, kRows = 15000;
  const auto shaft = [&](double t) { return kTwoPi * (kRate / 36.0 * 1.003) * t; };
  Capture c = bench.capture(static_cast<std::size_t>(kRows), kRate, 1, [&](double t) {
    const double a = shaft(t);
    return std::atan2(std::sin(a) + b * std::sin(from), std::cos(a) + b * std::cos(from));
  });
  const double offset_sin = bench.within(0.02, 0.04), offset_cos = bench.within(0.02, 0.04);
  const double drift_sin = bench.within(-0.02, 0.02), drift_cos = bench.within(-0.02, 0.02);
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
    const double warm = 0.5 * std::sin(kTwoPi * 4.0 * c.time_s[i] * kRate / kRows);
    c.vtemp_v.push_back(2.4 + warm + bench.normal(5e-4));
    c.vsin_v[i] += offset_sin * bench.pair.amplitude_v + drift_sin * warm;
    c.vcos_v[i] += offset_cos * bench.pair.amplitude_v + drift_cos * warm;
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *field = named(d, "stray-field");
  ASSERT_TRUE(field) << left_of(d);
  EXPECT_NEAR(field->values[0], b, 3.0 * field->std_errors[0]) << left_of(d);
}

/// The angle is shaken at frequencies that come and go, and the length is not. What the pair's own
/// noise remembers it remembers along the vector as well: this is none of it.
KIND(what_shakes_the_angle_alone_is_no_noise_that_remembers_itself) {
  Bench bench;
  bench.pair.noise_v = 7e-4 * bench.pair.amplitude_v;
  const double rate_hz = 200.0, hz = bench.within(0.1, 0.25), shaken = bench.within(1.2e-3, 2e-3);
  std::vector<double> off{0.0};
  constexpr double kMemory = 0.85; // from one row to the next
  while (off.size() < 6000)
    off.push_back(kMemory * off.back() +
                  std::sqrt(1.0 - kMemory * kMemory) * bench.normal(shaken));
  const auto shaft = wandering(bench, hz, 0.5, 0.03);
  Capture c = bench.capture(off.size(), rate_hz, 1, [&](double t) {
    return shaft(t) + off[static_cast<std::size_t>(std::lround(t * rate_hz))];
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  EXPECT_EQ(d.verdict, Verdict::partly_explained) << left_of(d);
  expect_pair(d, bench.pair, 0.002);
}

} // namespace
} // namespace ada::test

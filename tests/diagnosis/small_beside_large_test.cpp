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

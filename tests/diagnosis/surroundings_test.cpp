// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What surrounds the sensor and goes with the shaft, or looks like it: a day that warms, a battery
// that sags, a table that stops, a reference that scatters or counts.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "diagnosis/bench.h"
#include "diagnosis/conditions/held_rows.h"
#include "motion/surroundings.h"

namespace ada::test {
namespace {

/// A tracker follows the sun, and its temperature does so as well: VTEMP goes with VCOS every day,
/// and is no multiplexer's memory.
KIND(a_temperature_that_goes_with_the_shaft_is_a_temperature) {
  Bench bench;
  constexpr double kDay_s = 86400.0, kEach_s = 60.0;
  const double days = bench.within(4.0, 6.0), from = bench.within(-0.8, 0.8);
  const double way = bench.within(1.6, 2.6), late = bench.within(0.5, 1.2);
  Capture c =
      bench.capture(static_cast<std::size_t>(days * kDay_s / kEach_s), 1.0 / kEach_s, 2,
                    [=](double t) { return from - 0.5 * way * std::cos(kTwoPi * t / kDay_s); });
  const double sin_v = bench.within(8e-3, 2e-2), cos_v = -bench.within(4e-3, 2e-2);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double t = c.time_s[i];
    const double warm = 0.1 * std::sin(kTwoPi * t / kDay_s - late) +
                        0.02 * std::sin(kTwoPi * t / (3.7 * kDay_s)) + 0.03 * t / (days * kDay_s);
    c.vtemp_v.push_back(1.5 + warm + bench.normal(1e-3));
    c.vsin_v[i] += sin_v * warm;
    c.vcos_v[i] += cos_v * warm;
  }
  const TemperatureOverTime temperature(c, SupplyOverTime(c));
  EXPECT_LE(std::abs(temperature.on_vcos), 4.0 * temperature.on_vcos_error);
  const Diagnosis d = diagnose(c, {});
  const Finding *drift = named(d, "offset-temperature-drift");
  ASSERT_TRUE(drift) << left_of(d);
  EXPECT_NEAR(drift->values[0], sin_v, 4.0 * drift->std_errors[0] + 1e-4) << names(d);
  EXPECT_NEAR(drift->values[1], cos_v, 4.0 * drift->std_errors[1] + 1e-4) << names(d);
  expect_none(d, {"multiplexer-memory"});
}

/// A battery that sags for a second under load moves both outputs, and VDD says so.
KIND(a_supply_that_sags_is_no_episode_of_the_pair) {
  Bench bench;
  Capture c = bench.capture(8000, 200.0, 2, wandering(bench, bench.within(0.3, 0.8), 0.6, 0.11));
  c.reference_deg.clear();
  double sags_s = 3.0, load_s = 0.0, depth = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double t = c.time_s[i];
    if (t > sags_s + load_s) {
      sags_s = t + bench.within(3.0, 8.0);
      load_s = bench.within(0.5, 1.2);
      depth = bench.within(0.03, 0.06);
    }
    const double rise = std::clamp((t - sags_s) / 0.05, 0.0, 1.0);
    const double ratio = 1.0 - depth * rise;
    c.vdd_v.push_back(5.0 * ratio + bench.normal(2e-4));
    c.vsin_v[i] *= ratio;
    c.vcos_v[i] *= ratio;
  }
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(named(d, "supply-variation")) << left_of(d);
  for (const Structure &s : d.structure)
    EXPECT_EQ(s.description.find("leaves its curve"), std::string::npos) << s.description;
  EXPECT_EQ(d.verdict, Verdict::explained) << left_of(d);
}

/// A water wheel of which a row is kept every so many turns: from one to the next the pair is
/// anywhere on its circle, and only the circle tells what noise is.
/// A pair whose supply sags by a percent now and then and has `ripple_v` from row to row, read with
/// `noise_v`; and how far the supply that is taken from it lies off, V rms.
double supply_off_v(Bench &bench, double ripple_v, double noise_v) {
  const double hz = bench.within(0.5, 2.0), at = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(8000, 2000.0, 2, [](double t) { return 20.0 * t + std::sin(3.0 * t); });
  std::vector<double> supply;
  for (std::size_t i = 0; i < c.size(); ++i) {
    supply.push_back(5.0 - 0.05 * std::pow(std::sin(hz * c.time_s[i] + at), 2) +
                     bench.normal(ripple_v));
    for (auto *v : {&c.vsin_v, &c.vcos_v})
      (*v)[i] *= supply[i] / 5.0;
    c.vdd_v.push_back(supply[i] + bench.normal(noise_v));
  }
  const SupplyOverTime over(c);
  double squares = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i)
    squares += std::pow(over.mean_v * (1.0 + over.scale * over.unit[i]) - supply[i], 2);
  return std::sqrt(squares / static_cast<double>(c.size()));
}

TEST(Supply, NoiseOfItsOwnReadingIsNoneOfTheOutputs) {
  Bench bench;
  EXPECT_LT(supply_off_v(bench, 0.0, 2e-3), 0.5e-3);
}

TEST(Supply, WhatTheOutputsFollowStays) {
  Bench bench;
  EXPECT_LT(supply_off_v(bench, 10e-3, 1e-4), 0.2e-3);
}

KIND(a_wheel_that_is_read_every_few_turns_turns) {
  Bench bench;
  constexpr double kEach_s = 20.0;
  const double turns = bench.within(2.35, 2.45), slow = kTwoPi / (900.0 * kEach_s);
  const double phase = bench.within(0.0, kTwoPi), by = bench.within(30.0, 60.0);
  Capture c = bench.capture(4000, 1.0 / kEach_s, 1, [=](double t) {
    return kTwoPi * (turns * t / kEach_s + by * std::sin(slow * t + phase));
  });
  c.reference_deg.clear();
  const double sin_v = bench.within(0.01, 0.03), cos_v = -bench.within(0.01, 0.03);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double warm = 0.15 * std::sin(0.7 * slow * c.time_s[i] - phase);
    c.vtemp_v.push_back(1.4 + warm + bench.normal(5e-4));
    c.vsin_v[i] += sin_v * warm;
    c.vcos_v[i] += cos_v * warm;
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *drift = named(d, "offset-temperature-drift");
  ASSERT_TRUE(drift) << d.reason << left_of(d);
  EXPECT_NEAR(drift->values[0], sin_v, 4.0 * drift->std_errors[0] + 1e-3) << names(d);
  EXPECT_NEAR(drift->values[1], cos_v, 4.0 * drift->std_errors[1] + 1e-3) << names(d);
  expect_pair(d, bench.pair, 0.002);
}

/// Stops in uneven steps of a table whose worm errs once a tooth, while the offsets wander.
Capture table(Bench &bench, int order, double error_rad) {
  constexpr std::size_t kPlaces = 34, kReadings = 6;
  std::vector<double> place{0.0};
  while (place.size() < kPlaces)
    place.push_back(place.back() + bench.within(0.3, 1.7) * kTwoPi / kPlaces);
  std::vector<double> way;
  for (int pass = 0; pass < 3; ++pass)
    for (std::size_t k = 0; k < kPlaces; ++k)
      way.push_back(place[pass == 1 ? kPlaces - 1 - k : k]);
  const double phase = bench.within(0.0, kTwoPi), slow = bench.within(1.0, 2.0);
  Capture c = bench.capture(way.size() * kReadings, 1.0, 1, [&](double t) {
    const double a = way[std::min(way.size() - 1, static_cast<std::size_t>(t / kReadings + 1e-6))];
    return a + error_rad * std::sin(order * a + phase);
  });
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.reference_deg[i] = wrap(way[i / kReadings] * kDegPerRad, 360.0);
    const double part = c.time_s[i] / c.time_s.back();
    c.vsin_v[i] += 2e-3 * std::sin(kTwoPi * slow * part);
  }
  return c;
}

/// An order of the turn, which without a look from elsewhere is the field's or the reference's.
void expect_order(const Diagnosis &d, int order) {
  const Finding *f = named(d, "field-direction-error");
  f = f ? f : named(d, "reference-harmonic");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_EQ(f->values[0], order) << names(d);
}

KIND(a_table_shows_an_order_above_what_its_readings_follow_closely) {
  Bench bench;
  const int order = bench.within(0.0, 1.0) < 0.5 ? 24 : 40;
  const Capture c = table(bench, order, bench.within(0.1, 0.2) * kRadPerDeg);
  const Diagnosis d = diagnose(c, {});
  expect_order(d, order);
  expect_pair(d, bench.pair, 0.002);
}

TEST(Readings, a_table_that_stops_at_uneven_places_is_no_held_reference) {
  for (int draw = 0; draw < 20; ++draw) {
    Bench bench;
    EXPECT_FALSE(fresh_readings(table(bench, 24, 0.0)));
  }
}

/// The sampling instants scatter, so that the noise across the vector is several times what a line
/// of the reference turns it by: it hides no such line.
KIND(a_clock_that_scatters_hides_no_line_of_the_reference) {
  Bench bench;
  constexpr int kOrder = 20;
  const double rate_hz = 1000.0, hz = bench.within(2.0, 3.0), way = bench.within(4.0, 6.0);
  const double slow = kTwoPi * hz / (2.0 * way); // strokes of some turns to and fro
  const auto angle = [=](double t) { return kTwoPi * 0.5 * way * std::sin(slow * t); };
  Capture c = bench.capture(6000, rate_hz, 1, angle);
  const double e = bench.within(0.05, 0.08) * kRadPerDeg, phase = bench.within(0.0, kTwoPi);
  const double jitter_s = 3.5 * e / (kTwoPi * hz); // several times the line
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double then = angle(c.time_s[i] + bench.normal(jitter_s));
    c.reference_deg[i] = wrap((then + e * std::sin(kOrder * then + phase)) * kDegPerRad, 360.0);
  }
  const Diagnosis d = diagnose(c, {});
  expect_order(d, kOrder);
  expect_pair(d, bench.pair, 0.002);
}

/// A plug is touched as a hoist slows down: in the turn on either side a step is an offset that
/// follows the speed, in the whole record it is not, as the speed comes back.
KIND(a_step_where_the_speed_changes_is_a_step) {
  Bench bench;
  const double fast = bench.within(3.0, 5.0), slow = bench.within(0.6, 1.2), at_s = 6.0;
  const double back_s = 13.0; // from which on it is fast again
  Capture c = bench.capture(10000, 500.0, 5, [=](double t) {
    return kTwoPi * (fast * std::min(t, at_s) + slow * std::clamp(t - at_s, 0.0, back_s - at_s) +
                     fast * std::max(t - back_s, 0.0));
  });
  const double sin_v = bench.within(2e-3, 4e-3), cos_v = -bench.within(1e-3, 3e-3);
  for (std::size_t i = 0; i < c.size(); ++i)
    if (c.time_s[i] >= at_s) {
      c.vsin_v[i] += sin_v;
      c.vcos_v[i] += cos_v;
    }
  const Diagnosis d = diagnose(c, {});
  const Finding *step = named(d, "offset-step");
  ASSERT_TRUE(step) << left_of(d);
  EXPECT_NEAR(step->values[0], at_s, 0.1) << names(d);
  EXPECT_NEAR(step->values[1], sin_v, 2e-4) << names(d);
  EXPECT_NEAR(step->values[2], cos_v, 2e-4) << names(d);
}

/// A few rows by hand, over which the speed changes all the time, beside an encoder of few lines.
KIND(a_counter_of_few_lines_is_told_in_a_hundred_and_thirty_six_rows_by_hand) {
  Bench bench;
  const double step_deg = bench.within(0.0, 1.0) < 0.5 ? 2.0 : 3.0;
  const double fast = bench.within(3.0, 5.0), slow = bench.within(0.15, 0.25);
  Capture c = bench.capture(136, 10.0, 1, [=](double t) {
    return fast / slow * (1.0 - std::cos(slow * kTwoPi * t / 2.0)) / 2.0;
  });
  for (double &r : c.reference_deg)
    r = wrap(step_deg * std::round(r / step_deg), 360.0);
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "reference-resolution");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], step_deg, 0.01) << names(d);
  expect_none(d, {"angle-noise", "timing-jitter"});
}

} // namespace
} // namespace ada::test

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Tables that stop where they do not say, rows that a driver repeats and rows that a shaft at rest
// repeats, rings of many poles, clocks that come in bursts, ways back of a part of a turn. The
// signals are made here, and not by the model that is fitted to them.

#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

double in_steps(double v, double step_v) {
  return step_v * std::round(v / step_v);
}

/// Places of a table, an even part of the turn apart; `off_rad`: where it stands beside them.
struct Table {
  std::size_t readings;
  std::vector<double> off_rad;
};

Table wrong_table(Bench &bench, double rms_deg) {
  Table out{static_cast<std::size_t>(bench.within(5.0, 14.0)),
            std::vector<double>(static_cast<std::size_t>(bench.within(14.0, 40.0)))};
  for (double &v : out.off_rad)
    v = bench.normal(rms_deg * kRadPerDeg);
  return out;
}

/// Ten readings a second at each place, and five seconds to the next.
Capture read_at(Bench &bench, const Table &table) {
  const std::size_t stops = table.off_rad.size();
  const auto place = [&](std::size_t i) {
    return kTwoPi * static_cast<double>(i / table.readings) / static_cast<double>(stops);
  };
  const auto row = [](double t) { return static_cast<std::size_t>(std::lround(10.0 * t)); };
  Capture c = bench.capture(stops * table.readings, 10.0, 2, [&](double t) {
    return place(row(t)) + table.off_rad[row(t) / table.readings];
  });
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.reference_deg[i] = place(i) * kDegPerRad;
    c.time_s[i] += 5.0 * static_cast<double>(i / table.readings);
  }
  return c;
}

bool says_stops(const Diagnosis &d) {
  return std::any_of(d.structure.begin(), d.structure.end(), [](const Structure &s) {
    return s.description.find("from stop to stop") != std::string::npos;
  });
}

KIND(a_table_that_stands_elsewhere_at_each_stop_is_not_explained) {
  Bench bench;
  const Diagnosis d = diagnose(read_at(bench, wrong_table(bench, bench.within(0.3, 1.0))), {});
  EXPECT_TRUE(says_stops(d)) << left_of(d);
  EXPECT_TRUE(d.verdict == Verdict::partly_explained || d.verdict == Verdict::unexplained)
      << left_of(d);
  ASSERT_FALSE(d.budget.empty());
  EXPECT_EQ(d.budget.front().axis, Axis::angle) << left_of(d);
  expect_none(d, {"stray-field", "sensor-off-axis", "angle-slip", "offset-step"});
  // A table errs along the curve: the length of the vector tells the pair.
  const Finding *k = named(d, "amplitude-mismatch"), *delta = named(d, "quadrature-error");
  ASSERT_TRUE(k && delta) << left_of(d);
  constexpr double kErrors = 4.0; // standard, as they are stated
  EXPECT_NEAR(k->values[0], bench.pair.k, kErrors * k->std_errors[0]);
  EXPECT_NEAR(delta->values[0], bench.pair.delta_rad * kDegPerRad, kErrors * delta->std_errors[0]);
  EXPECT_LT(k->std_errors[0], 0.25 * std::abs(bench.pair.k));
}

KIND(a_table_that_stands_right_or_drifts_has_no_error_of_its_stops) {
  Bench bench;
  Table table = wrong_table(bench, 0.0);
  Capture c = read_at(bench, table);
  const double wave_v = bench.within(0.0, 3.0) * bench.pair.noise_v, phase = bench.within(0.0, 6.0);
  for (std::size_t i = 0; i < c.size(); ++i)
    c.vsin_v[i] += wave_v * std::sin(kTwoPi * c.time_s[i] / c.time_s.back() + phase);
  EXPECT_FALSE(says_stops(diagnose(c, {})));
}

/// The same places once more tell that it comes again: then it is taken out, down to the noise.
KIND(what_a_table_does_at_its_stops_again_is_carried) {
  Bench bench;
  const Table table = wrong_table(bench, bench.within(0.3, 1.0));
  const Capture once = read_at(bench, table), again = read_at(bench, table);
  DiagnosisOptions options;
  options.heldout = &again;
  const Diagnosis d = diagnose(once, options);
  ASSERT_TRUE(d.extended.remainder) << left_of(d);
  EXPECT_LT(d.extended_quality.heldout.residual_rms_v, 2.0 * bench.pair.noise_v) << left_of(d);
}

/// Of a converter whose steps are wider than the noise a table at rest repeats most readings.
KIND(readings_that_a_table_at_rest_repeats_are_not_stale) {
  Bench bench;
  Capture c = read_at(bench, wrong_table(bench, 0.0));
  const double step_v = bench.within(1.0, 4.0) * bench.pair.noise_v;
  for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
    for (double &x : *v)
      x = in_steps(x, step_v);
  const Diagnosis d = diagnose(c, {});
  EXPECT_EQ(left_of(d).find("repeat the reading"), std::string::npos) << left_of(d);
}

/// A link that drops out now and then, for longer than what the turn is seen by, beside a shaft
/// that turns at any speed.
KIND(readings_that_the_link_repeats_while_the_shaft_turns_are_left_out) {
  Bench bench;
  const double a_row = bench.within(0.3, 30.0) * kRadPerDeg;
  Capture c = bench.capture(2000, 1000.0, 1, [&](double t) { return 1000.0 * t * a_row; });
  std::size_t repeated = 0;
  for (int k = 0; k < 8; ++k) {
    const auto from = static_cast<std::size_t>(bench.within(50.0 + 240.0 * k, 200.0 + 240.0 * k));
    const auto rows = static_cast<std::size_t>(bench.within(4.0, 30.0));
    for (std::size_t i = from; i < from + rows; ++i) {
      c.vsin_v[i] = c.vsin_v[from - 1];
      c.vcos_v[i] = c.vcos_v[from - 1];
    }
    repeated += rows;
  }
  if (bench.within(-1.0, 1.0) < 0.0)
    c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  EXPECT_NE(left_of(d).find(std::to_string(repeated) + " of 2000 rows repeat"), std::string::npos)
      << repeated << ": " << left_of(d);
  expect_pair(d, bench.pair);
  expect_none(d, {"angle-slip", "sample-loss", "impulse-noise", "periodic-interference"});
}

/// A ring of 36 to 64 poles on a bore beside its centre, with poles of their own places.
KIND(a_ring_of_many_poles_is_corrected_by_the_orders_of_its_turn) {
  Bench bench;
  const int poles = static_cast<int>(bench.within(34.0, 65.0));
  const double once = bench.within(0.1, 0.4) * kRadPerDeg, twice = 0.3 * once,
               phase = bench.within(0.0, kTwoPi);
  const auto shaft = [](double t) { return kTwoPi * t; };
  Capture c = bench.capture(9000, 1500.0, poles, [&](double t) {
    return shaft(t) + once * std::sin(shaft(t) + phase) + twice * std::cos(2.0 * shaft(t));
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  const double noise_deg = bench.pair.noise_v / bench.pair.amplitude_v / poles * kDegPerRad;
  EXPECT_LT(d.extended_quality.heldout.angle_error_rms_deg, 1.2 * noise_deg) << left_of(d);
}

/// Rows that a host takes in bursts: what differs from one to the next is the motion.
KIND(a_small_mismatch_is_named_though_the_rows_come_in_bursts) {
  Bench bench;
  bench.pair.k = bench.within(0.3, 0.6) * bench.pair.noise_v / bench.pair.amplitude_v + 1e-3;
  bench.pair.delta_rad = 0.0;
  Capture c = bench.capture(6000, 400.0, 1, [](double) { return 0.0; });
  double t = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    t += 0.0025 * (bench.within(0.0, 1.0) < 0.7 ? 0.4 : bench.within(1.0, 4.0));
    const double a = 0.3 * kTwoPi * t * (1.0 + 0.02 * t), psi = 16.0 * a;
    c.time_s[i] = t;
    c.vsin_v[i] = 2.5 + bench.normal(bench.pair.noise_v) +
                  bench.pair.amplitude_v * (1.0 + 0.5 * bench.pair.k) * std::sin(psi);
    c.vcos_v[i] = 2.5 + bench.normal(bench.pair.noise_v) +
                  bench.pair.amplitude_v * (1.0 - 0.5 * bench.pair.k) * std::cos(psi);
    c.reference_deg[i] = wrap(a * kDegPerRad, 360.0);
  }
  c.meta.periods_per_turn = 16;
  const Diagnosis d = diagnose(c, {});
  const Finding *k = named(d, "amplitude-mismatch");
  ASSERT_TRUE(k) << left_of(d);
  EXPECT_NEAR(k->values[0], bench.pair.k, 5.0 * k->std_errors[0]);
  EXPECT_EQ(d.verdict, Verdict::explained) << left_of(d);
}

/// Forward by a turn, and back by a fifth of one: a lag behind the reference turns over with it.
KIND(a_short_way_back_shows_what_trails) {
  Bench bench;
  const double lag_s = bench.within(0.01, 0.03), speed = kTwoPi / 10.0, back_s = 2.0;
  const auto shaft = [&](double t) {
    return t < 10.0 ? speed * t : t < 10.5 ? kTwoPi : kTwoPi - speed * (t - 10.5);
  };
  const auto rows = static_cast<std::size_t>((10.5 + back_s) * 20.0);
  Capture c = bench.capture(rows, 20.0, 1, [&](double t) { return shaft(t - lag_s); });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  const Finding *lag = named(d, "propagation-delay");
  lag = lag ? lag : named(d, "reference-delay");
  lag = lag ? lag : named(d, "hysteresis"); // of one speed
  ASSERT_TRUE(lag) << left_of(d);
  expect_none(d, {"channel-skew", "stray-field", "sensor-off-axis"});
}

/// A constant field comes with each pole of a ring, and not once a turn.
KIND(an_encoder_off_centre_at_a_ring_of_poles_is_no_stray_field) {
  Bench bench;
  const int periods = static_cast<int>(bench.within(5.0, 40.0));
  const double off_rad = bench.within(0.1, 0.4) * kRadPerDeg, from = bench.within(0.0, kTwoPi);
  const auto angle = wandering(bench, bench.within(0.2, 0.4), 0.4, 0.2);
  Capture c = bench.capture(8000, 1000.0, periods, angle);
  for (double &deg : c.reference_deg)
    deg = wrap(deg + off_rad * kDegPerRad * std::sin(deg * kRadPerDeg + from), 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair, 2e-3);
  expect_none(d, {"stray-field", "sensor-off-axis"});
  for (const Finding &f : d.findings)
    for (const std::string &other : f.alternatives)
      EXPECT_NE(other, "stray-field") << names(d);
}

/// A drive that sticks and slips: it stands for a while, and a few readings are taken on the way.
KIND(readings_on_the_way_from_stop_to_stop_are_no_stops) {
  Bench bench;
  const double stands_s = bench.within(0.07, 0.12), way_s = bench.within(0.01, 0.02),
               step = bench.within(0.3, 0.6);
  const auto angle = [&](double t) {
    const double whole = std::floor(t / (stands_s + way_s)), in = t - whole * (stands_s + way_s);
    return step * (whole + std::max(0.0, in - stands_s) / way_s);
  };
  Capture c = bench.capture(10000, 1000.0, 2, angle);
  const Diagnosis d = diagnose(c, {});
  EXPECT_FALSE(says_stops(d)) << left_of(d);
  expect_pair(d, bench.pair);
}

} // namespace
} // namespace ada::test

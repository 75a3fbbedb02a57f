// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Captures of few rows, of a shaft that stands while it is read, and of a reference that counts in
// coarse steps.

#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

/// A motor that steps between its readings errs with its phases: that comes again every four steps,
/// and is neither noise nor explained.
KIND(the_steps_of_a_motor_are_no_noise_of_the_angle) {
  Bench bench;
  constexpr double kStep = kTwoPi / 200.0, kNoiseRad = 1e-4;
  const double across = bench.within(5e-4, 2e-3);
  double phase[4];
  for (double &p : phase)
    p = bench.within(-1.0, 1.0);
  const double mean = 0.25 * (phase[0] + phase[1] + phase[2] + phase[3]);
  const double first = 0.5 * std::hypot(phase[0] - phase[2], phase[1] - phase[3]);
  Capture c = bench.capture(200, 20.0, 1, [&](double t) { return kStep * 20.0 * t; });
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double a = c.reference_deg[i] * kRadPerDeg +
                     across * (phase[i % 4] - mean) / std::max(first, 0.1) +
                     bench.normal(kNoiseRad);
    c.vsin_v[i] = kMiddleV + std::sin(a);
    c.vcos_v[i] = kMiddleV + std::cos(a);
  }
  const Diagnosis d = diagnose(c, {});
  // There is a little beside the steps, and it lies across the vector.
  const Finding *noise = named(d, "angle-noise");
  EXPECT_NEAR(noise ? noise->values[0] * kRadPerDeg : kNoiseRad, kNoiseRad, 0.5 * kNoiseRad)
      << names(d);
  EXPECT_NE(left_of(d).find("readings"), std::string::npos) << left_of(d);
}

/// A dividing head that goes up and comes down again: the sense of each way is that of the stop.
KIND(stops_both_ways_show_the_hysteresis) {
  Bench bench;
  constexpr std::size_t kReadings = 10;
  const auto stops = static_cast<std::size_t>(bench.within(24.0, 60.0));
  const double width_deg = bench.within(0.2, 0.5);
  std::vector<double> places;
  for (std::size_t k = 0; k < stops; ++k)
    places.push_back(static_cast<double>(k) * 360.0 / static_cast<double>(stops));
  for (std::size_t k = stops; k-- > 0;)
    places.push_back((static_cast<double>(k) - 0.5) * 360.0 / static_cast<double>(stops));
  const auto stop_at = [&](double t) {
    return static_cast<std::size_t>(std::lround(t * 50.0)) / kReadings;
  };
  Capture c = bench.capture(2 * stops * kReadings, 50.0, 1, [&](double t) {
    const double sense = stop_at(t) < stops ? 1.0 : -1.0;
    return (places[stop_at(t)] - 0.5 * width_deg * sense) * kRadPerDeg;
  });
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.reference_deg[i] = wrap(places[i / kReadings], 360.0);
    c.time_s[i] += 2.0 * static_cast<double>(i / kReadings);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *hysteresis = named(d, "hysteresis");
  ASSERT_TRUE(hysteresis) << names(d) << left_of(d);
  EXPECT_NEAR(hysteresis->values[0], width_deg, 0.05 * width_deg) << names(d);
  EXPECT_EQ(d.verdict, Verdict::explained) << left_of(d);
}

/// A hand turns the shaft to and fro in jerks, and rests: what the encoder rounds then stays the
/// same for long.
KIND(what_a_coarse_reference_rounds_is_no_slip_and_no_flicker) {
  Bench bench;
  const double step_deg = bench.within(0.2, 0.8);
  const double slow = bench.within(0.05, 0.12), fast = bench.within(0.3, 0.5);
  const double first = bench.within(0.0, kTwoPi), second = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(4500, 90.0, 1, [&](double t) {
    return kTwoPi * slow * t + 1.2 * std::sin(kTwoPi * 0.11 * t + first) +
           0.3 * std::sin(kTwoPi * fast * t + second);
  });
  for (double &deg : c.reference_deg)
    deg = wrap(step_deg * std::round(deg / step_deg), 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"angle-slip", "flicker-noise"});
}

/// A ring at speed behind a low pass: alone it makes the length of the pair no better, beside the
/// mismatch it leaves nothing.
KIND(a_low_pass_that_only_all_together_explain_is_named) {
  Bench bench;
  constexpr int kPoles = 32;
  const double top_hz = bench.within(1500.0, 2500.0), corner_hz = top_hz * bench.within(1.5, 4.0);
  constexpr double kDuration = 0.65, kRate = 20000.0;
  // Electrical rad: run up at once, on with half the acceleration, and down a little, in kinks.
  const auto speed_hz = [&](double t) {
    const double x = t / kDuration;
    return top_hz * (x < 0.1    ? 0.03
                     : x < 0.75 ? 0.03 + 0.97 * (x - 0.1) / 0.65
                                : 1.0 - 0.2 * (x - 0.75) / 0.25);
  };
  std::vector<double> angle{0.0};
  const auto n = static_cast<std::size_t>(kDuration * kRate);
  for (std::size_t i = 1; i < n; ++i)
    angle.push_back(angle.back() +
                    kTwoPi * speed_hz((static_cast<double>(i) - 0.5) / kRate) / kRate);
  Capture c = bench.capture(n, kRate, kPoles, [&](double t) {
    return angle[static_cast<std::size_t>(std::lround(t * kRate))] / kPoles;
  });
  c.reference_deg.clear();
  const auto filtered = [&](std::size_t i, double part) {
    const double ratio = speed_hz(static_cast<double>(i) / kRate) / corner_hz;
    const double size = 1.0 / std::hypot(1.0, ratio), lag = std::atan(ratio);
    return std::pair(size * bench.pair.amplitude_v, angle[i] + bench.pair.zero_rad - lag + part);
  };
  for (std::size_t i = 0; i < n; ++i) {
    const auto [of_sin, at_sin] = filtered(i, 0.5 * bench.pair.delta_rad);
    const auto [of_cos, at_cos] = filtered(i, -0.5 * bench.pair.delta_rad);
    c.vsin_v[i] = kMiddleV + of_sin * (1.0 + 0.5 * bench.pair.k) * std::sin(at_sin) +
                  bench.normal(bench.pair.noise_v);
    c.vcos_v[i] = kMiddleV + of_cos * (1.0 - 0.5 * bench.pair.k) * std::cos(at_cos) +
                  bench.normal(bench.pair.noise_v);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *low_pass = named(d, "low-pass-rolloff");
  ASSERT_TRUE(low_pass) << names(d) << left_of(d);
  EXPECT_NEAR(low_pass->values[0], corner_hz, 0.02 * corner_hz);
  EXPECT_TRUE(named(d, "amplitude-mismatch") && named(d, "quadrature-error")) << names(d);
}

/// Of a few turns beside a reference nobody knows whose the second order is.
KIND(an_off_axis_sensor_may_be_the_harmonic_of_the_reference) {
  Bench bench;
  const double e_deg = bench.within(0.02, 0.05), at = bench.within(0.0, kTwoPi);
  const auto angle = wandering(bench, bench.within(0.9, 1.3), 0.2, 0.3);
  Capture c = bench.capture(6000, 2000.0, 16, angle);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double a = angle(c.time_s[i]);
    c.reference_deg[i] = wrap(a * kDegPerRad + e_deg * std::sin(2.0 * a + at), 360.0);
  }
  const Diagnosis d = diagnose(c, {});
  bool told = false;
  for (const Finding &f : d.findings)
    told = told || f.effect->info().id == "reference-harmonic" ||
           std::count(f.alternatives.begin(), f.alternatives.end(), "reference-harmonic") > 0;
  EXPECT_TRUE(told) << left_of(d);
}

/// Two tones that beat too slowly for the record to hold three periods of it.
KIND(a_tone_that_beats_is_one_tone) {
  Bench bench;
  const double hz = bench.within(300.0, 400.0), apart = bench.within(0.6, 1.4);
  Capture c = bench.capture(10000, 5000.0, 2, wandering(bench, bench.within(3.0, 6.0), 0.1, 0.5));
  const double start = bench.within(0.0, kTwoPi), other = bench.within(0.0, kTwoPi);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double t = c.time_s[i];
    const double wave = 0.012 * std::sin(kTwoPi * hz * t + start) +
                        0.008 * std::sin(kTwoPi * (hz + apart) * t + other);
    c.vsin_v[i] += wave;
    c.vcos_v[i] += 0.8 * wave;
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *tone = named(d, "periodic-interference");
  ASSERT_TRUE(tone) << names(d) << left_of(d);
  EXPECT_NEAR(tone->values[0], hz, apart + 0.5);
}

/// A hundred rows are too few to say what it goes with; that it is no noise they do say.
KIND(what_goes_on_from_row_to_row_is_not_explained) {
  Bench bench;
  const auto rows = static_cast<std::size_t>(bench.within(80.0, 120.0));
  const double seconds = static_cast<double>(rows) / 10.0;
  Capture c = bench.capture(rows, 10.0, 1, [&](double t) { return kTwoPi * 1.1 * t / seconds; });
  bench.pair.noise_v *= 0.3;
  double along = 0.0, across = 0.0;
  for (std::size_t i = 0; i < rows; ++i) { // it forgets itself within some thirty rows
    along = 0.97 * along + bench.normal(2e-3);
    across = 0.97 * across + bench.normal(2e-3);
    c.vsin_v[i] += along * bench.pair.amplitude_v;
    c.vcos_v[i] += across * bench.pair.amplitude_v;
  }
  const Diagnosis d = diagnose(c, {});
  EXPECT_NE(d.verdict, Verdict::explained) << left_of(d);
  EXPECT_NE(d.verdict, Verdict::no_discrepancy) << left_of(d);
}

KIND(few_rows_of_white_noise_leave_nothing) {
  Bench bench;
  const auto rows = static_cast<std::size_t>(bench.within(60.0, 300.0));
  const double seconds = static_cast<double>(rows) / 10.0, turns = bench.within(1.1, 6.0);
  const Capture c =
      bench.capture(rows, 10.0, 1, [&](double t) { return kTwoPi * turns * t / seconds; });
  const Diagnosis d = diagnose(c, {});
  EXPECT_EQ(d.verdict, Verdict::explained) << left_of(d);
}

} // namespace
} // namespace ada::test

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Benches on which the readings themselves mislead: ranges that do not join, rows that are stale,
// few rows or few readings a stop, references in steps, noise in one direction.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

bool says(const Diagnosis &d, std::string_view words) {
  return std::any_of(d.structure.begin(), d.structure.end(), [&](const Structure &s) {
    return s.description.find(words) != std::string::npos;
  });
}

/// A shaft that a hand turns, at about so many turns a second.
std::function<double(double)> by_hand(Bench &bench, double hz) {
  return wandering(bench, hz, 0.4, bench.within(0.05, 0.3) * hz);
}

/// A speed that is another in each part of a turn, as a hand has it: about `hz` turns a second,
/// with six slow waves of its own.
std::function<double(double)> by_an_uneven_hand(Bench &bench, double hz) {
  std::vector<std::array<double, 3>> waves; // part of the speed, rad/s, rad
  for (int k = 0; k < 6; ++k)
    waves.push_back({bench.within(0.08, 0.16), kTwoPi * hz * bench.within(0.2, 1.6),
                     bench.within(0.0, kTwoPi)});
  return [=](double t) {
    double angle = t;
    for (const auto &[part, w, phase] : waves)
      angle -= part / w * std::cos(w * t + phase);
    return kTwoPi * hz * angle;
  };
}

KIND(a_hand_that_turns_unevenly_makes_no_ripple_of_the_turn) {
  Bench bench;
  const double turns = std::floor(bench.within(3.0, 9.0));
  Capture c = bench.capture(2000, 200.0, 1, by_an_uneven_hand(bench, turns / 10.0));
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  for (const char *id :
       {"rotation-nonuniformity", "stray-field", "sensor-off-axis", "field-direction-error"})
    EXPECT_FALSE(named(d, id)) << names(d);
  // Of few samples at one place of the turn and many at another.
  expect_pair(d, bench.pair, 0.003);
}

KIND(a_wire_that_breaks_is_seen_through_steps_that_are_larger_than_the_noise) {
  Bench bench;
  const double step_v = bench.within(1.2, 3.0) * bench.pair.noise_v;
  const double hz = bench.within(3.0, 8.0);
  Capture c = bench.capture(10000, 5000.0, 2, [=](double t) { return kTwoPi * hz * t; });
  c.reference_deg.clear();
  const auto from = static_cast<std::size_t>(bench.within(2000.0, 8000.0));
  std::vector<double> &stands = bench.within(0.0, 1.0) < 0.5 ? c.vsin_v : c.vcos_v;
  for (std::size_t i = from; i < c.size(); ++i)
    stands[i] = stands[from] + bench.normal(bench.pair.noise_v);
  for (auto *v : {&c.vsin_v, &c.vcos_v})
    for (double &x : *v)
      x = step_v * std::round(x / step_v);
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "stuck-channel");
  ASSERT_TRUE(f) << names(d);
  // Before it broke it was as near for as long as it stays within the noise of where it stands.
  EXPECT_NEAR(f->values[1], c.time_s[from], 0.02) << names(d);
}

/// The same without a reference and with VSIN in two ranges that do not join: told, and no cause
/// named.
Diagnosis with_a_joint(Capture c, double jump_v) {
  c.reference_deg.clear();
  for (double &v : c.vsin_v)
    if (v < kMiddleV)
      v -= jump_v;
  Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(d.findings.empty()) << names(d);
  EXPECT_TRUE(says(d, "VSIN is never between")) << left_of(d);
  return d;
}

KIND(two_ranges_that_do_not_join_are_told_and_no_cause_is_fitted_over_the_joint) {
  Bench bench;
  bench.pair.noise_v = 0.005;
  const double jump_v = bench.within(0.2, 0.6) * bench.pair.amplitude_v;
  Capture c = bench.capture(600, 100.0, 1, by_hand(bench, bench.within(0.5, 1.0)));
  const Diagnosis d = with_a_joint(std::move(c), jump_v);
  EXPECT_EQ(d.verdict, Verdict::unexplained);
}

KIND(a_shaft_that_turns_behind_much_noise_does_not_stand_still) {
  Bench bench;
  bench.pair.noise_v = bench.within(0.12, 0.16) * bench.pair.amplitude_v;
  bench.pair.k = 0.15;
  const double hz = bench.within(1.0, 4.0), wow = bench.within(0.0, 0.01);
  Capture c = bench.capture(9000, 1000.0, 1, [=](double t) {
    return kTwoPi * hz * (t + wow * std::sin(kTwoPi * 0.3 * t) / (kTwoPi * 0.3));
  });
  c.reference_deg.clear();
  const Diagnosis turns = diagnose(c, {});
  ASSERT_NE(turns.verdict, Verdict::insufficient_data) << turns.reason;
  const Finding *k = named(turns, "amplitude-mismatch"); // the quadrature error may be too small
  ASSERT_TRUE(k) << names(turns);
  EXPECT_NEAR(k->values[0], bench.pair.k, 0.04);
  // One that creeps within twice its noise does.
  const double far = 2.0 * bench.pair.noise_v / bench.pair.amplitude_v;
  Capture creeps = bench.capture(2000, 1000.0, 1, [=](double t) { return far * std::sin(t); });
  creeps.reference_deg.clear();
  EXPECT_EQ(diagnose(creeps, {}).verdict, Verdict::insufficient_data);
}

KIND(two_ranges_that_do_not_join_are_no_lost_rows) {
  Bench bench;
  constexpr int kCaptures = 2;
  for (int k = 0; k < kCaptures; ++k) {
    const double jump_v = bench.within(0.15, 0.5) * bench.pair.amplitude_v,
                 hz = bench.within(2.0, 8.0), wow = bench.within(0.0, 0.02);
    Capture c = bench.capture(5000, 1000.0, 1, [=](double t) {
      return kTwoPi * hz * (t + wow * std::sin(kTwoPi * 0.4 * t) / (kTwoPi * 0.4));
    });
    with_a_joint(std::move(c), jump_v);
  }
}

KIND(a_square_wave_has_two_ranges_and_a_table_with_stops_has_many) {
  Bench bench;
  const double step = bench.within(0.3, 0.5);
  Capture c = bench.capture(2000, 1000.0, 1, [&](double t) { return step * std::floor(20.0 * t); });
  c.reference_deg.clear();
  EXPECT_FALSE(says(diagnose(c, {}), "do not join"));
}

KIND(a_gain_that_is_another_in_one_quadrant_is_no_bent_transfer) {
  Bench bench;
  const double more = bench.within(0.03, 0.06);
  Capture c = bench.capture(6000, 2000.0, 1, by_hand(bench, bench.within(5.0, 8.0)));
  c.reference_deg.clear();
  for (std::size_t i = 0; i < c.size(); ++i)
    if (c.vsin_v[i] > kMiddleV && c.vcos_v[i] > kMiddleV)
      for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
        (*v)[i] = kMiddleV + (1.0 + more) * ((*v)[i] - kMiddleV);
  const Diagnosis d = diagnose(c, {});
  for (const Finding &f : d.findings)
    EXPECT_EQ(f.effect->info().prior_rank, 0) << left_of(d);
  EXPECT_NE(d.verdict, Verdict::explained);
}

KIND(blocks_whose_halves_are_exchanged_are_no_motion_of_the_shaft) {
  Bench bench;
  const double rps = bench.within(2.0, 6.0);
  Capture c = bench.capture(12800, 5000.0, 2, [&](double t) { return rps * kTwoPi * t; });
  c.reference_deg.clear();
  for (std::size_t block = 0; block + 64 <= c.size(); block += 64)
    if (bench.within(0.0, 1.0) < 0.1)
      for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
        std::rotate(v->begin() + static_cast<std::ptrdiff_t>(block),
                    v->begin() + static_cast<std::ptrdiff_t>(block + 32),
                    v->begin() + static_cast<std::ptrdiff_t>(block + 64));
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(says(d, "the angle jumps from one reading to the next")) << left_of(d);
  EXPECT_NE(d.verdict, Verdict::explained) << left_of(d);
}

KIND(spikes_and_a_hand_that_turns_back_are_no_jumps_of_the_angle) {
  Bench bench;
  Capture c = bench.capture(3000, 500.0, 1, [&](double t) { return kTwoPi * std::sin(2.0 * t); });
  c.reference_deg.clear();
  for (std::size_t i = 0; i < c.size(); ++i)
    if (bench.within(0.0, 1.0) < 0.005)
      c.vsin_v[i] += bench.within(-0.4, 0.4);
  EXPECT_FALSE(says(diagnose(c, {}), "the angle jumps from one reading to the next"));
}

// A reading that comes late, or a shaft that jerks, moves the pair along its own curve.
KIND(readings_that_come_late_by_much_are_no_spikes_of_the_signals) {
  Bench bench;
  const double rate = 1000.0, scatter_s = bench.within(3e-5, 8e-5);
  const std::vector<double> speeds{bench.within(0.5, 2.0), bench.within(-6.0, -3.0),
                                   bench.within(8.0, 12.0)};
  const auto angle = [&](double t) {
    double at = 0.0;
    for (std::size_t k = 0; k < speeds.size(); ++k)
      at += kTwoPi * speeds[k] * std::clamp(t - 3.0 * static_cast<double>(k), 0.0, 3.0);
    return at;
  };
  const Capture sound = bench.capture(9000, rate, 2, angle);
  Capture c = sound;
  const auto late = [&](double t) { // many a little, few by much
    return t - scatter_s * std::log(1.0 / bench.within(1e-9, 1.0));
  };
  const Pair &p = bench.pair;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double psi = 2.0 * angle(late(c.time_s[i])) + p.zero_rad;
    c.vsin_v[i] = 2.5 + bench.normal(p.noise_v) +
                  p.amplitude_v * (1.0 + 0.5 * p.k) * std::sin(psi + 0.5 * p.delta_rad);
    c.vcos_v[i] = 2.5 + bench.normal(p.noise_v) +
                  p.amplitude_v * (1.0 - 0.5 * p.k) * std::cos(psi - 0.5 * p.delta_rad);
  }
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"impulse-noise", "angle-slip", "offset-step"});
  EXPECT_TRUE(named(d, "timing-jitter")) << left_of(d);
}

KIND(spikes_of_the_signals_are_spikes_whatever_the_shaft_does) {
  Bench bench;
  Capture c = bench.capture(6000, 1000.0, 2, [&](double t) { return kTwoPi * 2.0 * t; });
  const double size = bench.within(20.0, 60.0) * bench.pair.noise_v;
  for (std::size_t i = 0; i < c.size(); ++i)
    if (bench.within(0.0, 1.0) < 0.002)
      (bench.within(0.0, 1.0) < 0.5 ? c.vsin_v : c.vcos_v)[i] +=
          std::copysign(size, bench.within(-1.0, 1.0));
  if (bench.within(0.0, 1.0) < 0.5)
    c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(named(d, "impulse-noise")) << left_of(d);
}

KIND(stale_rows_are_told_and_are_no_vibration) {
  Bench bench;
  const double share = bench.within(0.03, 0.1), rps = bench.within(4.0, 8.0);
  Capture c = bench.capture(10000, 5000.0, 2, [&](double t) { return rps * kTwoPi * t; });
  for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
    for (double &x : *v)
      x = std::round(x / 76e-6) * 76e-6;
  for (std::size_t i = c.size() - 1; i > 0; --i)
    if (bench.within(0.0, 1.0) < share) {
      c.vsin_v[i] = c.vsin_v[i - 1];
      c.vcos_v[i] = c.vcos_v[i - 1];
    }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_TRUE(says(d, "repeat the reading before them")) << left_of(d);
  EXPECT_FALSE(named(d, "angle-noise") || named(d, "timing-jitter")) << names(d);
}

KIND(a_coarse_converter_before_a_shaft_that_nearly_stands_has_no_stale_rows) {
  Bench bench;
  bench.pair.noise_v = 2e-4;
  const double start = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(6000, 1000.0, 1, [&](double t) {
    return 3.0 * kTwoPi * std::sin(0.5 * t + start); // turns back, and stands there
  });
  for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
    for (double &x : *v)
      x = std::round(x / 1.2e-3) * 1.2e-3;
  EXPECT_FALSE(says(diagnose(c, {}), "repeat the reading before them"));
}

KIND(a_table_with_five_readings_a_stop_shows_the_pair) {
  Bench bench;
  const double start = bench.within(0.0, 0.1);
  Capture c = bench.capture(
      180, 100.0, 2, [&](double t) { return start + kTwoPi / 36.0 * std::floor(20.0 * t + 1e-6); });
  const Diagnosis d = diagnose(c, {});
  ASSERT_TRUE(named(d, "amplitude-mismatch") && named(d, "quadrature-error")) << left_of(d);
  EXPECT_NEAR(named(d, "quadrature-error")->values[0] * kRadPerDeg, bench.pair.delta_rad, 2e-3);
  EXPECT_FALSE(named(d, "reference-resolution")) << names(d);
  EXPECT_EQ(d.verdict, Verdict::explained) << left_of(d);
}

KIND(a_hundred_and_thirty_six_rows_by_hand_show_the_pair) {
  Bench bench;
  bench.pair.noise_v = 0.01 * bench.pair.amplitude_v;
  bench.pair.k = std::copysign(bench.within(0.04, 0.1), bench.pair.k);
  bench.pair.delta_rad = std::copysign(bench.within(2.0, 5.0), bench.pair.delta_rad) * kRadPerDeg;
  Capture c = bench.capture(136, 20.0, 1, by_hand(bench, 0.8));
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  ASSERT_TRUE(named(d, "amplitude-mismatch") && named(d, "quadrature-error")) << left_of(d);
  EXPECT_NEAR(named(d, "amplitude-mismatch")->values[0], bench.pair.k, 0.015);
  EXPECT_NEAR(named(d, "quadrature-error")->values[0] * kRadPerDeg, bench.pair.delta_rad, 0.015);
  EXPECT_EQ(d.verdict, Verdict::explained) << left_of(d);
}

KIND(noise_of_the_gain_is_told_without_a_reference) {
  Bench bench;
  const double fraction = bench.within(2e-3, 5e-3), rps = bench.within(3.0, 10.0);
  Capture c = bench.capture(10000, 5000.0, 2, [&](double t) { return rps * kTwoPi * t; });
  c.reference_deg.clear();
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double gain = 1.0 + bench.normal(fraction);
    for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
      (*v)[i] = kMiddleV + gain * ((*v)[i] - kMiddleV);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *noise = named(d, "amplitude-noise");
  ASSERT_TRUE(noise) << left_of(d);
  EXPECT_NEAR(noise->values[0], fraction, 0.1 * fraction);
  EXPECT_EQ(d.verdict, Verdict::explained) << left_of(d);
}

/// Flicker noise of so many volts a root of hertz at 1 Hz: a sum of relaxations whose corners are
/// spread evenly over the logarithm (McWhorter 1957), each as a first-order recursion.
std::vector<double> flicker(Bench &bench, std::size_t n, double rate_hz, double at_1_hz_v) {
  constexpr int kRelaxations = 24;
  const double low_hz = 0.5 * rate_hz / static_cast<double>(n), high_hz = rate_hz;
  std::vector<double> out(n, 0.0);
  for (int k = 0; k < kRelaxations; ++k) {
    const double octaves = std::log(high_hz / low_hz) / kRelaxations;
    const double corner_hz = low_hz * std::exp(octaves * (k + 0.5));
    const double rms = at_1_hz_v * std::sqrt(octaves),
                 keep = std::exp(-kTwoPi * corner_hz / rate_hz);
    double x = bench.normal(rms);
    for (double &v : out) {
      v += x;
      x = keep * x + bench.normal(rms * std::sqrt(1.0 - keep * keep));
    }
  }
  return out;
}

KIND(flicker_noise_is_told_by_the_radius_of_a_steady_shaft) {
  Bench bench;
  constexpr double kRate = 2000.0;
  bench.pair.noise_v = 1e-3;
  const double corner_hz = bench.within(60.0, 150.0), rps = bench.within(5.0, 15.0);
  const double density = 2.0 * bench.pair.noise_v * bench.pair.noise_v / kRate; // of the white part
  Capture c = bench.capture(20000, kRate, 1, [&](double t) { return rps * kTwoPi * t; });
  c.reference_deg.clear();
  for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v}) {
    const std::vector<double> noise =
        flicker(bench, c.size(), kRate, std::sqrt(density * corner_hz));
    for (std::size_t i = 0; i < c.size(); ++i)
      (*v)[i] += noise[i];
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "flicker-noise");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(std::log(f->values[1] / corner_hz), 0.0, 0.6);
  EXPECT_FALSE(named(d, "offset-wander")) << names(d);
}

KIND(what_a_coarse_reference_rounds_is_not_learnt_into_the_sensor) {
  Bench bench;
  constexpr double kStepDeg = 360.0 / 1024.0;
  // A turn is a whole number of rows: the rounding repeats with the angle.
  const double start = bench.within(0.0, kTwoPi);
  const double rows = std::floor(bench.within(800.0, 1300.0));
  Capture c =
      bench.capture(20000, 5000.0, 2, [&](double t) { return start + kTwoPi * t * 5000.0 / rows; });
  for (double &r : c.reference_deg)
    r = std::floor(r / kStepDeg) * kStepDeg;
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_EQ(d.findings.size(), 3u) << left_of(d);
  EXPECT_TRUE(named(d, "reference-resolution")) << left_of(d);
  EXPECT_FALSE(d.extended.remainder) << left_of(d);
  EXPECT_EQ(d.verdict, Verdict::explained) << left_of(d);
}

KIND(a_harmonic_at_one_speed_may_be_a_tone) {
  Bench bench;
  const double rps = bench.within(4.0, 12.0), part = bench.within(0.005, 0.012);
  Capture c = bench.capture(10000, 5000.0, 2, [&](double t) { return rps * kTwoPi * t; });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.vsin_v[i] += part * bench.pair.amplitude_v * std::cos(3.0 * 2.0 * kTwoPi * rps * c.time_s[i]);
  const Diagnosis d = diagnose(c, {});
  const Finding *harmonic = named(d, "harmonic-distortion"),
                *tone = named(d, "periodic-interference");
  ASSERT_TRUE(harmonic || tone) << left_of(d);
  const std::vector<std::string> &others = (harmonic ? harmonic : tone)->alternatives;
  EXPECT_EQ(std::count(others.begin(), others.end(),
                       harmonic ? "periodic-interference" : "harmonic-distortion"),
            1)
      << names(d);
}

KIND(where_a_bend_is_straight_is_in_the_error_of_the_mismatch) {
  Bench bench;
  const double rps = bench.within(3.0, 6.0), q2 = bench.within(0.01, 0.02);
  const double sin_v = bench.within(0.01, 0.03), cos_v = -bench.within(0.01, 0.03);
  const bool about_offset = bench.within(0.0, 1.0) < 0.5;
  Capture c = bench.capture(10000, 5000.0, 1, [&](double t) { return rps * kTwoPi * t; });
  const auto bend = [&](std::vector<double> &v, double offset_v) {
    for (double &x : v) {
      const double u = x - kMiddleV + (about_offset ? 0.0 : offset_v);
      x = kMiddleV + u + q2 * u * u / bench.pair.amplitude_v + (about_offset ? offset_v : 0.0);
    }
  };
  bend(c.vsin_v, sin_v);
  bend(c.vcos_v, cos_v);
  const Diagnosis d = diagnose(c, {});
  const Finding *k = named(d, "amplitude-mismatch");
  ASSERT_TRUE(k && named(d, "quadratic-nonlinearity")) << left_of(d);
  EXPECT_NEAR(k->values[0], bench.pair.k, 3.0 * k->std_errors[0] + 2e-5) << names(d);
}

KIND(at_a_speed_that_hardly_changes_a_skew_is_an_alternative_and_the_error_no_wider_than_that) {
  Bench bench;
  // As much as a skew within the time of a sample could be all of.
  bench.pair.delta_rad = std::copysign(bench.within(0.08, 0.2) * kRadPerDeg, bench.pair.delta_rad);
  const auto angle = wandering(bench, bench.within(3.0, 6.0), bench.within(1e-4, 3e-3), 1.0);
  Capture c = bench.capture(20000, 5000.0, 2, angle);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *quadrature = named(d, "quadrature-error");
  ASSERT_TRUE(quadrature);
  EXPECT_LT(quadrature->std_errors[0], 0.51 * std::abs(quadrature->values[0]));
  EXPECT_EQ(
      std::count(quadrature->alternatives.begin(), quadrature->alternatives.end(), "channel-skew"),
      1);
}

KIND(two_tones_draw_no_circle_and_nothing_is_named) {
  Bench bench;
  const double sin_hz = bench.within(10.0, 40.0), cos_hz = sin_hz * bench.within(0.3, 0.9);
  Capture c = bench.capture(8000, 4000.0, 1, [&](double t) { return kTwoPi * sin_hz * t; });
  c.reference_deg.clear();
  for (std::size_t i = 0; i < c.size(); ++i)
    c.vcos_v[i] = kMiddleV + std::cos(kTwoPi * cos_hz * c.time_s[i]);
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(d.findings.empty()) << names(d);
  EXPECT_EQ(d.verdict, Verdict::insufficient_data) << left_of(d);
  EXPECT_NE(d.reason.find("draw no circle"), std::string::npos) << d.reason;
}

/// Through a cloud of readings goes a curve whose centre is outside of it: that is no turn.
KIND(a_shaft_that_rests_and_is_shaken_has_no_angle) {
  Bench bench;
  Capture c = bench.capture(80, 1.0, 1, [](double) { return 0.7; });
  c.reference_deg.clear();
  const double noise = bench.within(0.01, 0.02), far = bench.within(0.2, 1.0);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double moved = i > 20 && i < 32 ? far : 0.0;
    c.vsin_v[i] += bench.normal(noise) + moved * bench.within(-1.0, 1.0);
    c.vcos_v[i] += bench.normal(noise) + moved * bench.within(-1.0, 1.0);
  }
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(d.findings.empty()) << names(d);
  EXPECT_EQ(d.verdict, Verdict::insufficient_data) << left_of(d);
}

/// Its length comes down to a third, and still tells where the vector points.
KIND(a_length_that_wanders_far_still_draws_a_circle) {
  Bench bench;
  const double period_s = bench.within(0.5, 1.0);
  Capture c = bench.capture(8000, 2000.0, 1, wandering(bench, bench.within(4.0, 8.0), 0.01, 0.5));
  c.reference_deg.clear();
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double length = 0.67 + 0.33 * std::sin(kTwoPi * c.time_s[i] / period_s);
    for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
      (*v)[i] = kMiddleV + length * ((*v)[i] - kMiddleV);
  }
  EXPECT_NE(diagnose(c, {}).verdict, Verdict::insufficient_data);
}

/// A pair that stands still beside a reference that does not is none whose shaft rests.
TEST(Readings, APairThatStandsStillBesideAReferenceThatMovesIsToldSo) {
  Bench bench;
  bench.pair.amplitude_v = 0.0;
  const double turns = bench.within(0.05, 3.0);
  Capture c = bench.capture(2000, 1000.0, 1, [&](double t) { return kTwoPi * turns * t / 2.0; });
  const Diagnosis moves = diagnose(c, {});
  EXPECT_EQ(moves.verdict, Verdict::insufficient_data);
  EXPECT_NE(moves.reason.find("the reference moves by"), std::string::npos) << moves.reason;
  for (double &x : c.reference_deg)
    x = 30.0 + bench.normal(0.01);
  const Diagnosis rests = diagnose(c, {});
  EXPECT_NE(rests.reason.find("the shaft does not turn"), std::string::npos) << rests.reason;
}

/// What bends the radius of a pair within each turn bends its own angle as well. Of a shaft that
/// comes round at even intervals that is neither a tone nor a matter of speed.
KIND(a_pair_of_triangles_shows_neither_tone_nor_low_pass) {
  Bench bench;
  const double hz = bench.within(5.0, 15.0);
  Capture c = bench.capture(8000, 4000.0, 1, [&](double t) { return kTwoPi * hz * t; });
  c.reference_deg.clear();
  const auto triangle = [](double turn) {
    return 4.0 * std::abs(turn - std::floor(turn) - 0.5) - 1.0;
  };
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double turn = hz * c.time_s[i];
    c.vsin_v[i] = kMiddleV + 1.4 * triangle(turn + 0.25) + bench.within(-0.002, 0.002);
    c.vcos_v[i] = kMiddleV + 1.4 * triangle(turn) + bench.within(-0.002, 0.002);
  }
  const Diagnosis d = diagnose(c, {});
  EXPECT_FALSE(named(d, "periodic-interference") || named(d, "low-pass-rolloff")) << names(d);
  EXPECT_NE(d.verdict, Verdict::explained);
}

} // namespace
} // namespace ada::test

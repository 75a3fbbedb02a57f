// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Captures of benches that the catalogue does not describe. Their signals are made here, and not by
// the model that is fitted to them.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string_view>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "conversion/ellipse.h"
#include "diagnosis/bench.h"
#include "diagnosis/diagnose.h"
#include "recording/join.h"
#include "support/seed.h"

namespace ada::test {
namespace {

KIND(wrong_rows_of_the_reference_spoil_nothing) {
  Bench bench;
  const double rpm = bench.within(60.0, 200.0);
  Capture c = bench.capture(12000, 3000.0, 2, [&](double t) { return t * rpm / 60.0 * kTwoPi; });
  std::size_t wrong = 0;
  const double every = bench.within(20.0, 300.0);
  for (std::size_t i = 50; i + 50 < c.size();
       i += static_cast<std::size_t>(bench.within(0.5, 1.5) * every)) {
    // Of the counter: 180 deg to 11 deg, several times what a strongly elliptic pair does by
    // itself.
    const double bit = std::floor(bench.within(1.0, 6.0));
    c.reference_deg[i] = wrap(c.reference_deg[i] + 360.0 / std::exp2(bit), 360.0);
    ++wrong;
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_EQ(d.findings.size(), 2u);
  ASSERT_FALSE(d.structure.empty());
  const std::string &said = d.structure.front().description,
                    begin = "the reference alone is wrong in ";
  ASSERT_NE(said.find(begin), std::string::npos) << said;
  // A row in fifty may fall to either side beside the steepest stretch of a strongly elliptic pair.
  EXPECT_NEAR(std::stod(said.substr(said.find(begin) + begin.size())), static_cast<double>(wrong),
              2.0 + 0.02 * static_cast<double>(wrong))
      << said;
}

KIND(a_reference_that_jumps_at_a_steady_spin_is_the_one_to_blame) {
  Bench bench;
  Capture c = bench.capture(20000, 4000.0, 1, [](double t) { return 2.1 * kTwoPi * t; });
  const double step_deg = bench.within(0.15, 0.3), from = bench.within(60.0, 300.0);
  for (double &r : c.reference_deg)
    if (r > from)
      r -= step_deg;
  const Diagnosis d = diagnose(c, {});
  // Its second order, of no more than this amplitude, turns the vector as a mismatch does.
  expect_pair(d, bench.pair, step_deg * kRadPerDeg / (0.5 * kTwoPi));
  for (const char *innocent : {"stray-field", "sensor-off-axis", "field-direction-error"})
    EXPECT_FALSE(named(d, innocent)) << names(d);
}

KIND(lash_is_seen_where_the_shaft_turns_back_for_less_than_a_turn) {
  Bench bench;
  const double width_deg = bench.within(0.1, 0.3);
  const auto angle = [](double t) { return 6.0 * std::sin(0.69 * t) + 1.9 * t; };
  Capture c = bench.capture(24000, 2000.0, 2, angle);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double speed = 6.0 * 0.69 * std::cos(0.69 * c.time_s[i]) + 1.9;
    c.reference_deg[i] =
        wrap(c.reference_deg[i] + 0.5 * width_deg * std::tanh(speed / 0.02), 360.0);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "hysteresis");
  ASSERT_TRUE(f);
  EXPECT_NEAR(f->values[0], width_deg, 0.02 * width_deg);
}

KIND(a_shaft_that_is_slow_now_and_then_does_not_stop) {
  Bench bench;
  const double late_s = bench.within(2e-4, 8e-4);
  const auto angle = [&](double t) { // from standstill to 2.5 turns a second and back
    return kTwoPi * (1.2 * t - 0.62 * std::sin(1.9 * t));
  };
  Capture c = bench.capture(25000, 5000.0, 1, [&](double t) { return angle(t - late_s); });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(angle(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "propagation-delay");
  ASSERT_TRUE(f);
  EXPECT_NEAR(f->values[0], late_s, 0.02 * late_s);
}

KIND(fringes_there_and_back_are_no_tone) {
  Bench bench;
  // A mirror on a triangle of 60 fringes: the fringes are weaker the farther it is.
  const double far = 60.0 * kTwoPi, ramp_s = 1.0 / 3.0, less = bench.within(0.02, 0.06);
  const double start = bench.within(0.0, 1.0);
  const auto place = [&](double t) {
    const double u = std::fmod(t / ramp_s + start, 2.0);
    return far * std::abs(u - 1.0);
  };
  Capture c = bench.capture(40000, 20000.0, 1, place);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double x = place(c.time_s[i]) / far, seen = 1.0 - less * x * x;
    c.vsin_v[i] = 2.5 + (c.vsin_v[i] - 2.5) * seen;
    c.vcos_v[i] = 2.5 + (c.vcos_v[i] - 2.5) * seen;
  }
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_FALSE(named(d, "periodic-interference")) << names(d);
}

KIND(a_magnet_of_many_orders_hides_neither_mismatch_nor_quadrature) {
  Bench bench;
  const double rpm = bench.within(60.0, 300.0);
  std::vector<std::array<double, 2>> flaws; // size and phase, rad
  for (int order = 1; order <= 9; ++order)
    flaws.push_back({bench.within(0.5, 1.0) / order * kRadPerDeg, bench.within(0.0, kTwoPi)});
  const auto shaft = [&](double t) { return t * rpm / 60.0 * kTwoPi; };
  Capture c = bench.capture(30000, 1500.0, 2, [&](double t) {
    double angle = shaft(t);
    for (std::size_t k = 0; k < flaws.size(); ++k)
      angle += flaws[k][0] * std::sin(static_cast<double>(k + 1) * shaft(t) + flaws[k][1]);
    return angle;
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
  // A flaw turns the vector and leaves its length, all but a thousandth: what two of them of a
  // degree make together.
  expect_pair(diagnose(c, {}), bench.pair, 1e-3);
}

KIND(a_tone_near_the_frequency_of_the_pair_is_one_tone_without_a_reference) {
  Bench bench;
  const double turns_hz = bench.within(30.0, 45.0);
  Capture c = bench.capture(40000, 4000.0, 1, [&](double t) { return kTwoPi * turns_hz * t; });
  c.reference_deg.clear();
  const double off = bench.within(8.0, 16.0), tone_hz = turns_hz + off;
  const double sin_v = bench.within(0.003, 0.006), cos_v = bench.within(0.003, 0.006);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double phase = kTwoPi * tone_hz * c.time_s[i];
    c.vsin_v[i] += sin_v * std::sin(phase);
    c.vcos_v[i] += cos_v * std::sin(phase + 0.3);
  }
  const Diagnosis d = diagnose(c, {});
  std::size_t tones = 0;
  for (const Finding &f : d.findings)
    if (f.effect->info().id == "periodic-interference") {
      ++tones;
      EXPECT_NEAR(f.values[0], tone_hz, 0.01);
      EXPECT_NEAR(f.values[1], sin_v, 0.03 * sin_v) << names(d);
      EXPECT_NEAR(f.values[2], cos_v, 0.03 * cos_v) << names(d);
    }
  EXPECT_EQ(tones, 1u) << names(d);
}

/// Most of what the gain does between a cold capture and a warm one lies along the direction of a
/// supply that is not recorded: what the offsets do stands out of what is left across it.
KIND(a_cold_and_a_warm_capture_show_drift_and_no_wander) {
  Bench bench;
  const double tc = bench.within(-0.02, -0.01), warm_v = bench.within(0.8, 1.2);
  const double tc_sin = -bench.within(0.015, 0.02), tc_cos = -bench.within(0.025, 0.03);
  const double stray = bench.within(1.5e-3, 2.5e-3), direction = bench.within(0.0, kTwoPi);
  std::vector<std::shared_ptr<const Capture>> captures;
  for (int k = 0; k < 2; ++k) {
    const auto shaft = wandering(bench, 0.4, 0.7, 0.13);
    Capture c = bench.capture(5000, 200.0, 1, [&](double t) {
      return shaft(t) + stray * std::sin(direction - shaft(t));
    });
    for (std::size_t i = 0; i < c.size(); ++i) {
      c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
      c.vtemp_v.push_back(1.2 + k * warm_v + bench.normal(3e-4));
      c.vsin_v[i] += k * warm_v * (tc * (c.vsin_v[i] - 2.5) + tc_sin);
      c.vcos_v[i] += k * warm_v * (tc * (c.vcos_v[i] - 2.5) + tc_cos);
    }
    captures.push_back(std::make_shared<Capture>(std::move(c)));
  }
  const Diagnosis d = diagnose(*join(captures), {});
  const Finding *offset = named(d, "offset-temperature-drift"),
                *amplitude = named(d, "amplitude-temperature-drift");
  ASSERT_TRUE(offset && amplitude) << left_of(d);
  EXPECT_NEAR(offset->values[0], tc_sin, 0.05 * std::abs(tc_sin)) << names(d);
  EXPECT_NEAR(offset->values[1], tc_cos, 0.05 * std::abs(tc_cos)) << names(d);
  expect_none(d, {"offset-wander", "gain-wander"});
}

KIND(captures_may_have_another_zero_of_the_reference) {
  Bench bench;
  const double stray = bench.within(0.01, 0.04), direction = bench.within(0.0, kTwoPi);
  std::vector<std::shared_ptr<const Capture>> captures;
  for (int k = 0; k < 2; ++k) {
    // Some turns and a part of one, which bends a zero angle that knows nothing of the stray field.
    const double from = bench.within(0.0, kTwoPi), mounted_deg = bench.within(0.0, 360.0);
    const double hz = bench.within(6.3, 6.8) / 5.0;
    const auto shaft = [&](double t) { return from + kTwoPi * hz * t; };
    Capture c = bench.capture(10000, 2000.0, 2, [&](double t) {
      const double field = shaft(t);
      return field + std::atan2(stray * std::sin(direction - field),
                                1.0 + stray * std::cos(direction - field));
    });
    for (std::size_t i = 0; i < c.size(); ++i)
      c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad + mounted_deg, 360.0);
    captures.push_back(std::make_shared<Capture>(std::move(c)));
  }
  DiagnosisOptions judged_by_second;
  judged_by_second.heldout = captures[1].get();
  for (const Diagnosis &d : {diagnose(*join(captures), {}), // no slip where the second begins
                             diagnose(*captures[0], judged_by_second)}) {
    EXPECT_EQ(d.verdict, Verdict::explained) << names(d);
    EXPECT_EQ(d.findings.size(), 3u) << names(d);
    expect_pair(d, bench.pair);
    const Finding *f = named(d, "stray-field");
    ASSERT_TRUE(f) << names(d);
    // Five standard errors of an angle of so many samples.
    EXPECT_NEAR(f->values[0], stray,
                5.0 * bench.pair.noise_v / bench.pair.amplitude_v * std::sqrt(2.0 / 10000.0));
  }
}

KIND(an_air_gap_that_varies_along_a_stage_blurs_neither_mismatch_nor_quadrature) {
  Bench bench;
  // Twenty periods of a tape there and back, the gap another at every place.
  const double slow = bench.within(0.8, 1.1), start = bench.within(0.0, kTwoPi);
  const double wave = bench.within(25.0, 45.0), far = 20.0 * kTwoPi;
  const double size = bench.within(0.02, 0.04), slope = bench.within(0.01, 0.03);
  const auto place = [&](double t) { return 0.5 * far * (1.0 - std::cos(slow * t + start)); };
  Capture c = bench.capture(20000, 2000.0, 1, place);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double x = place(c.time_s[i]), gain = 1.0 + size * std::sin(x / wave) + slope * x / far;
    c.vsin_v[i] = 2.5 + (c.vsin_v[i] - 2.5) * gain;
    c.vcos_v[i] = 2.5 + (c.vcos_v[i] - 2.5) * gain;
  }
  const Diagnosis d = diagnose(c, {});
  // Ten standard errors of the noise: a length that wanders by 30 times as much counts no more.
  expect_pair(d, bench.pair, 10.0 * bench.pair.noise_v / bench.pair.amplitude_v / std::sqrt(1e4));
}

KIND(teeth_of_any_number_are_named_by_it) {
  Bench bench;
  const double hz = bench.within(1.0, 4.0), teeth = std::floor(bench.within(13.0, 41.0));
  const double ripple = bench.within(0.02, 0.08) / teeth; // of the speed, 2 to 8 %
  const auto shaft = [&](double t) {
    const double even = kTwoPi * hz * t;
    return even + ripple * std::sin(teeth * even);
  };
  Capture c = bench.capture(24000, 4000.0, 2, shaft);
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "rotation-nonuniformity");
  ASSERT_TRUE(f) << names(d);
  EXPECT_EQ(f->values[0], teeth);
  EXPECT_NEAR(f->values[1] * kRadPerDeg, ripple, 0.05 * ripple);
}

KIND(a_calibration_from_a_record_with_a_step_serves_what_comes_after_it) {
  Bench bench;
  const double at = bench.within(2.0, 6.0), sin_v = bench.within(0.01, 0.03);
  const double cos_v = -bench.within(0.005, 0.02);
  Capture c = bench.capture(16000, 2000.0, 2, wandering(bench, 2.0, 0.3, bench.within(0.1, 0.2)));
  for (std::size_t i = 0; i < c.size(); ++i)
    if (c.time_s[i] >= at) {
      c.vsin_v[i] += sin_v;
      c.vcos_v[i] += cos_v;
    }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  ASSERT_TRUE(named(d, "offset-step")) << names(d);
  const EllipseParameters e = EllipseModel(d.extended).parameters_at(0.0);
  // Five standard errors of a mean, which the pair's turning doubles.
  const double close = 10.0 * bench.pair.noise_v / std::sqrt(0.25 * 16000.0);
  EXPECT_NEAR(e.centre_sin_v, 2.5 + sin_v, close);
  EXPECT_NEAR(e.centre_cos_v, 2.5 + cos_v, close);
}

KIND(a_sine_encoder_of_a_thousand_lines_is_a_pair_as_any_other) {
  for (bool reference : {true, false}) {
    Bench bench;
    const double lines = std::floor(bench.within(500.0, 3000.0));
    const double wave_s = bench.within(0.5, 1.0);
    const auto shaft = [&](double t) {
      return kTwoPi / lines * (150.0 * t + 20.0 * std::sin(kTwoPi * t / wave_s));
    };
    Capture c = bench.capture(40000, 20000.0, static_cast<int>(lines), shaft);
    if (!reference)
      c.reference_deg.clear();
    const Diagnosis d = diagnose(c, {});
    expect_pair(d, bench.pair);
    EXPECT_EQ(d.verdict, Verdict::explained) << names(d);
  }
}

KIND(hum_of_the_mains_is_a_tone_without_a_reference) {
  Bench bench;
  Capture c = bench.capture(16000, 1000.0, 1,
                            wandering(bench, bench.within(1.1, 1.6), 0.3, bench.within(0.1, 0.16)));
  c.reference_deg.clear();
  const double sin_v = bench.within(0.004, 0.01), cos_v = bench.within(0.003, 0.006);
  const double hz = bench.within(49.95, 50.05);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double phase = kTwoPi * hz * c.time_s[i];
    c.vsin_v[i] += sin_v * std::sin(phase);
    c.vcos_v[i] += cos_v * std::sin(phase + 0.8);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "periodic-interference");
  ASSERT_TRUE(f) << names(d);
  EXPECT_NEAR(f->values[0], hz, 0.01);
  EXPECT_NEAR(f->values[1], sin_v, 0.03 * sin_v);
}

KIND(a_sound_pair_at_a_wandering_speed_has_no_discrepancy) {
  Bench bench;
  bench.pair.k = bench.pair.delta_rad = 0.0;
  Capture c = bench.capture(14000, 2000.0, 1, wandering(bench, 2.0, 0.004, bench.within(0.2, 0.6)));
  c.reference_deg.clear();
  // One channel is the noisier one.
  std::normal_distribution<> noise(0.0, bench.pair.noise_v);
  std::mt19937_64 rng(fresh_seed());
  for (double &v : c.vsin_v)
    v += noise(rng);
  const Diagnosis d = diagnose(c, {});
  EXPECT_EQ(d.verdict, Verdict::no_discrepancy)
      << names(d) << (d.structure.empty() ? "" : d.structure.front().description);
}

KIND(a_sound_pair_for_a_second_is_white_along_its_radius) {
  Bench bench;
  bench.pair.k = bench.pair.delta_rad = 0.0;
  const double hz = bench.within(3.0, 20.0);
  Capture c = bench.capture(10000, 10000.0, 2, [&](double t) { return kTwoPi * hz * t; });
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  EXPECT_EQ(d.verdict, Verdict::no_discrepancy)
      << names(d) << (d.structure.empty() ? "" : d.structure.front().description);
}

/// A motor that goes from step to step, each of which takes a while and is of uneven size.
KIND(a_stepper_without_a_reference_is_no_shaft_that_ripples) {
  Bench bench;
  bench.pair.noise_v = bench.within(1e-3, 3e-3);
  const double each_s = bench.within(0.03, 0.06), step_rad = bench.within(1.5, 4.0) * kRadPerDeg,
               takes = bench.within(0.3, 0.6), uneven = bench.within(0.05, 0.3);
  const std::size_t steps = static_cast<std::size_t>(8.0 / each_s) + 2;
  std::vector<double> at{0.0};
  for (std::size_t k = 0; k < steps; ++k) {
    const bool back = k > steps / 2; // faster there, and the other way
    at.push_back(at.back() +
                 (back ? -1.5 : 1.0) * step_rad * 4.0 * (1.0 + uneven * bench.within(-1.0, 1.0)));
  }
  Capture c = bench.capture(24000, 3000.0, 1, [&](double t) {
    const auto k = static_cast<std::size_t>(t / each_s);
    const double part = std::min(1.0, (t / each_s - static_cast<double>(k)) / takes);
    return at[k] + (at[k + 1] - at[k]) * 0.5 * (1.0 - std::cos(0.5 * kTwoPi * part));
  });
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_FALSE(named(d, "rotation-nonuniformity")) << names(d);
}

KIND(a_pair_on_one_line_tells_no_angle) {
  Bench bench;
  const double hz = bench.within(3.0, 20.0), of_sin = bench.within(-1.0, 1.0);
  Capture c = bench.capture(6000, 3000.0, 2, [&](double t) { return kTwoPi * hz * t; });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.vcos_v[i] = 2.5 + of_sin * (c.vsin_v[i] - 2.5);
  EXPECT_EQ(diagnose(c, {}).verdict, Verdict::insufficient_data);
  c.reference_deg.clear();
  EXPECT_EQ(diagnose(c, {}).verdict, Verdict::insufficient_data);
}

KIND(a_tone_beside_a_rough_motion_is_seen_along_the_radius) {
  Bench bench;
  const double hz = bench.within(20.0, 300.0), sin_v = bench.within(0.003, 0.01),
               cos_v = bench.within(0.5, 1.5) * sin_v, phase = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(20000, 2000.0, 2, wandering(bench, 2.0, 0.3, bench.within(0.1, 0.3)));
  c.reference_deg.clear();
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.vsin_v[i] += sin_v * std::sin(kTwoPi * hz * c.time_s[i]);
    c.vcos_v[i] += cos_v * std::sin(kTwoPi * hz * c.time_s[i] + phase);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "periodic-interference");
  ASSERT_TRUE(f) << names(d);
  EXPECT_NEAR(f->values[0], hz, 0.02);
  EXPECT_NEAR(f->values[1], sin_v, 0.05 * sin_v);
}

KIND(a_scan_that_is_paired_with_the_one_before_is_a_skew_of_one_period) {
  Bench bench;
  Capture c = bench.capture(20000, 2000.0, 2,
                            wandering(bench, bench.within(1.5, 4.0), 0.3, bench.within(0.1, 0.3)));
  c.vsin_v.insert(c.vsin_v.begin(), c.vsin_v.front());
  c.vsin_v.pop_back();
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "channel-skew");
  ASSERT_TRUE(f) << names(d);
  EXPECT_NEAR(f->values[0], 1.0 / 2000.0, 0.03 / 2000.0);
}

KIND(a_magnet_that_trembles_tells_no_angle) {
  Bench bench;
  // Up to 40 electrical degrees in all without a reference, and up to 10 beside one, of which 20
  // may be enough.
  double rad = bench.within(0.3, 10.0) * kTwoPi / 360.0;
  const double hz = bench.within(0.3, 20.0);
  const auto trembling = [&] {
    return bench.capture(10000, 2000.0, 2,
                         [&](double t) { return 0.7 + rad * std::sin(kTwoPi * hz * t); });
  };
  Capture c = trembling();
  c.reference_deg.clear();
  EXPECT_EQ(diagnose(c, {}).verdict, Verdict::insufficient_data) << rad << " rad";
  rad *= 0.25;
  EXPECT_EQ(diagnose(trembling(), {}).verdict, Verdict::insufficient_data) << rad << " rad";
}

/// Episodes of a contact that opens, of a converter that holds its values, or of a reference that
/// does.
Capture with_episodes(Bench &bench, Capture c) {
  const int episodes = static_cast<int>(bench.within(2.0, 9.0));
  const double level = bench.within(0.0, 1.0) < 0.5 ? 0.0 : bench.within(1.0, 5.0);
  const double what = bench.within(0.0, c.reference_deg.empty() ? 3.0 : 5.0);
  for (int k = 0; k < episodes; ++k) {
    const auto from =
        static_cast<std::size_t>(bench.within(0.02, 0.9) * static_cast<double>(c.size()));
    const auto length = static_cast<std::size_t>(bench.within(20.0, 120.0));
    for (std::size_t i = from; i < from + length; ++i) {
      if (what < 2.0)
        c.vsin_v[i] = level;
      if (what > 1.0 && what < 3.0)
        c.vcos_v[i] = level;
      if (what > 3.0 && what < 4.0) {
        c.vsin_v[i] = c.vsin_v[from];
        c.vcos_v[i] = c.vcos_v[from];
      }
      if (what > 4.0)
        c.reference_deg[i] = c.reference_deg[from];
    }
  }
  return c;
}

KIND(episodes_of_a_contact_or_of_values_held_hide_no_mismatch) {
  Bench bench;
  Capture c = with_episodes(
      bench, bench.capture(20000, 2000.0, 2, wandering(bench, 2.0, 0.3, bench.within(0.1, 0.3))));
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_EQ(d.verdict, Verdict::partly_explained) << names(d);
}

KIND(a_weak_pole_belongs_to_the_angle_and_is_no_contact) {
  Bench bench;
  const int periods = static_cast<int>(bench.within(8.0, 33.0));
  const double turns = bench.within(3.1, 6.0), pole = bench.within(0.0, kTwoPi),
               width = bench.within(0.05, 0.1), depth = bench.within(0.06, 0.12);
  const auto angle = [&](double t) { return kTwoPi * turns * t / 6.0; };
  Capture c = bench.capture(12000, 2000.0, periods, angle);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double off = wrap_centred(angle(c.time_s[i]) - pole, kTwoPi) / width;
    const double length = 1.0 - depth * std::exp(-0.5 * off * off);
    c.vsin_v[i] = 2.5 + length * (c.vsin_v[i] - 2.5);
    c.vcos_v[i] = 2.5 + length * (c.vcos_v[i] - 2.5);
  }
  const Diagnosis d = diagnose(c, {});
  // What such a pole holds of a mismatch and of a quadrature error.
  expect_pair(d, bench.pair, depth * width);
  for (const Structure &s : d.structure)
    EXPECT_EQ(s.description.find("contact"), std::string::npos) << s.description;
  EXPECT_TRUE(d.extended.remainder) << names(d);
}

KIND(episodes_of_a_contact_without_a_reference_hide_no_mismatch) {
  Bench bench;
  const double hz = bench.within(1.0, 5.0);
  Capture c = bench.capture(20000, 2000.0, 2, [&](double t) { return kTwoPi * hz * t; });
  c.reference_deg.clear();
  c = with_episodes(bench, std::move(c));
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_EQ(d.verdict, Verdict::partly_explained) << names(d);
}

KIND(a_reference_of_other_turns_is_said_with_its_number) {
  Bench bench;
  const int periods = static_cast<int>(bench.within(1.0, 9.0));
  const int stated = periods + (bench.within(0.0, 1.0) < 0.5 && periods > 1 ? -1 : 1);
  Capture c =
      bench.capture(8000, 2000.0, periods, wandering(bench, 2.0, 0.3, bench.within(0.1, 0.3)));
  c.meta.periods_per_turn = stated;
  const Diagnosis d = diagnose(c, {});
  EXPECT_EQ(d.verdict, Verdict::partly_explained) << left_of(d);
  const std::string said = "the pair makes " + std::to_string(periods);
  EXPECT_EQ(d.reference_aside.substr(0, said.size()), said) << d.reference_aside;
}

KIND(a_reference_that_creeps_is_no_gain_that_wanders) {
  Bench bench;
  const auto shaft = wandering(bench, bench.within(1.0, 3.0), 0.3, bench.within(0.1, 0.3));
  const double creep = bench.within(5e-4, 3e-3); // of a belt, a part of the way
  Capture c = bench.capture(20000, 2000.0, 2, shaft);
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap((1.0 + creep) * shaft(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  for (const char *innocent : {"gain-wander", "offset-wander", "flicker-noise", "hysteresis"})
    EXPECT_FALSE(named(d, innocent)) << names(d);
  EXPECT_NE(d.verdict, Verdict::explained) << names(d);
  EXPECT_NE(d.verdict, Verdict::no_discrepancy) << names(d);
}

KIND(a_lag_that_builds_up_after_each_reversal_is_hysteresis) {
  Bench bench;
  // An arm on an arc: no plain lag of one sign, and much that free columns could follow.
  const double far = bench.within(1.2, 1.5), slow = bench.within(0.8, 1.2);
  const double width = bench.within(0.3, 0.6) * kRadPerDeg,
               over = bench.within(0.4, 1.0) * kRadPerDeg;
  const auto arm = [&](double t) {
    return far * (0.8 * std::sin(slow * t) + 0.2 * std::sin(2.7 * slow * t));
  };
  double lag = 0.0, last = arm(0.0), at = 0.0;
  Capture c = bench.capture(12000, 300.0, 2, [&](double t) {
    while (at < t) { // fine steps of the path
      at = std::min(t, at + 2e-4);
      const double now = arm(at), step = now - last;
      lag += (std::copysign(0.5 * width, step) - lag) * (1.0 - std::exp(-std::abs(step) / over));
      last = now;
    }
    return arm(t) - lag;
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(arm(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "hysteresis");
  ASSERT_TRUE(f) << names(d);
  EXPECT_NEAR(f->values[0] * kRadPerDeg, width, 0.5 * width); // a plain lag is near it at most
  // What builds up at the ends of the arc bends it there, by a part of the lag in electrical angle.
  expect_pair(d, bench.pair, 0.5 * 2.0 * width);
}

KIND(a_crank_turned_by_hand_bends_neither_offsets_nor_axes) {
  Bench bench;
  bench.pair.noise_v = 3e-3;
  const double ripple = bench.within(2.0, 5.0) * kRadPerDeg, start = bench.within(0.0, kTwoPi);
  const auto slow = wandering(bench, 0.8, 0.3, bench.within(0.1, 0.3));
  Capture c = bench.capture(5600, 200.0, 1, [&](double t) {
    const double even = slow(t) + 0.1 * std::sin(2.1 * t);
    return even + ripple * std::sin(even + start);
  });
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  // Five standard errors of the radius of so many samples, and what names of the motion add.
  expect_pair(d, bench.pair,
              10.0 * bench.pair.noise_v / bench.pair.amplitude_v / std::sqrt(0.5 * 5600.0));
  EXPECT_NEAR(d.extended.baseline.offset_sin_v, 0.0, 1e-3);
  EXPECT_NEAR(d.extended.baseline.offset_cos_v, 0.0, 1e-3);
  EXPECT_FALSE(d.extended.remainder) << "what may be the shaft's is corrected";
}

KIND(lash_in_the_coupling_of_the_reference_is_no_hysteresis) {
  Bench bench;
  const double lash_deg = bench.within(0.1, 0.3);
  // There and back: the reference comes late, so that the sensor seems to lead.
  const auto angle = [](double t) { return 20.0 * std::sin(0.69 * t) + 1.9 * t; };
  Capture c = bench.capture(24000, 2000.0, 2, angle);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double speed = 20.0 * 0.69 * std::cos(0.69 * c.time_s[i]) + 1.9;
    c.reference_deg[i] = wrap(c.reference_deg[i] - 0.5 * lash_deg * std::tanh(speed / 0.02), 360.0);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_FALSE(named(d, "hysteresis")) << names(d);
}

/// Captures of one sensor, each at another temperature or speed, with a reference and a zero angle.
Diagnosis of_several(Bench &bench, const std::function<void(Capture &, int)> &change,
                     const std::array<double, 3> &turns_hz) {
  std::vector<std::shared_ptr<const Capture>> captures;
  for (int k = 0; k < 3; ++k) {
    const double from = bench.within(0.0, kTwoPi), mounted_deg = bench.within(0.0, 360.0);
    const double hz = turns_hz[static_cast<std::size_t>(k)];
    Capture c = bench.capture(10000, 2000.0, 2, [=](double t) { return from + kTwoPi * hz * t; });
    for (double &r : c.reference_deg)
      r = wrap(r + mounted_deg, 360.0);
    change(c, k);
    captures.push_back(std::make_shared<Capture>(std::move(c)));
  }
  return diagnose(*join(captures), {});
}

KIND(three_captures_at_three_temperatures_show_the_drift) {
  Bench bench;
  const std::array<double, 3> vtemp{bench.within(1.4, 1.6), bench.within(2.4, 2.6),
                                    bench.within(1.9, 2.1)};
  const double mean = (vtemp[0] + vtemp[1] + vtemp[2]) / 3.0;
  const double tc_sin = bench.within(0.01, 0.03), tc = -bench.within(0.1, 0.18);
  const Diagnosis d =
      of_several(bench,
                 [&](Capture &c, int k) {
                   const double v = vtemp[static_cast<std::size_t>(k)] - mean;
                   std::mt19937_64 rng(fresh_seed());
                   std::normal_distribution<> noise(0.0, 3e-4);
                   for (std::size_t i = 0; i < c.size(); ++i) {
                     c.vtemp_v.push_back(vtemp[static_cast<std::size_t>(k)] + noise(rng));
                     c.vsin_v[i] = 2.5 + (c.vsin_v[i] - 2.5) * (1.0 + tc * v) + tc_sin * v;
                     c.vcos_v[i] = 2.5 + (c.vcos_v[i] - 2.5) * (1.0 + tc * v);
                   }
                 },
                 {2.0, 2.4, 1.7});
  expect_pair(d, bench.pair);
  const Finding *offset = named(d, "offset-temperature-drift"),
                *amplitude = named(d, "amplitude-temperature-drift");
  ASSERT_TRUE(offset && amplitude) << names(d);
  EXPECT_NEAR(offset->values[0], tc_sin, 0.03 * tc_sin);
  EXPECT_NEAR(amplitude->values[0], tc, 0.03 * std::abs(tc));
  EXPECT_EQ(d.verdict, Verdict::explained);
}

KIND(three_captures_at_one_speed_each_show_a_skew) {
  Bench bench;
  const double late_s = bench.within(15e-6, 40e-6);
  const std::array<double, 3> hz{bench.within(3.0, 6.0), -bench.within(3.0, 6.0),
                                 bench.within(12.0, 20.0)};
  const Diagnosis d = of_several(
      bench,
      [&](Capture &c, int k) {
        // VCOS as it is so much later: turned on by that angle, exactly.
        const double turn = 2.0 * kTwoPi * hz[static_cast<std::size_t>(k)] * late_s;
        const double a = bench.pair.amplitude_v * (1.0 - 0.5 * bench.pair.k);
        const double b = bench.pair.amplitude_v * (1.0 + 0.5 * bench.pair.k);
        const double cd = std::cos(bench.pair.delta_rad), sd = std::sin(bench.pair.delta_rad);
        for (std::size_t i = 0; i < c.size(); ++i) {
          // sin of VCOS's own phase, from both channels.
          const double cosine = (c.vcos_v[i] - 2.5) / a, sine = (c.vsin_v[i] - 2.5) / b;
          const double own = (sine - cosine * sd) / cd;
          c.vcos_v[i] = 2.5 + a * (cosine * std::cos(turn) - own * std::sin(turn));
        }
      },
      hz);
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "channel-skew");
  ASSERT_TRUE(f) << names(d);
  EXPECT_NEAR(f->values[0], late_s, 0.05 * late_s);
}

} // namespace
} // namespace ada::test

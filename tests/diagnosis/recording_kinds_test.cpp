// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Captures as people record them: slowly, for a short time, at one speed each, with a reference
// that is late now and then. Their signals are made here, and not by the model that is fitted to
// them.

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "diagnosis/bench.h"
#include "recording/join.h"

namespace ada::test {
namespace {

double steady(double rpm, double t) {
  return t * rpm / 60.0 * kTwoPi;
}

KIND(mains_beside_an_order_of_the_turn_is_told_from_it) {
  Bench bench;
  const double duration = bench.within(5.0, 8.0), mains_hz = bench.within(49.9, 50.1);
  // The next order lies one to two and a half widths of a line away.
  const double order = std::floor(bench.within(12.0, 30.0)),
               turn_hz = (mains_hz + bench.within(1.2, 2.5) / duration) / order;
  Capture c = bench.capture(static_cast<std::size_t>(1500.0 * duration), 1500.0, 2,
                            [&](double t) { return steady(60.0 * turn_hz, t); });
  const double sin_v = bench.within(4.0, 8.0) * bench.pair.noise_v,
               cos_v = bench.within(0.5, 1.0) * sin_v, phase = bench.within(0.0, kTwoPi);
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.vsin_v[i] += sin_v * std::sin(kTwoPi * mains_hz * c.time_s[i] + phase);
    c.vcos_v[i] += cos_v * std::sin(kTwoPi * mains_hz * c.time_s[i]);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *tone = named(d, "periodic-interference");
  ASSERT_TRUE(tone) << names(d);
  EXPECT_NEAR(tone->values[0], mains_hz, 0.02);
}

KIND(a_climate_chamber_that_cycles_makes_no_tone) {
  Bench bench;
  const double cycles = bench.within(3.0, 6.0), rpm = bench.within(30.0, 60.0);
  Capture c = bench.capture(4000, 5.0, 2, [&](double t) { return steady(rpm, t); });
  const auto either = [&](double low, double high) {
    return bench.within(low, high) * (bench.within(-1.0, 1.0) < 0.0 ? -1.0 : 1.0);
  };
  const double tc_sin = either(0.03, 0.08), tc_cos = either(0.03, 0.08), c_sin = either(0.04, 0.1),
               c_cos = either(0.04, 0.1), start = bench.within(0.0, kTwoPi);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double u = 0.35 * std::sin(start + kTwoPi * cycles * c.time_s[i] / c.time_s.back());
    c.vtemp_v.push_back(1.5 + u + bench.normal(3e-4));
    c.vsin_v[i] += tc_sin * u + c_sin * u * u;
    c.vcos_v[i] += tc_cos * u + c_cos * u * u;
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *bend = named(d, "offset-temperature-curvature");
  ASSERT_TRUE(bend) << names(d);
  EXPECT_NEAR(bend->values[0], c_sin, 0.02 * std::abs(c_sin));
  EXPECT_NEAR(bend->values[1], c_cos, 0.02 * std::abs(c_cos));
  expect_none(d, {"periodic-interference", "offset-wander", "gain-wander"});
}

KIND(records_of_one_speed_each_show_a_low_pass_and_nothing_that_their_zeros_hold) {
  Bench bench;
  const double corner_hz = bench.within(600.0, 1500.0);
  std::vector<std::shared_ptr<const Capture>> captures;
  for (double rpm : {300.0, -1000.0, 3000.0, -6000.0, 12000.0}) {
    const double zero = bench.within(0.0, kTwoPi), x = std::abs(rpm) / 60.0 / corner_hz,
                 gain = 1.0 / std::sqrt(1.0 + x * x), late = std::copysign(std::atan(x), rpm);
    Capture c =
        bench.capture(1500, 5000.0, 1, [&](double t) { return steady(rpm, t) + zero - late; });
    for (std::size_t i = 0; i < c.size(); ++i) {
      c.vsin_v[i] = 2.5 + gain * (c.vsin_v[i] - 2.5);
      c.vcos_v[i] = 2.5 + gain * (c.vcos_v[i] - 2.5);
      c.reference_deg[i] = wrap(steady(rpm, c.time_s[i]) * kDegPerRad, 360.0);
    }
    c.identity = std::to_string(rpm);
    captures.push_back(std::make_shared<Capture>(std::move(c)));
  }
  const Diagnosis d = diagnose(*join(captures), {});
  expect_pair(d, bench.pair);
  const Finding *low_pass = named(d, "low-pass-rolloff");
  ASSERT_TRUE(low_pass) << names(d);
  EXPECT_NEAR(low_pass->values[0], corner_hz, 0.02 * corner_hz);
  expect_none(d, {"gain-wander", "hysteresis", "propagation-delay", "channel-skew"});
}

KIND(a_reference_that_falls_behind_now_and_then_loses_no_samples) {
  Bench bench;
  // A turn, and the lag, in whole rows: a jump back by the lag is one ahead by the rest of a turn.
  const double rows_a_turn = std::floor(bench.within(270.0, 800.0)),
               rpm = 60.0 * 4000.0 / rows_a_turn,
               late_s = std::floor(bench.within(3.0, 6.0)) / 4000.0;
  Capture c = bench.capture(12000, 4000.0, 2, [&](double t) { return steady(rpm, t); });
  bool late = false;
  for (std::size_t i = 0, until = 500; i < c.size(); ++i) {
    if (i == until) {
      late = !late;
      until +=
          static_cast<std::size_t>(late ? bench.within(200.0, 900.0) : bench.within(700.0, 2500.0));
    }
    if (late)
      c.reference_deg[i] = wrap(steady(rpm, c.time_s[i] - late_s) * kDegPerRad, 360.0);
  }
  expect_none(diagnose(c, {}), {"sample-loss"});
}

KIND(rows_in_any_order_of_the_places_in_a_turn_tell_the_pair) {
  Bench bench;
  Capture c = bench.capture(1500, 0.8, 1, [](double) { return 0.0; }); // at rest in each row
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double angle = bench.within(0.0, kTwoPi), psi = angle + bench.pair.zero_rad,
                 half = 0.5 * bench.pair.delta_rad;
    c.reference_deg[i] = angle * kDegPerRad;
    c.vsin_v[i] = 2.5 + bench.pair.amplitude_v * (1.0 + 0.5 * bench.pair.k) * std::sin(psi + half) +
                  bench.normal(bench.pair.noise_v);
    c.vcos_v[i] = 2.5 + bench.pair.amplitude_v * (1.0 - 0.5 * bench.pair.k) * std::cos(psi - half) +
                  bench.normal(bench.pair.noise_v);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_EQ(d.findings.size(), 2u) << names(d);
  EXPECT_EQ(d.verdict, Verdict::explained);
}

KIND(a_magnet_that_changes_sides_now_and_then_is_no_harmonic_of_the_reference) {
  Bench bench;
  const double rpm = bench.within(500.0, 900.0), play = bench.within(0.15, 0.4) * kRadPerDeg;
  const double turns = bench.within(2.0, 5.0), start = bench.within(0.0, kTwoPi); // in all
  const std::size_t n = 12000;
  const double rate = 4000.0, span = static_cast<double>(n) / rate;
  Capture c = bench.capture(n, rate, 2, [&](double t) {
    return steady(rpm, t) + play * std::tanh(8.0 * std::sin(start + kTwoPi * turns * t / span));
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(steady(rpm, c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  expect_none(d, {"reference-harmonic"});
}

KIND(three_steady_speeds_tell_which_of_sensor_and_reference_is_off_centre) {
  Bench bench;
  // A second each, two turns of the slow one, with a sixth of a second from one to the next.
  const std::array<double, 3> turns_hz{2.0, bench.within(12.0, 18.0), -bench.within(7.0, 10.0)};
  std::vector<double> angle{0.0};
  const double rate = 6000.0;
  for (std::size_t i = 1; i < 20000; ++i) {
    const double t = static_cast<double>(i) / rate, u = std::min(2.0, std::floor(t / (7.0 / 6.0)));
    const auto k = static_cast<std::size_t>(u);
    const double into = std::clamp(6.0 * (t - u * 7.0 / 6.0 - 1.0), 0.0, 1.0);
    const double next = turns_hz[std::min<std::size_t>(2, k + 1)];
    angle.push_back(angle.back() +
                    kTwoPi / rate * std::lerp(turns_hz[k], next, into * into * (3.0 - 2.0 * into)));
  }
  const auto shaft = [&](double t) {
    return angle[static_cast<std::size_t>(std::lround(t * rate))];
  };
  const double e_deg = bench.within(0.1, 0.3), phase = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(angle.size(), rate, 2, shaft);
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(c.reference_deg[i] + e_deg * std::sin(angle[i] + phase), 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "reference-eccentricity");
  ASSERT_TRUE(f) << names(d);
  EXPECT_NEAR(f->values[0], e_deg, 0.02 * e_deg);
  expect_none(d, {"stray-field"});
}

KIND(two_converters_that_take_turns_are_no_noise) {
  Bench bench;
  const double rpm = bench.within(150.0, 400.0);
  Capture c = bench.capture(10000, 3000.0, 2, [&](double t) { return steady(rpm, t); });
  const double sin_v = bench.within(4.0, 8.0) * bench.pair.noise_v,
               cos_v = bench.within(-1.0, 1.0) * sin_v;
  const double other_gain = 1.0 + bench.within(0.002, 0.006);
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.vsin_v[i] = i % 2 ? 2.5 + other_gain * (c.vsin_v[i] - 2.5) + sin_v : c.vsin_v[i] - sin_v;
    c.vcos_v[i] = i % 2 ? 2.5 + other_gain * (c.vcos_v[i] - 2.5) + cos_v : c.vcos_v[i] - cos_v;
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  expect_none(d, {"excess-noise", "amplitude-noise", "angle-noise", "timing-jitter"});
  EXPECT_NE(d.verdict, Verdict::explained); // no cause of the catalogue has that frequency
}

/// One channel is noisier than the other, and now and then the host does something else.
Capture polled_by_hand(Bench &bench) {
  const double turns = bench.within(4.0, 8.0), duration = bench.within(50.0, 80.0),
               push_hz = bench.within(0.4, 0.8), hand_hz = bench.within(1.0, 2.5),
               depth = bench.within(0.6, 0.95), start = bench.within(0.0, kTwoPi);
  constexpr double kDense = 2000.0;
  const double speed = kTwoPi * turns / duration;
  const auto angle = [&](double t) {
    return speed * (t + depth * std::sin(kTwoPi * push_hz * t + start) / (kTwoPi * push_hz) +
                    0.25 * std::sin(kTwoPi * hand_hz * t) / (kTwoPi * hand_hz));
  };
  const Capture dense =
      bench.capture(static_cast<std::size_t>(kDense * duration), kDense, 1, angle);
  Capture c;
  c.meta = dense.meta;
  for (double at = 0.0;;) {
    at += kDense * bench.within(0.008, 0.012);
    if (bench.within(0.0, 1.0) < 0.02)
      at -= kDense * 0.3 * std::log(bench.within(0.0, 1.0));
    const auto i = static_cast<std::size_t>(at);
    if (i >= dense.size())
      return c;
    c.time_s.push_back(dense.time_s[i]);
    c.vsin_v.push_back(dense.vsin_v[i]);
    c.vcos_v.push_back(dense.vcos_v[i] + bench.normal(3.0 * bench.pair.noise_v));
  }
}

KIND(gaps_in_a_polled_clock_make_no_spikes) {
  Bench bench;
  constexpr int kCaptures = 6; // one of three shows it
  for (int k = 0; k < kCaptures; ++k)
    expect_none(diagnose(polled_by_hand(bench), {}), {"impulse-noise"});
}

/// Both leads carry a tone, against each other, and are exchanged in the plug: what is recorded of
/// it is the other one's.
KIND(a_tone_on_exchanged_leads_is_a_tone) {
  Bench bench;
  const double hz = bench.within(90.0, 200.0), from = bench.within(0.0, kTwoPi);
  const double v = bench.within(2e-3, 4e-3);
  Capture c = bench.capture(8000, 500.0, 1, wandering(bench, 0.7, 0.5, 0.11));
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double tone = v * std::sin(kTwoPi * hz * c.time_s[i] + from);
    c.vsin_v[i] += tone;
    c.vcos_v[i] -= tone;
    std::swap(c.vsin_v[i], c.vcos_v[i]);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *tone = named(d, "periodic-interference");
  ASSERT_TRUE(tone) << left_of(d);
  EXPECT_NEAR(tone->values[0], hz, 0.02) << names(d);
  EXPECT_NEAR(tone->values[1], v, 0.1 * v) << names(d);
  EXPECT_NEAR(tone->values[2], v, 0.1 * v) << names(d);
  EXPECT_EQ(d.verdict, Verdict::explained) << left_of(d);
}

/// Rows that come when a program gets round to reading them: what the pair moves from one to the
/// next is not smooth, and no noise.
KIND(the_noise_of_rows_that_come_unevenly_is_not_the_motion) {
  for (const bool reference : {false, true}) {
    Bench bench;
    constexpr std::size_t kRows = 1800;
    std::vector<double> when{0.0};
    for (std::size_t i = 1; i < kRows; ++i)
      when.push_back(when.back() + 0.004 * bench.within(0.3, 1.9));
    const double speed = bench.within(1.0, 2.5);
    // The bench counts rows: the angle is that of the moment at which the row was read.
    Capture c = bench.capture(kRows, 1.0, 2, [&](double row) {
      return kTwoPi * speed * when[static_cast<std::size_t>(row)];
    });
    c.time_s = when;
    if (!reference)
      c.reference_deg.clear();
    for (double &deg : c.reference_deg)
      deg = 0.5 * std::round(deg / 0.5);
    const Diagnosis d = diagnose(c, {});
    EXPECT_NEAR(d.noise_rms_v, bench.pair.noise_v, 0.15 * bench.pair.noise_v) << left_of(d);
    expect_pair(d, bench.pair);
  }
}

} // namespace
} // namespace ada::test

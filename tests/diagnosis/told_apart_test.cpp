// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Causes that lean on each other, that happen at once, or that look like one another, and numbers
// that were typed wrong. The signals are made here, and not by the model that is fitted to them.

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

bool may_be(const Finding &f, std::string_view id) {
  return f.effect->info().id == id ||
         std::find(f.alternatives.begin(), f.alternatives.end(), id) != f.alternatives.end();
}

/// A dial set to even places, a voltmeter read to 10 mV, and one number with a wrong digit.
KIND(a_number_typed_wrong_hides_no_pair_and_is_said) {
  Bench bench;
  bench.pair.k = bench.within(0.04, 0.1);
  bench.pair.delta_rad = bench.within(0.8, 2.0) * kRadPerDeg;
  bench.pair.noise_v = 0.002;
  const auto rows = static_cast<std::size_t>(bench.within(36.0, 100.0));
  const auto place = [&](double t) { return kTwoPi * t / static_cast<double>(rows); };
  Capture c = bench.capture(rows, 1.0, 2, place);
  const auto wrong = static_cast<std::size_t>(bench.within(3.0, static_cast<double>(rows) - 3.0));
  (bench.within(-1.0, 1.0) < 0.0 ? c.vsin_v : c.vcos_v)[wrong] +=
      std::copysign(0.1 * std::floor(bench.within(2.0, 9.0)), bench.within(-1.0, 1.0));
  for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
    for (double &x : *v)
      x = 0.01 * std::round(100.0 * x);
  const Diagnosis d = diagnose(c, {});
  const Finding *k = named(d, "amplitude-mismatch"), *delta = named(d, "quadrature-error");
  ASSERT_TRUE(k && delta) << left_of(d);
  constexpr double kErrors = 4.0; // standard, as they are stated
  EXPECT_NEAR(k->values[0], bench.pair.k, kErrors * k->std_errors[0]);
  EXPECT_NEAR(delta->values[0], bench.pair.delta_rad * kDegPerRad, kErrors * delta->std_errors[0]);
  EXPECT_NE(left_of(d).find("depart from what is about them"), std::string::npos) << left_of(d);
  EXPECT_LT(d.extended_quality.heldout.residual_rms_v, 0.01) << left_of(d);
}

/// An incremental reference that misses counts at a dirty place and has them again from its index
/// on: what it does repeats with the turn, and no two causes that cancel are it.
KIND(a_reference_that_misses_counts_in_a_part_of_the_turn_bends_no_angle) {
  Bench bench;
  bench.pair.k = bench.within(0.01, 0.03);
  const double missed = bench.within(0.2, 0.6), from = bench.within(30.0, 150.0),
               index = bench.within(200.0, 330.0);
  Capture c = bench.capture(6000, 800.0, 2, [](double t) { return 4.0 * kTwoPi * t; });
  for (double &deg : c.reference_deg) {
    const double turn = wrap(deg, 360.0);
    deg = wrap(deg - (turn > from && turn < index ? missed : 0.0), 360.0);
  }
  const Diagnosis d = diagnose(c, {});
  const double seen_deg = missed * std::sqrt((index - from) / 360.0);
  // What is given to the sensor and not to the reference is no larger than what the reference does.
  if (const Finding *stray = named(d, "stray-field")) {
    EXPECT_LT(stray->values[0], 2.0 * seen_deg * kRadPerDeg) << left_of(d);
  }
  EXPECT_NE(d.verdict, Verdict::explained) << left_of(d);
}

/// A magnet that is glued anew stands otherwise, and the offsets move as well.
KIND(a_slip_beside_a_step_of_the_offsets_is_named_as_well) {
  Bench bench;
  const double at_s = bench.within(3.0, 7.0), slip = bench.within(0.5, 1.5) * kRadPerDeg,
               step_v = 0.01 * bench.pair.amplitude_v;
  Capture c = bench.capture(5000, 500.0, 1, [&](double t) {
    return kTwoPi * (2.0 * t + 0.1 * t * t) + (t > at_s ? slip : 0.0);
  });
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double t = c.time_s[i];
    c.reference_deg[i] = wrap(360.0 * (2.0 * t + 0.1 * t * t), 360.0);
    c.vsin_v[i] += t > at_s ? step_v : 0.0;
    c.vcos_v[i] -= t > at_s ? 0.7 * step_v : 0.0;
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *slipped = named(d, "angle-slip"), *stepped = named(d, "offset-step");
  ASSERT_TRUE(slipped) << left_of(d);
  ASSERT_TRUE(stepped) << left_of(d);
  EXPECT_NEAR(slipped->values[1], slip * kDegPerRad, 0.1 * slip * kDegPerRad);
  EXPECT_NEAR(stepped->values[1], step_v, 0.1 * step_v);
  EXPECT_EQ(d.verdict, Verdict::explained) << left_of(d);
}

/// An iron yoke remembers: what trails comes up over a good part of a turn after each way back. At
/// one speed nobody tells it from a delay, and it is no low pass alone.
KIND(what_comes_up_after_a_way_back_is_named_with_what_looks_like_it) {
  Bench bench;
  const double lag = bench.within(0.2, 0.5) * kRadPerDeg,
               over = bench.within(30.0, 70.0) * kRadPerDeg;
  const double period_s = 12.0, speed = bench.within(1.2, 2.0);
  const auto shaft = [&](double t) {
    const double in = std::fmod(t, period_s);
    return speed * (in < 0.5 * period_s ? in : period_s - in);
  };
  double trails = 0.0, last = 0.0;
  Capture c = bench.capture(3600, 60.0, 2, [&](double t) {
    const double way = shaft(t) - last;
    last = shaft(t);
    trails += (std::copysign(lag, way) - trails) * std::min(1.0, std::abs(way) / over);
    return shaft(t) - trails;
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = shaft(c.time_s[i]) * kDegPerRad;
  const Diagnosis d = diagnose(c, {});
  const auto trailing = std::find_if(d.findings.begin(), d.findings.end(), [](const Finding &f) {
    return may_be(f, "propagation-delay") || may_be(f, "hysteresis");
  });
  ASSERT_NE(trailing, d.findings.end()) << left_of(d);
  expect_pair(d, bench.pair);
}

/// Hall plates with the planar effect: each channel has a second harmonic of its own. Without VTEMP
/// nothing tells a quadrature error from a memory of the multiplexer, and every pair has the one.
KIND(a_quadrature_error_beside_second_harmonics_comes_before_a_memory) {
  Bench bench;
  bench.pair.delta_rad = bench.within(1.5, 3.0) * kRadPerDeg;
  const auto turn = [](double t) { return kTwoPi * 1.5 * t; };
  Capture c = bench.capture(2000, 105.0, 1, turn);
  const double sin_v = bench.within(0.01, 0.03) * bench.pair.amplitude_v,
               cos_v = bench.within(0.01, 0.03) * bench.pair.amplitude_v,
               phase = bench.within(0.0, kTwoPi);
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.vsin_v[i] += sin_v * std::sin(2.0 * turn(c.time_s[i]) + phase);
    c.vcos_v[i] += cos_v * std::cos(2.0 * turn(c.time_s[i]) - phase);
  }
  c.reference_deg.clear();
  expect_none(diagnose(c, {}), {"multiplexer-memory"});
}

/// Two speeds that follow one another once: that the angle is off by a constant from then on, and
/// that it lags by more, is the same. Back at the first speed they differ.
KIND(a_delay_at_two_speeds_once_may_be_a_slip_where_the_speed_changed) {
  Bench bench;
  const double first = kTwoPi * bench.within(1.0, 3.0), second = kTwoPi * bench.within(8.0, 16.0),
               off = bench.within(0.2, 0.6) * kRadPerDeg, hold_s = 3.0;
  for (const bool back : {false, true}) {
    const double end_s = (back ? 3.0 : 2.0) * hold_s;
    const auto shaft = [&](double t) {
      const double fast_s = std::clamp(t - hold_s, 0.0, hold_s);
      return first * (t - fast_s) + second * fast_s;
    };
    Capture c = bench.capture(static_cast<std::size_t>(end_s * 2000.0), 2000.0, 2, [&](double t) {
      return shaft(t) - (t >= hold_s && t < 2.0 * hold_s ? off : 0.0);
    });
    for (std::size_t i = 0; i < c.size(); ++i)
      c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
    const Diagnosis d = diagnose(c, {});
    const Finding *late = named(d, "propagation-delay");
    ASSERT_TRUE(late) << left_of(d);
    EXPECT_EQ(may_be(*late, "angle-slip"), !back) << left_of(d);
    EXPECT_TRUE(may_be(*late, "reference-delay")) << left_of(d);
  }
}

/// A shaft that stands for a while at each of some speeds up to `most_hz`, smoothly in between.
std::function<double(double)> many_speeds(double most_hz, double seconds) {
  return [=](double t) {
    const double w = kTwoPi / seconds;
    return kTwoPi * most_hz * (0.55 * t - 0.45 / w * std::sin(w * t));
  };
}

/// An RC ahead of a converter that reads late: its equation is solved here step by step.
KIND(a_delay_and_a_low_pass_are_both_told) {
  Bench bench;
  const double rate = 20000.0, corner_hz = bench.within(2000.0, 5000.0),
               delay_s = bench.within(30e-6, 60e-6);
  const auto angle = many_speeds(100.0, 1.0);
  Bench silent = bench;
  silent.pair.noise_v = 0.0;
  constexpr int kFiner = 16;
  const Capture fine = silent.capture(40000 * kFiner, rate * kFiner, 2,
                                      [&](double t) { return angle(t - delay_s); });
  Capture c = bench.capture(40000, rate, 2, angle);
  const double keeps = std::exp(-kTwoPi * corner_hz / (rate * kFiner));
  // Between two of the fine steps the input goes in a straight line, near enough.
  double s = fine.vsin_v[0], cc = fine.vcos_v[0];
  for (std::size_t i = 0; i < fine.size(); ++i) {
    if (i > 0) {
      s = keeps * s + (1.0 - keeps) * 0.5 * (fine.vsin_v[i] + fine.vsin_v[i - 1]);
      cc = keeps * cc + (1.0 - keeps) * 0.5 * (fine.vcos_v[i] + fine.vcos_v[i - 1]);
    }
    if (i % kFiner == 0) {
      c.vsin_v[i / kFiner] = s + bench.normal(bench.pair.noise_v);
      c.vcos_v[i / kFiner] = cc + bench.normal(bench.pair.noise_v);
    }
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *pass = named(d, "low-pass-rolloff"), *late = named(d, "propagation-delay");
  if (!late)
    late = named(d, "reference-delay");
  ASSERT_TRUE(pass && late) << left_of(d);
  EXPECT_NEAR(pass->values[0], corner_hz, 0.1 * corner_hz) << left_of(d);
  EXPECT_NEAR(late->values[0], delay_s, 0.1 * delay_s) << left_of(d);
}

/// Without a reference nothing shows a lag that both channels have.
KIND(a_mean_over_rows_in_one_channel_is_no_low_pass_of_both) {
  Bench bench;
  const auto rows = static_cast<std::size_t>(bench.within(4.0, 8.99));
  Capture c = bench.capture(30000, 10000.0, 2, many_speeds(bench.within(25.0, 35.0), 1.5));
  std::vector<double> mean(c.size());
  for (std::size_t i = 0; i < c.size(); ++i) {
    const std::size_t first = i + 1 >= rows ? i + 1 - rows : 0;
    for (std::size_t k = first; k <= i; ++k)
      mean[i] += c.vcos_v[k] / static_cast<double>(i + 1 - first);
  }
  c.vcos_v = mean;
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"low-pass-rolloff", "clipping", "propagation-delay"});
  EXPECT_TRUE(named(d, "channel-skew")) << left_of(d);
}

} // namespace
} // namespace ada::test

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Benches on which something slow, something fast or the record itself hides what is there: gains
// that wander, converters that average or hold, outputs at their stops, short records.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "diagnosis/bench.h"
#include "diagnosis/conditions/held_rows.h"
#include "recording/join.h"

namespace ada::test {
namespace {

constexpr double kMiddleV = 2.5;

/// A course that wanders: a few half waves of random size, of unit rms over the record.
std::function<double(double)> course(Bench &bench, double span_s) {
  constexpr int kWaves = 4;
  std::array<double, kWaves> size;
  double sum = 0.0;
  for (double &s : size) {
    s = bench.within(-1.0, 1.0);
    sum += 0.5 * s * s;
  }
  return [=](double t) {
    double out = 0.0;
    for (int k = 0; k < kWaves; ++k)
      out += size[static_cast<std::size_t>(k)] * std::cos(0.5 * kTwoPi * (k + 1) * t / span_s);
    return out / std::sqrt(sum);
  };
}

void turn_by(Capture &c, std::size_t i, double gain) {
  c.vsin_v[i] = kMiddleV + gain * (c.vsin_v[i] - kMiddleV);
  c.vcos_v[i] = kMiddleV + gain * (c.vcos_v[i] - kMiddleV);
}

KIND(a_gain_that_wanders_hides_neither_the_pair_nor_offsets_that_wander_less) {
  Bench bench;
  constexpr double kSpan = 60.0;
  const double rps = bench.within(1.5, 3.0), fraction = bench.within(0.05, 0.1);
  Capture c = bench.capture(12000, 200.0, 2, [&](double t) { return rps * kTwoPi * t; });
  const auto gain = course(bench, kSpan), sin = course(bench, kSpan), cos = course(bench, kSpan);
  const double sin_v = bench.within(0.01, 0.02), cos_v = bench.within(0.01, 0.02);
  for (std::size_t i = 0; i < c.size(); ++i) {
    turn_by(c, i, 1.0 + fraction * gain(c.time_s[i]));
    c.vsin_v[i] += sin_v * sin(c.time_s[i]);
    c.vcos_v[i] += cos_v * cos(c.time_s[i]);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *gained = named(d, "gain-wander"), *moved = named(d, "offset-wander");
  ASSERT_TRUE(gained && moved) << names(d);
  EXPECT_NEAR(gained->values[0], fraction, 0.1 * fraction);
  EXPECT_NEAR(moved->values[0], sin_v, 0.15 * sin_v);
  EXPECT_NEAR(moved->values[1], cos_v, 0.15 * cos_v);
}

KIND(an_amplitude_that_falls_with_the_speed_is_a_low_pass_and_no_wander) {
  Bench bench;
  // A ramp, along which speed and time are one, up to near the corner; a line encoder.
  constexpr int kPeriods = 128;
  constexpr double kRate = 40000.0, kSpan = 0.6;
  const double top_hz = bench.within(2500.0, 4500.0), corner_hz = bench.within(1.4, 2.0) * top_hz;
  const auto angle = [&](double t) { // electrical: from 100 Hz to the top
    return kTwoPi * (100.0 * t + 0.5 * (top_hz - 100.0) * t * t / kSpan) / kPeriods;
  };
  Capture c = bench.capture(24000, kRate, kPeriods, angle);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double hz = 100.0 + (top_hz - 100.0) * c.time_s[i] / kSpan;
    turn_by(c, i, 1.0 / std::hypot(1.0, hz / corner_hz));
  }
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "low-pass-rolloff");
  ASSERT_TRUE(f) << names(d);
  EXPECT_NEAR(f->values[0], corner_hz, 0.01 * corner_hz);
  EXPECT_FALSE(named(d, "gain-wander"));
}

KIND(two_short_records_at_two_speeds_tell_a_skew_without_a_reference) {
  Bench bench;
  constexpr double kRate = 5000.0;
  const double slow = bench.within(3.5, 5.0), fast = bench.within(4.0, 6.0) * slow; // turns
  const double skew_s = bench.within(2e-5, 5e-5);
  std::vector<std::shared_ptr<const Capture>> records;
  for (const double rps : {slow, fast}) {
    Capture c = bench.capture(5000, kRate, 2, [&](double t) { return rps * kTwoPi * t; });
    const Capture late =
        bench.capture(5000, kRate, 2, [&](double t) { return rps * kTwoPi * (t + skew_s); });
    c.vcos_v = late.vcos_v;
    c.reference_deg.clear();
    records.push_back(std::make_shared<const Capture>(std::move(c)));
  }
  const Diagnosis d = diagnose(*join(records), {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "channel-skew");
  ASSERT_TRUE(f) << names(d);
  EXPECT_NEAR(f->values[0], skew_s, 0.03 * skew_s);
}

KIND(records_with_another_magnet_each_are_one_sensor) {
  Bench bench;
  const double whole_v = bench.pair.amplitude_v;
  const double offset_sin_v = bench.within(-0.05, 0.05), offset_cos_v = bench.within(-0.05, 0.05);
  std::vector<std::shared_ptr<const Capture>> records;
  for (const double part : {bench.within(0.5, 0.7), bench.within(0.75, 0.85), 1.0}) {
    const double rps = bench.within(0.8, 2.5);
    bench.pair.amplitude_v = part * whole_v;
    Capture c = bench.capture(6000, 1000.0, 2, [&](double t) { return rps * kTwoPi * t; });
    for (std::size_t i = 0; i < c.size(); ++i) {
      c.vsin_v[i] += offset_sin_v;
      c.vcos_v[i] += offset_cos_v;
    }
    records.push_back(std::make_shared<const Capture>(std::move(c)));
  }
  const Diagnosis d = diagnose(*join(records), {});
  expect_pair(d, bench.pair);
  // Standard errors of a mean of all, times five.
  const double close = 5.0 * bench.pair.noise_v / std::sqrt(0.5 * 18000.0) / 0.5;
  EXPECT_NEAR(d.extended.baseline.offset_sin_v, offset_sin_v, close);
  EXPECT_NEAR(d.extended.baseline.offset_cos_v, offset_cos_v, close);
  for (const Finding &f : d.findings)
    EXPECT_TRUE(f.effect->info().prior_rank == 0 || f.effect->info().id == "gain-wander")
        << names(d);
}

/// Noise of `rms_v` that a converter which averages `rows` of them gives.
std::vector<double> averaged_noise(Bench &bench, std::size_t n, std::size_t rows, double rms_v) {
  std::vector<double> white(n + rows), out(n);
  for (double &x : white) // uniform: its mean is near normal
    x = bench.within(-1.0, 1.0) * std::sqrt(3.0 * static_cast<double>(rows)) * rms_v;
  for (std::size_t i = 0; i < n; ++i)
    out[i] = std::accumulate(white.begin() + static_cast<std::ptrdiff_t>(i),
                             white.begin() + static_cast<std::ptrdiff_t>(i + rows), 0.0) /
             static_cast<double>(rows);
  return out;
}

KIND(noise_of_a_converter_that_averages_is_noise) {
  Bench bench;
  bench.pair.noise_v = 1e-5;
  const double rps = bench.within(2.0, 6.0), rms_v = bench.within(5e-4, 1.5e-3);
  const auto rows = static_cast<std::size_t>(bench.within(2.0, 4.99));
  Capture c = bench.capture(8000, 2000.0, 1, [&](double t) { return rps * kTwoPi * t; });
  c.meta.noise_rms_v = rms_v;
  for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v}) {
    const std::vector<double> noise = averaged_noise(bench, c.size(), rows, rms_v);
    for (std::size_t i = 0; i < c.size(); ++i)
      (*v)[i] += noise[i];
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_EQ(d.findings.size(), 2u) << names(d);
  EXPECT_TRUE(d.structure.empty()) << d.structure.front().description;
}

KIND(what_repeats_with_the_angle_is_seen_through_noise_that_is_averaged) {
  Bench bench;
  bench.pair.noise_v = 1e-5;
  const double rps = bench.within(2.0, 6.0), rms_v = 1e-3;
  Capture c = bench.capture(8000, 2000.0, 1, [&](double t) { return rps * kTwoPi * t; });
  c.meta.noise_rms_v = rms_v;
  for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v}) {
    const std::vector<double> noise = averaged_noise(bench, c.size(), 4, rms_v);
    for (std::size_t i = 0; i < c.size(); ++i)
      (*v)[i] += noise[i];
  }
  for (std::size_t i = 0; i < c.size(); ++i) // a dent in one place of the turn
    c.vsin_v[i] += 3e-3 * std::exp(-std::pow((c.reference_deg[i] - 140.0) / 15.0, 2));
  const Diagnosis d = diagnose(c, {});
  EXPECT_FALSE(d.structure.empty());
}

KIND(readings_that_are_held_for_several_rows_make_no_errors_of_the_reference) {
  Bench bench;
  const double rps = bench.within(2.0, 5.0);
  const auto rows = static_cast<std::size_t>(bench.within(2.0, 5.99));
  Capture c = bench.capture(9000, 2000.0, 1, [&](double t) { return rps * kTwoPi * t; });
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.vsin_v[i] = c.vsin_v[i - i % rows];
    c.vcos_v[i] = c.vcos_v[i - i % rows];
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_EQ(d.findings.size(), 2u) << names(d);
  EXPECT_EQ(d.verdict, Verdict::explained);
  EXPECT_EQ(d.samples, c.size());
  EXPECT_NEAR(d.rows_a_reading, static_cast<double>(rows), 0.01);
}

TEST(HeldRows, ACoarseConverterBeforeASlowShaftHoldsNothing) {
  Bench bench;
  const double rps = bench.within(0.02, 0.05);
  Capture c = bench.capture(20000, 1000.0, 1, [&](double t) { return rps * kTwoPi * t; });
  constexpr double kStep = 5.0 / 256.0;
  for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
    for (double &x : *v)
      x = kStep * std::round(x / kStep);
  EXPECT_FALSE(fresh_readings(c));
}

TEST(HeldRows, EndsOfRecordsAndGapsKeepTheirPlaces) {
  Bench bench;
  Capture c = bench.capture(4000, 1000.0, 1, [](double t) { return 20.0 * t; });
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.vsin_v[i] = c.vsin_v[i - i % 4];
    c.vcos_v[i] = c.vcos_v[i - i % 4];
  }
  c.starts = {0, 2002};
  c.gaps = {1000};
  const auto fresh = fresh_readings(c);
  ASSERT_TRUE(fresh);
  ASSERT_EQ(fresh->capture.starts.size(), 2u);
  ASSERT_EQ(fresh->capture.gaps.size(), 1u);
  EXPECT_EQ(fresh->capture.time_s[fresh->capture.starts[1]], c.time_s[2002]);
  EXPECT_EQ(fresh->capture.time_s[fresh->capture.gaps[0]], c.time_s[1000]);
}

KIND(outputs_at_their_stops_have_no_noise_and_that_is_no_structure) {
  Bench bench;
  bench.pair.amplitude_v = 1.5;
  const double rps = bench.within(3.0, 8.0), high_v = kMiddleV + bench.within(0.9, 0.96) * 1.5;
  Capture c = bench.capture(8000, 2000.0, 1, [&](double t) { return rps * kTwoPi * t; });
  for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
    for (double &x : *v)
      x = std::min(x, high_v);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_TRUE(named(d, "clipping")) << names(d);
  EXPECT_FALSE(named(d, "angle-noise") || named(d, "amplitude-noise")) << names(d);
  EXPECT_EQ(d.verdict, Verdict::explained)
      << (d.structure.empty() ? "" : d.structure.front().description);
}

KIND(a_tone_is_seen_in_a_few_turns_with_rests_between) {
  Bench bench;
  const double hz = bench.within(45.0, 65.0), sin_v = bench.within(4e-3, 8e-3);
  // Eight moves of a turn, each as long as the rest that follows it.
  const auto angle = [](double t) {
    const double move = std::floor(t / 2.0), u = std::min(1.0, t - 2.0 * move);
    return kTwoPi * (move + u - std::sin(kTwoPi * u) / kTwoPi);
  };
  Capture c = bench.capture(16000, 1000.0, 1, angle);
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.vsin_v[i] += sin_v * std::sin(kTwoPi * hz * c.time_s[i]);
    c.vcos_v[i] += 0.7 * sin_v * std::sin(kTwoPi * hz * c.time_s[i] + 0.5);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "periodic-interference");
  ASSERT_TRUE(f) << names(d);
  EXPECT_NEAR(f->values[0], hz, 0.02);
  EXPECT_NEAR(f->values[1], sin_v, 0.05 * sin_v);
}

KIND(a_slip_is_seen_in_five_turns) {
  Bench bench;
  const double at_s = bench.within(1.5, 3.5), step_deg = bench.within(0.5, 3.0);
  const auto shaft = [](double t) { return kTwoPi * t; };
  Capture c = bench.capture(5000, 1000.0, 2, [&](double t) {
    return shaft(t) + (t < at_s ? 0.0 : step_deg * kRadPerDeg);
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "angle-slip");
  ASSERT_TRUE(f) << names(d);
  EXPECT_NEAR(f->values[0], at_s, 2e-3);
  EXPECT_NEAR(f->values[1], step_deg, 0.02 * step_deg);
}

KIND(a_small_pair_before_a_coarse_converter_is_named) {
  Bench bench;
  const double rps = bench.within(4.0, 8.0), step_v = 5.0 / 256.0;
  bench.pair.amplitude_v = 0.4;
  bench.pair.noise_v = 0.45 * step_v;
  Capture c = bench.capture(6000, 1000.0, 1, [&](double t) { return rps * kTwoPi * t; });
  for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
    for (double &x : *v)
      x = step_v * std::round(x / step_v);
  c.reference_deg.clear();
  // The noise leaves a thirtieth of the amplitude over, of 6000 samples.
  expect_pair(diagnose(c, {}), bench.pair, 4e-3);
}

} // namespace
} // namespace ada::test

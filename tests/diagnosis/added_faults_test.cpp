// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Faults that begin and end within a record, or hit many of its rows: a channel that stands still
// for a while, a tone over a few rounds of a hand, spikes in many rows, a ripple of the
// reference in one turn, offsets that walk beside a temperature.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

KIND(a_channel_that_stands_still_for_a_while_is_stuck_until_it_follows_again) {
  Bench bench;
  constexpr double kRate = 500.0, kSpan = 8.0;
  const double rps = bench.within(1.5, 4.0);
  Capture c = bench.capture(static_cast<std::size_t>(kRate * kSpan), kRate, 1,
                            [&](double t) { return rps * kTwoPi * t; });
  if (bench.within(0.0, 1.0) < 0.5)
    c.reference_deg.clear();
  const bool cos = bench.within(0.0, 1.0) < 0.5;
  std::vector<double> &channel = cos ? c.vcos_v : c.vsin_v;
  const double from_s = bench.within(2.0, 4.0), to_s = from_s + bench.within(1.2, 3.0) / rps;
  const auto first = static_cast<std::size_t>(from_s * kRate);
  for (std::size_t i = first; c.time_s[i] < to_s; ++i)
    channel[i] = channel[first - 1];
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "stuck-channel");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_EQ(f->values[0], cos ? 1.0 : 0.0);
  // The rows before it may be as near to what it holds as noise is.
  EXPECT_NEAR(f->values[1], c.time_s[first], 5.0 / kRate) << left_of(d);
  EXPECT_NE(f->explanation.find("follows again"), std::string::npos) << f->explanation;
  expect_pair(d, bench.pair, 1e-3);
  EXPECT_EQ(d.findings.size(), 3u) << left_of(d);
  EXPECT_EQ(d.verdict, Verdict::explained) << left_of(d);
}

KIND(a_channel_that_stands_still_at_the_end_leaves_the_circle_before_it) {
  Bench bench;
  constexpr double kRate = 1000.0;
  const double rps = bench.within(10.0, 15.0);
  Capture c = bench.capture(4000, kRate, 1, [&](double t) { return rps * kTwoPi * t; });
  c.reference_deg.clear();
  const auto first = static_cast<std::size_t>(bench.within(2600.0, 3000.0));
  for (std::size_t i = first; i < c.size(); ++i)
    c.vcos_v[i] = c.vcos_v[first - 1];
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(named(d, "stuck-channel")) << left_of(d);
  expect_pair(d, bench.pair, 1e-3);
}

/// Of either channel its own part, so that it is no gain that swings.
KIND(a_tone_over_a_few_rounds_of_a_hand_is_a_tone) {
  Bench bench;
  constexpr double kRate = 50.0;
  const auto n = static_cast<std::size_t>(bench.within(180.0, 900.0));
  const double span = static_cast<double>(n) / kRate;
  Capture c = bench.capture(n, kRate, 1, turned_by_hand(bench, bench.within(2.5, 5.0), span));
  c.reference_deg.clear();
  const double hz = bench.within(0.2, 0.45) * kRate, size = 0.05 * bench.pair.amplitude_v;
  const double sin_v = bench.within(0.7, 1.0) * size, cos_v = bench.within(0.2, 0.5) * size;
  const double phase = bench.within(0.0, kTwoPi);
  for (std::size_t i = 0; i < n; ++i) {
    c.vsin_v[i] += sin_v * std::sin(kTwoPi * hz * c.time_s[i] + phase);
    c.vcos_v[i] += cos_v * std::sin(kTwoPi * hz * c.time_s[i] + phase);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "periodic-interference");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], hz, 0.1 / span) << left_of(d);
  EXPECT_NEAR(f->values[1], sin_v, 0.1 * size) << left_of(d);
  EXPECT_NEAR(f->values[2], cos_v, 0.1 * size) << left_of(d);
  expect_pair(d, bench.pair, 2e-3);
}

KIND(spikes_in_many_rows_are_spikes) {
  Bench bench;
  constexpr double kRate = 1000.0;
  const double rps = bench.within(1.0, 3.0);
  Capture c = bench.capture(4000, kRate, 1, [&](double t) { return rps * kTwoPi * t; });
  if (bench.within(0.0, 1.0) < 0.5)
    c.reference_deg.clear();
  const double rate = bench.within(0.02, 0.04), size = 0.15 * bench.pair.amplitude_v;
  double hit = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i)
    if (bench.within(0.0, 1.0) < rate) {
      (bench.within(0.0, 1.0) < 0.5 ? c.vsin_v : c.vcos_v)[i] += bench.normal(size);
      hit += 1.0;
    }
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "impulse-noise");
  ASSERT_TRUE(f) << left_of(d);
  // What is smaller than the noise shows nowhere: of sizes that are normal a few of a hundred.
  EXPECT_NEAR(f->values[0] * static_cast<double>(c.size()), hit, 0.2 * hit) << left_of(d);
  EXPECT_NEAR(f->values[1], size, 0.2 * size) << left_of(d);
  expect_pair(d, bench.pair, 2e-3);
  EXPECT_NE(d.verdict, Verdict::no_discrepancy);
}

/// The reference ripples at one order of a single turn, and with it the speed that it tells.
KIND(a_ripple_of_the_reference_in_one_turn_is_neither_delay_nor_low_pass) {
  Bench bench;
  const double order = std::round(bench.within(1.6, 8.4)), size_deg = bench.within(1.2, 3.0);
  const double phase = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(2000, 2000.0, 1, [](double t) { return kTwoPi * t; });
  for (double &deg : c.reference_deg)
    deg = wrap(deg + size_deg * std::sin(order * deg * kRadPerDeg + phase) + bench.normal(0.02),
               360.0);
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"propagation-delay", "reference-delay", "low-pass-rolloff", "hysteresis"});
  double found = 0.0;
  for (const Finding &f : d.findings) {
    const std::string_view id = f.effect->info().id;
    if (id == "reference-harmonic" || id == "field-direction-error")
      found = std::max(found, f.values[1]);
    else if (id == "sensor-off-axis")
      found = std::max(found, f.values[0]);
  }
  EXPECT_NEAR(found, size_deg, 0.1 * size_deg) << left_of(d);
}

/// VTEMP rises evenly, and nothing follows it.
KIND(offsets_that_walk_beside_a_temperature_do_not_follow_it) {
  Bench bench;
  Capture c = bench.capture(12000, 200.0, 1, [](double t) { return 2.0 * kTwoPi * t; });
  const double step_v = bench.within(3.0, 6.0) * bench.pair.noise_v / std::sqrt(200.0);
  double sin_v = 0.0, cos_v = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.vtemp_v.push_back(1.4 + 0.3 * c.time_s[i] / 60.0 + bench.normal(5e-4));
    c.vsin_v[i] += sin_v += bench.normal(step_v);
    c.vcos_v[i] += cos_v += bench.normal(step_v);
  }
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(named(d, "offset-wander")) << left_of(d);
  expect_none(d, {"offset-temperature-drift", "offset-temperature-curvature", "temperature-lag"});
}

/// A third harmonic that either of two laws may make, beside what every pair has.
KIND(a_mismatch_beside_a_bend_of_either_law_has_an_error_that_holds_it) {
  Bench bench;
  const double q3 = bench.within(0.01, 0.04);
  Capture c = bench.capture(3000, 100.0, 1, turned_by_hand(bench, bench.within(8.0, 14.0), 30.0));
  if (bench.within(0.0, 1.0) < 0.5)
    c.reference_deg.clear();
  const bool channels = bench.within(0.0, 1.0) < 0.5;
  const double a = bench.pair.amplitude_v;
  for (std::size_t i = 0; i < c.size(); ++i) {
    double s = c.vsin_v[i] - kMiddleV, k = c.vcos_v[i] - kMiddleV;
    if (channels) { // each by its own level
      s -= q3 * s * s * s / (a * a);
      k -= q3 * k * k * k / (a * a);
    } else { // the angle of a film that the field turns in part
      const double psi = std::atan2(s, k), by = 0.25 * q3 * std::sin(4.0 * psi);
      const double r = std::hypot(s, k);
      s = r * std::sin(psi + by);
      k = r * std::cos(psi + by);
    }
    c.vsin_v[i] = kMiddleV + s;
    c.vcos_v[i] = kMiddleV + k;
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "amplitude-mismatch");
  ASSERT_TRUE(f) << left_of(d);
  if (!channels) {
    EXPECT_NEAR(f->values[0], bench.pair.k, 4.0 * f->std_errors[0] + 0.5 * q3) << left_of(d);
  } else {
    EXPECT_NEAR(f->values[0], bench.pair.k,
                4.0 * f->std_errors[0] + 2.0 * q3 * std::abs(bench.pair.k))
        << left_of(d);
  }
}

} // namespace
} // namespace ada::test

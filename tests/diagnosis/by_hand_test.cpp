// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Shafts turned by hand, with nothing but the pair to say how: they rest, dwell, go back, and their
// readings are noisy. What the readings themselves show must be found, and nothing that the hand
// did must be taken for it.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "diagnosis/bench.h"
#include "diagnosis/conditions/travel.h"

namespace ada::test {
namespace {

/// An angle over `n` rows that goes `turns` turns in strokes of uneven length, with rests between
/// them, and at times back for a while.
std::vector<double> strokes(Bench &bench, std::size_t n, double turns) {
  std::vector<double> speed;
  while (speed.size() < n) {
    const auto rest = static_cast<std::size_t>(bench.within(0.01, 0.06) * static_cast<double>(n)),
               stroke = static_cast<std::size_t>(bench.within(0.04, 0.15) * static_cast<double>(n));
    const double peak = bench.within(0.5, 1.5) * (bench.within(0.0, 1.0) < 0.15 ? -0.3 : 1.0);
    speed.insert(speed.end(), rest, 0.0);
    for (std::size_t k = 0; k < stroke; ++k)
      speed.push_back(
          peak * std::pow(std::sin(kPi * static_cast<double>(k) / static_cast<double>(stroke)), 2));
  }
  std::vector<double> angle{bench.within(0.0, kTwoPi)};
  for (std::size_t i = 1; i < n; ++i)
    angle.push_back(angle.back() + speed[i]);
  const double scale = kTwoPi * turns / (angle.back() - angle.front());
  for (std::size_t i = n; i-- > 0;)
    angle[i] = angle[0] + scale * (angle[i] - angle[0]);
  return angle;
}

Capture by_hand(Bench &bench, double turns) {
  constexpr double kRate = 200.0;
  const auto n = static_cast<std::size_t>(bench.within(1500.0, 4000.0));
  const std::vector<double> angle = strokes(bench, n, turns);
  Capture c = bench.capture(n, kRate, 1, [&](double t) {
    return angle[std::min(n - 1, static_cast<std::size_t>(std::lround(t * kRate)))];
  });
  c.reference_deg.clear();
  return c;
}

/// A servo that turns all but evenly, read every tenth of a second: from one reading to the next it
/// goes on by a part of the turn, once and never again.
KIND(one_jump_of_a_shaft_that_turns_evenly_is_told) {
  Bench bench;
  constexpr double kRate = 10.0;
  bench.pair.noise_v = bench.within(2e-3, 8e-3);
  const std::size_t n = 150, at = static_cast<std::size_t>(bench.within(30.0, 120.0));
  const double step = kRadPerDeg * bench.within(5.0, 9.0),
               jump = kRadPerDeg * bench.within(90.0, 270.0);
  std::vector<double> angle{bench.within(0.0, kTwoPi)};
  for (std::size_t i = 1; i < n; ++i)
    angle.push_back(angle.back() + step * bench.within(0.9, 1.1));
  const auto diagnosed = [&](double by) {
    Capture c = bench.capture(n, kRate, 1, [&](double t) {
      const auto i = static_cast<std::size_t>(std::lround(t * kRate));
      return angle[i] + (i >= at ? by : 0.0);
    });
    c.reference_deg.clear();
    return diagnose(c, {});
  };
  const auto jumps = [](const Diagnosis &d) {
    return std::ranges::any_of(d.structure, [](const Structure &s) {
      return s.description.find("the angle jumps from one reading to the next, once") !=
             std::string::npos;
    });
  };
  EXPECT_FALSE(jumps(diagnosed(0.0)));
  const Diagnosis d = diagnosed(jump);
  EXPECT_TRUE(jumps(d) || named(d, "sample-loss") || named(d, "angle-slip"))
      << at << " " << jump * kDegPerRad << names(d);
}

TEST(Travel, NoiseIsNoWay) {
  Bench bench;
  std::vector<double> angle;
  for (int i = 0; i < 20000; ++i)
    angle.push_back(bench.normal(0.02));
  EXPECT_LT(travel_of(angle), 1.0); // from row to row it is 450
}

TEST(Travel, AWayCountsThereAndBackInNoise) {
  Bench bench;
  std::vector<double> angle;
  for (int i = 0; i < 20000; ++i)
    angle.push_back(3.0 * std::sin(kTwoPi * i / 10000.0) + bench.normal(0.01));
  // Four ways of six; each reversal keeps a play of four standard deviations on either side.
  EXPECT_NEAR(travel_of(angle), 24.0, 0.5);
}

TEST(Travel, OneWayIsWhole) {
  std::vector<double> angle;
  for (int i = 0; i < 1000; ++i)
    angle.push_back(0.01 * i + (i % 3 == 0 ? 1e-3 : 0.0));
  EXPECT_NEAR(travel_of(angle), 9.99, 0.01);
}

KIND(a_noisy_pair_turned_by_hand_keeps_its_quadrature_error) {
  Bench bench;
  bench.pair.noise_v = bench.within(0.02, 0.03) * bench.pair.amplitude_v;
  bench.pair.delta_rad = std::copysign(bench.within(4.0, 7.0) * kRadPerDeg, bench.pair.delta_rad);
  const Diagnosis d = diagnose(by_hand(bench, bench.within(1.5, 3.0)), {});
  const Finding *f = named(d, "quadrature-error");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], bench.pair.delta_rad * kDegPerRad, 1.0) << left_of(d);
}

KIND(peaks_that_are_cut_are_seen_though_the_hand_turned_unevenly) {
  Bench bench;
  Capture c = by_hand(bench, bench.within(4.0, 9.0));
  const double level = cut_upper_peaks(bench, c, bench.within(0.75, 0.92));
  const Diagnosis d = diagnose(c, {});
  expect_cut_at(d, level, bench.pair);
  if (const Finding *f = named(d, "clipping")) {
    EXPECT_TRUE(std::isnan(f->values[0])) << left_of(d);
  }
}

KIND(peaks_of_one_channel_are_cut_beside_what_has_no_name) {
  Bench bench;
  Capture c = by_hand(bench, bench.within(5.0, 9.0));
  // A field that goes with the place, by a tenth, so that no two peaks are alike.
  const double part = bench.within(0.05, 0.1), at = bench.within(0.0, kTwoPi);
  std::vector<double> cut;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double turn = kTwoPi * c.time_s[i] / c.time_s.back();
    const double gain = 1.0 + part * std::sin(2.3 * turn + at) + 0.5 * part * std::sin(5.1 * turn);
    c.vsin_v[i] = 2.5 + gain * (c.vsin_v[i] - 2.5);
    c.vcos_v[i] = 2.5 + gain * (c.vcos_v[i] - 2.5);
  }
  const double level = 2.5 - 0.8 * bench.pair.amplitude_v;
  for (double &x : c.vcos_v)
    x = std::max(x, level);
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "clipping");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], level, 1e-3) << left_of(d);
}

KIND(a_hand_that_dwells_at_the_peaks_cuts_none) {
  Bench bench;
  constexpr double kRate = 200.0;
  const double turns = bench.within(4.0, 8.0), dwell = bench.within(0.7, 0.95);
  const std::size_t n = 3000;
  Capture c = bench.capture(n, kRate, 1, [&](double t) {
    const double part = kTwoPi * turns * t * kRate / static_cast<double>(n);
    return part - dwell / 4.0 * std::sin(4.0 * part); // slow at the four peaks of the pair
  });
  c.reference_deg.clear();
  expect_none(diagnose(c, {}), {"clipping", "stuck-channel"});
}

KIND(a_peak_that_is_compressed_is_not_cut) {
  Bench bench;
  Capture c = by_hand(bench, bench.within(4.0, 9.0));
  const double part = bench.within(0.1, 0.25), a = bench.pair.amplitude_v;
  for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
    for (double &x : *v)
      x = 2.5 + a * std::tanh(part * 5.0 * (x - 2.5) / a);
  expect_none(diagnose(c, {}), {"clipping", "stuck-channel"});
}

/// Of one turn each end has one peak: those of different ends tell each other.
KIND(peaks_at_two_ends_are_cut_in_one_turn_by_hand) {
  Bench bench;
  Capture c = by_hand(bench, bench.within(1.2, 1.8));
  const double level = cut_upper_peaks(bench, c, bench.within(0.8, 0.92));
  expect_cut_at(diagnose(c, {}), level, bench.pair);
}

KIND(in_one_turn_by_hand_round_peaks_are_not_cut) {
  Bench bench;
  const bool compressed = bench.within(0.0, 1.0) < 0.5;
  Capture c = by_hand(bench, bench.within(1.0, 1.8));
  const double part = bench.within(0.1, 0.25), a = bench.pair.amplitude_v;
  for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
    for (double &x : *v)
      x = compressed ? 2.5 + a * std::tanh(part * 5.0 * (x - 2.5) / a) : x;
  expect_none(diagnose(c, {}), {"clipping", "stuck-channel"});
}

KIND(a_delay_that_grows_at_reversals_is_no_slip) {
  Bench bench;
  constexpr double kRate = 2000.0;
  const double fast = bench.within(3.0, 8.0), swing = bench.within(2.0, 4.0),
               grows = bench.within(2e-5, 6e-5), at = bench.within(0.0, kTwoPi);
  const auto shaft = [&](double t) { // turns there and back, with stretches of even speed
    return fast * swing / kTwoPi * std::tanh(3.0 * std::sin(kTwoPi * t / swing + at)) * swing;
  };
  Capture c = bench.capture(20000, kRate, 1, shaft);
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i] - 2e-4 - grows * c.time_s[i]) * kDegPerRad, 360.0);
  expect_none(diagnose(c, {}), {"angle-slip", "offset-step", "sample-loss"});
}

/// A reading that is lost is a zero, wherever the shaft is. All zeros have one angle and one level.
KIND(zeros_in_a_record_by_hand_are_spikes_and_no_places) {
  Bench bench;
  bench.pair.noise_v = 2e-3;
  const double swing = bench.within(1.6, 2.4), hz = bench.within(0.05, 0.09);
  const auto angle = [=](double t) {
    return swing * kTwoPi * 0.5 * (1.0 - std::cos(kTwoPi * hz * t)) + 0.3 * std::sin(3.1 * t);
  };
  Capture c = bench.capture(2000, 80.0, 1, angle);
  c.reference_deg.clear();
  for (int k = 0; k < 12; ++k) {
    const auto row = static_cast<std::size_t>(bench.within(20.0, 1980.0));
    c.vsin_v[row] = c.vcos_v[row] = 0.0;
  }
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(named(d, "impulse-noise")) << left_of(d);
  for (const Structure &s : d.structure)
    EXPECT_EQ(s.description.find("stand out of the noise"), std::string::npos) << s.description;
}

} // namespace
} // namespace ada::test

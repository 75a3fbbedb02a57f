// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What comes again and what does not: at a place, at a level of a channel, from reading to reading.
// The signals are made here, and not by the model that is fitted to them.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "diagnosis/bench.h"
#include "diagnosis/residual/repetition.h"

namespace ada::test {
namespace {

bool says(const Diagnosis &d, std::string_view words) {
  return std::any_of(d.structure.begin(), d.structure.end(), [&](const Structure &s) {
    return s.description.find(words) != std::string::npos;
  });
}

std::string all_of(const Diagnosis &d) {
  std::string out(verdict_name(d.verdict));
  for (const Structure &s : d.structure)
    out += "\n  " + s.description;
  return out + "\n  " + names(d);
}

/// Rows in hardly any of the turns that went by: of those that there are some are asked.
TEST(ComesAgain, a_shaft_that_leaps_over_turns_is_asked_where_it_was_read) {
  Bench bench;
  for (const double leap : {20.3, 1000.1, 1e6}) {
    Observations data;
    ResidualColumns rest;
    for (std::size_t i = 0; i < 200; ++i) {
      data.time.push_back(static_cast<double>(i));
      data.alpha.push_back(kTwoPi * leap * static_cast<double>(i / 2) + 0.01);
      rest.sin.push_back(0.5 + bench.normal(0.01));
      rest.cos.push_back(bench.normal(0.01));
    }
    const auto seen = repeated_v2(data, rest, kTwoPi, kTwoPi / 10.0);
    ASSERT_TRUE(seen) << leap;
    EXPECT_NEAR(seen->v2, 0.125, 0.05) << leap;
  }
}

/// A few turns by hand, with noise that goes on for some readings as that of a filter does: for one
/// turn it is a function of the place, for the next it is another.
KIND(noise_of_some_colour_in_a_few_turns_does_not_repeat_with_the_angle) {
  Bench bench;
  constexpr std::size_t kRows = 340;
  constexpr double kRate = 50.0;
  const double turns = bench.within(2.2, 3.5), slow = bench.within(0.05, 0.2),
               phase = bench.within(0.0, kTwoPi);
  const double span = kRows / kRate;
  Capture c = bench.capture(kRows, kRate, 1, [&](double t) {
    return kTwoPi * turns * t / span + slow * std::sin(kTwoPi * t / span + phase);
  });
  c.reference_deg.clear();
  const double rms = bench.within(0.004, 0.008) * bench.pair.amplitude_v,
               kept = bench.within(0.75, 0.85);
  double sin = 0.0, cos = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double fresh = rms * std::sqrt(1.0 - kept * kept);
    c.vsin_v[i] += sin = kept * sin + bench.normal(fresh);
    c.vcos_v[i] += cos = kept * cos + bench.normal(fresh);
  }
  const Diagnosis d = diagnose(c, {});
  EXPECT_FALSE(says(d, "repeat with the angle")) << all_of(d);
  EXPECT_NE(d.verdict, Verdict::explained) << all_of(d);
}

/// What a magnet does comes again on the next turn, however few there are.
KIND(two_turns_are_enough_to_see_that_the_angle_repeats) {
  Bench bench;
  constexpr std::size_t kRows = 1200;
  const double turns = bench.within(2.2, 3.5);
  Capture c = bench.capture(kRows, 300.0, 1, [&](double t) { return kTwoPi * turns * t / 4.0; });
  const double sin = bench.within(0.003, 0.01) * bench.pair.amplitude_v,
               cos = bench.within(0.003, 0.01) * bench.pair.amplitude_v,
               phase = bench.within(0.0, kTwoPi);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double a = c.reference_deg[i] * kRadPerDeg;
    c.vsin_v[i] += sin * std::exp(1.5 * (std::cos(a - phase) - 1.0)) * std::sin(7.0 * a);
    c.vcos_v[i] += cos * std::exp(1.5 * (std::cos(a - phase - 2.0) - 1.0)) * std::sin(5.0 * a);
  }
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(says(d, "repeat with the angle")) << all_of(d);
}

/// A converter of which the code in the middle of the scale is wide: what stands out lies at one
/// voltage of its own channel, and sparks know no voltage.
KIND(a_kink_of_the_converter_is_no_spark) {
  Bench bench;
  constexpr std::size_t kRows = 3000;
  const double turns = bench.within(4.0, 9.0), slow = bench.within(0.2, 0.6);
  Capture c = bench.capture(kRows, 100.0, 2, [&](double t) {
    return kTwoPi * turns * t / 30.0 + slow * std::sin(0.7 * t);
  });
  const double wide = bench.within(30.0, 60.0) * bench.pair.noise_v, level = bench.within(2.3, 2.7);
  for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
    for (double &x : *v)
      if (std::abs(x - level) < 0.5 * wide)
        x = level + (x < level ? -0.5 : 0.5) * wide;
  const Diagnosis d = diagnose(c, {});
  EXPECT_FALSE(named(d, "impulse-noise")) << all_of(d);
}

/// Second harmonics of both channels are, with two periods a turn, what one of one channel is
/// beside a sensor off the axis.
KIND(second_harmonics_of_both_channels_are_told_beside_a_sensor_off_the_axis) {
  Bench bench;
  const double turns = bench.within(5.0, 9.0);
  Capture c = bench.capture(8000, 1000.0, 2, [&](double t) { return kTwoPi * turns * t / 8.0; });
  const double sin = bench.within(0.004, 0.01), cos = bench.within(0.004, 0.01),
               of_sin = bench.within(0.0, kTwoPi), of_cos = bench.within(0.0, kTwoPi);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double psi = 2.0 * c.reference_deg[i] * kRadPerDeg;
    c.vsin_v[i] += sin * bench.pair.amplitude_v * std::sin(2.0 * psi + of_sin);
    c.vcos_v[i] += cos * bench.pair.amplitude_v * std::cos(2.0 * psi + of_cos);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *off = named(d, "sensor-off-axis");
  if (off) {
    const auto &others = off->alternatives;
    EXPECT_TRUE(std::find(others.begin(), others.end(), "harmonic-distortion") != others.end())
        << all_of(d);
  }
}

} // namespace
} // namespace ada::test

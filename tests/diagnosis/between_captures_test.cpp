// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What lies between two stretches of a record, or between two captures, nobody saw. The signals are
// made here, and not by the model that is fitted to them.

#include <cmath>
#include <memory>
#include <vector>

#include "diagnosis/bench.h"
#include "recording/join.h"

namespace ada::test {
namespace {

using Captures = std::vector<std::shared_ptr<const Capture>>;

/// Each capture of the mains begins at another phase of them.
KIND(a_tone_of_two_captures_has_one_frequency) {
  Bench bench;
  const double hz = bench.within(49.8, 50.2), sin_v = bench.within(2e-3, 8e-3),
               cos_v = bench.within(2e-3, 8e-3), apart = bench.within(0.0, kTwoPi);
  Captures captures;
  for (int k = 0; k < 2; ++k) {
    const double turns = bench.within(4.0, 7.0), start = bench.within(0.0, kTwoPi);
    Capture c = bench.capture(6000, 480.0, 2, [&](double t) { return kTwoPi * turns * t; });
    for (std::size_t i = 0; i < c.size(); ++i) {
      const double phase = kTwoPi * hz * c.time_s[i] + start;
      c.vsin_v[i] += sin_v * std::sin(phase);
      c.vcos_v[i] += cos_v * std::sin(phase + apart);
    }
    c.reference_deg.clear();
    captures.push_back(std::make_shared<const Capture>(std::move(c)));
  }
  const Diagnosis d = diagnose(*join(captures), {});
  const Finding *f = named(d, "periodic-interference");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], hz, 3.0 * f->std_errors[0]) << left_of(d);
  EXPECT_NEAR(f->values[1], sin_v, 0.03 * sin_v) << left_of(d);
  EXPECT_NEAR(f->values[2], cos_v, 0.03 * cos_v) << left_of(d);
}

/// Without a reference the first reading of a capture may lie in either half of the turn.
KIND(a_ripple_of_an_odd_order_is_one_in_two_captures) {
  Bench bench;
  const double a = bench.within(0.15, 0.4) * kRadPerDeg, phase = bench.within(0.0, kTwoPi),
               turns = bench.within(3.0, 6.0);
  Captures captures;
  for (const double begins : {0.0, kPi}) {
    Capture c = bench.capture(6000, 480.0, 2, [&](double t) {
      const double even = kTwoPi * turns * t + begins;
      return even + a * std::sin(3.0 * even + phase);
    });
    c.reference_deg.clear();
    captures.push_back(std::make_shared<const Capture>(std::move(c)));
  }
  const Diagnosis d = diagnose(*join(captures), {});
  const Finding *f = named(d, "rotation-nonuniformity");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_EQ(f->values[0], 3.0) << left_of(d);
  EXPECT_NEAR(f->values[1], a * kDegPerRad, 0.05 * a * kDegPerRad) << left_of(d);
  expect_pair(d, bench.pair, 0.002);
}

/// A part of a turn, minutes of nothing, and another part: what repeats with the angle is no tone,
/// however well the pause would tell its frequency. It may be taken for one or not, by its phases:
/// of several captures none is.
KIND(a_pause_makes_no_tone) {
  Bench bench;
  constexpr std::size_t kRows = 860;
  const auto shaft = [](double t) { return kTwoPi * 0.1 * t; };
  for (int k = 0; k < 5; ++k) {
    const double a = bench.within(4.0, 8.0) * kRadPerDeg, phase = bench.within(0.0, kTwoPi),
                 other = bench.within(0.0, kTwoPi), pause_s = bench.within(200.0, 400.0);
    Capture c = bench.capture(kRows, 100.0, 2, [&](double t) {
      return shaft(t) + a * std::sin(4.0 * shaft(t) + phase) +
             0.1 * a * std::sin(8.0 * shaft(t) + other) + 0.06 * a * std::sin(12.0 * shaft(t));
    });
    for (std::size_t i = 0; i < c.size(); ++i)
      c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
    for (std::size_t i = kRows / 2; i < c.size(); ++i)
      c.time_s[i] += pause_s;
    const Diagnosis d = diagnose(c, {});
    expect_none(d, {"periodic-interference", "angle-slip", "gain-wander", "offset-wander"});
    const Finding *f = named(d, "field-direction-error");
    ASSERT_TRUE(f) << left_of(d);
    EXPECT_EQ(f->values[0], 4.0) << left_of(d);
  }
}

} // namespace
} // namespace ada::test

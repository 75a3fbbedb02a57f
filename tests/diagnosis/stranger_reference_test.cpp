// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// References that are none of the shaft's: the pair is judged by itself, and nothing is explained;
// and those that only err, which are kept.

#include <cmath>

#include "diagnosis/bench.h"
#include "health/reference_share.h"

namespace ada::test {
namespace {

/// A shaft that turns unevenly, some turns.
Capture uneven(Bench &bench, int periods) {
  const auto shaft = wandering(bench, bench.within(0.8, 1.6), 0.4, 0.2);
  return bench.capture(8000, 1000.0, periods, shaft);
}

struct Stranger {
  const char *why; ///< a part of what is said
  void (*change)(Bench &, Capture &);
};

void expect_pair_alone(const Stranger &stranger) {
  Bench bench;
  Capture c = uneven(bench, 2);
  stranger.change(bench, c);
  const Diagnosis d = diagnose(c, {});
  EXPECT_NE(d.reference_aside.find(stranger.why), std::string::npos)
      << "'" << d.reference_aside << "'";
  EXPECT_EQ(d.verdict, Verdict::partly_explained) << left_of(d);
  EXPECT_FALSE(d.extended_quality.heldout.angle_error_rms_deg);
  expect_pair(d, bench.pair);
  EXPECT_EQ(d.findings.size(), 2u) << names(d);
}

KIND(a_reference_that_stands_still_is_set_aside) {
  expect_pair_alone({"stands still", [](Bench &bench, Capture &c) {
                       const double at = bench.within(0.0, 360.0);
                       for (double &r : c.reference_deg)
                         r = at + bench.normal(0.01);
                     }});
}

KIND(a_reference_of_no_angle_is_set_aside) {
  expect_pair_alone({"does not go with it", [](Bench &bench, Capture &c) {
                       for (double &r : c.reference_deg)
                         r = bench.within(0.0, 360.0);
                     }});
}

KIND(a_reference_of_another_shaft_is_set_aside) {
  expect_pair_alone({"does not go with it", [](Bench &bench, Capture &c) {
                       const double hz = bench.within(0.2, 0.5);
                       for (std::size_t i = 0; i < c.size(); ++i)
                         c.reference_deg[i] = wrap(360.0 * hz * c.time_s[i], 360.0);
                     }});
}

KIND(a_reference_in_radians_is_set_aside) {
  expect_pair_alone({"radians", [](Bench &, Capture &c) {
                       for (double &r : c.reference_deg)
                         r *= kRadPerDeg;
                     }});
}

KIND(a_reference_that_counts_half_turns_is_set_aside) {
  expect_pair_alone({"makes 1 period a turn", [](Bench &, Capture &c) {
                       for (double &r : c.reference_deg)
                         r = wrap(2.0 * r, 360.0);
                     }});
}

/// One turn in radians: a parabola tells more than half of a sine.
TEST(StrangerReference, OneTurnInRadiansIsTold) {
  Bench bench;
  Capture c = bench.capture(1000, 1000.0, 1, [](double t) { return kTwoPi * t; });
  for (double &r : c.reference_deg)
    r *= kRadPerDeg;
  EXPECT_NE(why_of_no_shaft(c).find("radians"), std::string::npos) << why_of_no_shaft(c);
}

/// What a reference of the shaft may do, and a sensor.
TEST(StrangerReference, OneThatErrsIsTheShafts) {
  for (int draw = 0; draw < 8; ++draw) {
    Bench bench;
    const Capture sound = uneven(bench, draw % 2 + 1);
    EXPECT_GT(share_by_reference(sound, draw % 2 + 1), 0.99);
    const auto errs = [&](const char *how,
                          const std::function<double(std::size_t, double)> &error) {
      Capture c = sound;
      for (std::size_t i = 0; i < c.size(); ++i)
        c.reference_deg[i] = wrap(c.reference_deg[i] + error(i, c.reference_deg[i]), 360.0);
      EXPECT_EQ(why_of_no_shaft(c), "") << how;
    };
    const double size = bench.within(8.0, 16.0), phase = bench.within(0.0, kTwoPi);
    errs("loses its index",
         [&](std::size_t i, double) { return 2.0 * size * static_cast<double>(i / 1000); });
    errs("a belt", [&](std::size_t i, double) { return size * sound.time_s[i]; });
    errs("once a turn",
         [&](std::size_t, double r) { return size * std::sin(kRadPerDeg * r + phase); });
    errs("few steps", [&](std::size_t, double r) { return size * std::floor(r / size) - r; });
    Capture flat = sound;
    for (std::size_t i = 0; i < flat.size(); ++i) {
      flat.vsin_v[i] = std::min(flat.vsin_v[i], 2.5 + 0.5 * bench.pair.amplitude_v);
      flat.vcos_v[i] = 2.5 + 0.1 * (flat.vcos_v[i] - 2.5);
    }
    EXPECT_EQ(why_of_no_shaft(flat), "");
    Capture dead = sound;
    for (double &v : dead.vsin_v)
      v = 2.5 + bench.normal(bench.pair.noise_v);
    EXPECT_EQ(why_of_no_shaft(dead), "");
  }
}

/// Noise is no way, and a rest is one visit.
TEST(StrangerReference, ASlowOrRestingShaftKeepsItsReference) {
  Bench bench;
  bench.pair.noise_v = 0.02 * bench.pair.amplitude_v;
  constexpr std::size_t kRows = 200000;
  const Capture slow = bench.capture(kRows, kRows, 1, [](double t) { return kTwoPi * 0.7 * t; });
  EXPECT_GT(share_by_reference(slow, 1), 0.99);
  const Capture rests = bench.capture(
      kRows, kRows, 2, [](double t) { return kTwoPi * std::clamp((t - 0.5) * 500.0, 0.0, 1.0); });
  EXPECT_GT(share_by_reference(rests, 2), 0.99);
}

/// Records that are joined, gaps, and rows without a reference.
TEST(StrangerReference, RecordsGapsAndRowsWithoutAreTaken) {
  Bench bench;
  Capture c = uneven(bench, 2);
  c.starts = {0, c.size() / 2};
  c.gaps = {c.size() / 4};
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.reference_deg[i] += i < c.size() / 4 ? 0.0 : i < c.size() / 2 ? 100.0 : 200.0;
    if (i % 7 == 0)
      c.reference_deg[i] = std::nan("");
  }
  EXPECT_GT(share_by_reference(c, 2), 0.98);
}

/// A reference that is read once in half a period is right where it is fresh.
TEST(StrangerReference, OneThatIsHeldIsReadWhereItIsFresh) {
  Bench bench;
  Capture c = bench.capture(12000, 1000.0, 2, wandering(bench, 5.0, 0.4, 0.2));
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = c.reference_deg[i - i % 50];
  const Diagnosis d = diagnose(c, {});
  EXPECT_EQ(d.reference_aside, "");
  expect_pair(d, bench.pair);
}

/// Two captures are judged alike: without a reference where one of them has none.
TEST(StrangerReference, OfASecondCaptureIsSetAsideFromBoth) {
  Bench bench;
  const Capture c = uneven(bench, 2);
  Capture second = uneven(bench, 2);
  for (double &r : second.reference_deg)
    r *= kRadPerDeg;
  DiagnosisOptions options;
  options.heldout = &second;
  const Diagnosis d = diagnose(c, options);
  EXPECT_NE(d.reference_aside.find("second capture"), std::string::npos) << d.reference_aside;
  EXPECT_NE(d.reference_aside.find("radians"), std::string::npos) << d.reference_aside;
  expect_pair(d, bench.pair);
}

/// Of a pair that draws no circle nobody knows whose fault it is.
TEST(StrangerReference, APairThatStandsStillAccusesNobody) {
  Bench bench;
  Capture c = uneven(bench, 2);
  for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
    for (double &x : *v)
      x = 2.5 + bench.normal(bench.pair.noise_v);
  const Diagnosis d = diagnose(c, {});
  EXPECT_EQ(d.verdict, Verdict::insufficient_data);
  EXPECT_EQ(d.reference_aside, "");
}

} // namespace
} // namespace ada::test

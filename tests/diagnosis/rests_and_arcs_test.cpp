// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Shafts that come to rest, or that only move to and fro over a part of a turn; outputs that stop
// at a level or break.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <random>
#include <vector>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

/// To a grid of the converter's steps, from nothing to the last of them.
void convert(Capture &c, double step_v) {
  for (auto *v : {&c.vsin_v, &c.vcos_v})
    for (double &x : *v)
      x = step_v * std::round(x / step_v);
}

/// A shaft that slows down until it rests: of a channel that broke before, and holds a level, the
/// last rows tell nothing, as the other one rests as well.
KIND(a_wire_that_breaks_is_seen_though_the_shaft_comes_to_rest) {
  Bench bench;
  bench.pair.noise_v = bench.within(1e-3, 4e-3);
  const double hz = bench.within(0.3, 0.8);
  constexpr double kWhole_s = 30.0, kBrakes_s = 26.0, kRests_s = 28.0;
  Capture c = bench.capture(3000, 100.0, 1, [=](double t) {
    const double slow = std::clamp(t - kBrakes_s, 0.0, kRests_s - kBrakes_s);
    return kTwoPi * hz * (std::min(t, kRests_s) - 0.25 * slow * slow) * (kWhole_s / 30.0);
  });
  const auto from = static_cast<std::size_t>(bench.within(1000.0, 2000.0));
  std::vector<double> &stands = bench.within(0.0, 1.0) < 0.5 ? c.vsin_v : c.vcos_v;
  const double level_v = bench.within(0.0, 1.0) < 0.5 ? stands[from] : 0.0;
  for (std::size_t i = from; i < c.size(); ++i)
    stands[i] = level_v + 0.3 * bench.normal(bench.pair.noise_v);
  convert(c, 5.0 / 1024.0);
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "stuck-channel");
  ASSERT_TRUE(f) << names(d);
  EXPECT_NEAR(f->values[1], c.time_s[from], 0.1) << names(d);
  expect_pair(d, bench.pair, 0.003);
}

/// A joint that swings over a part of a turn, read on its motor's side: the gear between errs at an
/// order that comes often on the way, and shows though no turn is whole.
KIND(an_order_of_a_gear_shows_in_a_part_of_a_turn) {
  Bench bench;
  const double way = bench.within(0.4, 0.9) * kTwoPi, hz = bench.within(0.1, 0.2);
  const double order = std::round(bench.within(80.0, 240.0));
  const double e = bench.within(0.04, 0.06) * kRadPerDeg, phase = bench.within(0.0, kTwoPi);
  const auto angle = [=](double t) { return 0.5 * way * std::sin(kTwoPi * hz * t); };
  Capture c = bench.capture(8000, 500.0, 1, angle);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double a = angle(c.time_s[i]);
    c.reference_deg[i] = wrap((a + e * std::sin(order * a + phase)) * kDegPerRad, 360.0);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "reference-harmonic");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], order, 0.1) << names(d);
  EXPECT_NEAR(f->values[1] * kRadPerDeg, e, 0.1 * e) << names(d);
  expect_pair(d, bench.pair, 0.002);
}

/// An actuator that goes from place to place in a few rows and rests there: each move is as long as
/// that of lost rows at its mean speed, and none is a whole number of them but by chance.
KIND(a_shaft_that_moves_and_rests_loses_no_rows) {
  Bench bench;
  constexpr double kEach_s = 0.1, kLeg_s = 12.0;
  constexpr std::size_t kRows = 6000;
  const double settles = bench.within(5.0, 7.0), swings = bench.within(3.0, 5.0); // 1/s, rad/s
  std::vector<double> places{0.0};
  while (static_cast<double>(places.size()) < 2.0 + kRows * kEach_s / kLeg_s)
    places.push_back(bench.within(-0.45, 0.45));
  const auto angle = [&](double t) {
    const auto leg = static_cast<std::size_t>(t / kLeg_s);
    const double since = t - static_cast<double>(leg) * kLeg_s;
    const double left = std::exp(-settles * since) * std::cos(swings * since);
    return places[leg + 1] + (places[leg] - places[leg + 1]) * left;
  };
  Capture c = bench.capture(kRows, 1.0 / kEach_s, 2, angle);
  for (double &r : c.reference_deg)
    r = wrap(r + bench.normal(2e-3), 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"sample-loss", "angle-slip"});
  expect_pair(d, bench.pair, 0.003);
}

/// A record that loses rows while the speed changes all the time: none of the losses is seen to be
/// a whole number of rows, and the shaft turns on about each.
KIND(a_shaft_that_turns_unevenly_loses_rows) {
  Bench bench;
  const double hz = bench.within(0.4, 0.7), by = bench.within(0.1, 0.2);
  const auto angle = [=](double t) {
    return kTwoPi * hz * (t - by / 7.0 * std::cos(7.0 * t) - 0.05 / 2.3 * std::cos(2.3 * t));
  };
  const Capture whole = bench.capture(9000, 500.0, 1, angle);
  Capture c;
  c.meta = whole.meta;
  constexpr std::size_t kEvery = 1100;
  std::size_t lost = 0, events = 0, skip = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if (i % kEvery == kEvery - 1) {
      skip = static_cast<std::size_t>(bench.within(30.0, 60.0));
      lost += skip;
      ++events;
    }
    if (skip > 0) {
      --skip;
      continue;
    }
    c.time_s.push_back(whole.time_s[c.time_s.size()]); // the clock runs on
    c.vsin_v.push_back(whole.vsin_v[i]);
    c.vcos_v.push_back(whole.vcos_v[i]);
    c.reference_deg.push_back(whole.reference_deg[i]);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "sample-loss");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], static_cast<double>(events), 1.0) << names(d);
  EXPECT_NEAR(f->values[1], static_cast<double>(lost), 0.2 * static_cast<double>(lost)) << names(d);
}

/// A crank that turns some nine times while its slide's weight makes it uneven: knots of the motion
/// at every half turn would follow that, and it is nowhere at rest.
KIND(a_ripple_of_order_one_shows_in_nine_turns) {
  Bench bench;
  const double hz = bench.within(0.65, 0.75), ripple = bench.within(0.6, 2.0) * kRadPerDeg;
  const double from = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(6500, 500.0, 1, [=](double t) {
    const double even = kTwoPi * hz * (t + 0.05 * std::sin(0.3 * t));
    return even + ripple * std::sin(even + from);
  });
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "rotation-nonuniformity");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_EQ(f->values[0], 1.0) << names(d);
  EXPECT_NEAR(f->values[1] * kRadPerDeg, ripple, 0.05 * ripple) << names(d);
  expect_pair(d, bench.pair, 0.003);
}

/// A slow shaft whose record ends on a peak that is cut off, as every peak is.
KIND(a_record_that_ends_on_a_cut_off_peak_has_no_broken_channel) {
  Bench bench;
  const double level = bench.within(0.75, 0.9);
  // The last row lies late on the flat part of the sine.
  const double end = 0.25 * kTwoPi + 0.8 * std::acos(level) - bench.pair.zero_rad;
  constexpr double kTurns =
      3.0; // slow enough that a peak takes more rows than a channel is watched
  Capture c = bench.capture(2400, 100.0, 1,
                            [=](double t) { return kTwoPi * kTurns * (t / 23.99 - 1.0) + end; });
  for (double &v : c.vsin_v)
    v = std::min(v, 2.5 + level * bench.pair.amplitude_v);
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"stuck-channel"});
  EXPECT_TRUE(named(d, "clipping")) << names(d);
}

/// The range of a converter of eight bits ends below the peaks of both channels.
KIND(a_range_that_is_too_small_for_both_channels_is_found_without_a_reference) {
  Bench bench;
  constexpr double kStep_v = 5.0 / 256.0;
  bench.pair.amplitude_v = bench.within(1.2, 1.5);
  bench.pair.noise_v = bench.within(2e-3, 8e-3);
  bench.pair.k = std::copysign(bench.within(0.05, 0.1), bench.pair.k);
  const double level_v =
      kStep_v * std::round((2.5 + bench.within(0.75, 0.85) * bench.pair.amplitude_v) / kStep_v);
  Capture c = bench.capture(1000, 2000.0, 2, wandering(bench, bench.within(8.0, 20.0), 0.1, 3.0));
  c.reference_deg.clear();
  convert(c, kStep_v);
  for (auto *v : {&c.vsin_v, &c.vcos_v})
    for (double &x : *v)
      x = std::min(x, level_v);
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "clipping");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[1], level_v, 0.5 * kStep_v) << names(d);
  const Finding *k = named(d, "amplitude-mismatch");
  ASSERT_TRUE(k) << names(d);
  EXPECT_NEAR(k->values[0], bench.pair.k, 4.0 * k->std_errors[0]) << names(d);
}

/// A lever that goes to and fro over less than sixty electrical degrees beside a reference, with a
/// hysteresis and offsets that wander.
KIND(a_short_arc_beside_a_reference_tells_the_pair_and_the_hysteresis) {
  Bench bench;
  constexpr int kPeriods = 5;
  bench.pair.noise_v = bench.within(3e-4, 8e-4);
  const double half = 0.5 * bench.within(40.0, 55.0) * kRadPerDeg / kPeriods;
  const double hz = bench.within(0.08, 0.2), width_deg = bench.within(0.05, 0.15);
  const auto sense = [=](double t) { return std::cos(kTwoPi * hz * t) < 0.0 ? -1.0 : 1.0; };
  const auto shaft = [=](double t) { return half * std::sin(kTwoPi * hz * t); };
  Capture c = bench.capture(8000, 100.0, kPeriods, [=](double t) {
    return shaft(t) - 0.5 * width_deg * kRadPerDeg * sense(t);
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  ASSERT_NE(d.verdict, Verdict::insufficient_data) << d.reason;
  const Finding *f = named(d, "hysteresis");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], width_deg, std::max(0.1 * width_deg, 4.0 * f->std_errors[0]));
  for (const auto &[id, value] :
       {std::pair<const char *, double>{"amplitude-mismatch", bench.pair.k},
        {"quadrature-error", bench.pair.delta_rad * kDegPerRad}}) {
    const Finding *of = named(d, id);
    EXPECT_NEAR(of ? of->values[0] : value, value, of ? 4.0 * of->std_errors[0] : 0.0) << names(d);
  }
}

/// As few rows of as short an arc as that do not know where the centre of the circle is.
TEST(Arcs, an_arc_that_does_not_know_its_centre_says_so) {
  Bench bench;
  bench.pair.noise_v = 0.02 * bench.pair.amplitude_v;
  Capture c = bench.capture(60, 10.0, 1, [](double t) { return 0.35 * std::sin(4.0 * t); });
  const Diagnosis d = diagnose(c, {});
  EXPECT_EQ(d.verdict, Verdict::insufficient_data) << names(d);
  EXPECT_NE(d.reason.find("the centre of the pair is known to"), std::string::npos) << d.reason;
}

/// An offset that jumps while a valve goes to and fro over a small part of a turn.
KIND(an_offset_that_steps_is_seen_on_a_part_of_a_turn) {
  Bench bench;
  const double half = 0.5 * bench.within(60.0, 110.0) * kRadPerDeg / 2.0;
  const double hz = bench.within(0.1, 0.3), step_v = 10.0 * bench.pair.noise_v;
  Capture c =
      bench.capture(3200, 100.0, 2, [=](double t) { return half * std::sin(kTwoPi * hz * t); });
  const auto from = static_cast<std::size_t>(bench.within(1000.0, 2200.0));
  for (std::size_t i = from; i < c.size(); ++i) {
    c.vsin_v[i] += step_v;
    c.vcos_v[i] -= 0.5 * step_v;
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "offset-step");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], c.time_s[from], 0.05) << names(d);
  EXPECT_NEAR(f->values[1], step_v, 0.1 * step_v) << names(d);
}

/// A drive that goes from place to place and rests there, without a reference: the angle is the
/// pair's own, and what its differences say of the noise across is no more than that along.
std::function<double(double)> from_place_to_place(Bench &bench) {
  std::vector<double> places{0.0};
  for (int k = 0; k < 40; ++k)
    places.push_back(places.back() + bench.within(0.8, 2.2));
  return [places](double t) { // half a second each, a third of it under way
    const double at = t / 0.5, part = std::min(3.0 * (at - std::floor(at)), 1.0);
    const auto k = std::min(static_cast<std::size_t>(at), places.size() - 2);
    const double smooth = part * part * (3.0 - 2.0 * part);
    return places[k] + (places[k + 1] - places[k]) * smooth;
  };
}

KIND(noise_of_the_gain_is_told_from_place_to_place_without_a_reference) {
  Bench bench;
  const double part = bench.within(1.0, 2.5) * bench.pair.noise_v / bench.pair.amplitude_v;
  Capture c = bench.capture(10000, 500.0, 1, from_place_to_place(bench));
  c.reference_deg.clear();
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double gain = 1.0 + bench.normal(part);
    c.vsin_v[i] = 2.5 + gain * (c.vsin_v[i] - 2.5);
    c.vcos_v[i] = 2.5 + gain * (c.vcos_v[i] - 2.5);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "amplitude-noise");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], part, 0.1 * part) << names(d);
}

KIND(noise_of_both_channels_is_no_noise_of_the_gain_from_place_to_place) {
  Bench bench;
  Capture c = bench.capture(10000, 500.0, 1, from_place_to_place(bench));
  c.reference_deg.clear();
  // One channel has more of it: at rest that lies along the vector, or across it.
  for (double &v : c.vsin_v)
    v += bench.normal(1.5 * bench.pair.noise_v);
  expect_none(diagnose(c, {}), {"amplitude-noise", "flicker-noise"});
}

KIND(noise_that_the_capture_did_not_state_is_told_by_the_radius_alone) {
  Bench bench;
  Capture c = bench.capture(10000, 500.0, 1, from_place_to_place(bench));
  c.reference_deg.clear();
  c.meta.noise_rms_v = 0.5 * bench.pair.noise_v;
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "excess-noise");
  ASSERT_TRUE(f) << left_of(d);
  const double more_v = std::sqrt(0.75) * bench.pair.noise_v;
  EXPECT_NEAR(f->values[0], more_v, 0.1 * more_v) << names(d);
}

/// A table that is read at its stops, in any order: its places are a grid, and the reference is as
/// good as ever.
KIND(places_of_a_table_are_no_steps_of_the_reference) {
  Bench bench;
  constexpr std::size_t kReadings = 17, kPlaces = 24;
  std::vector<std::size_t> order(kPlaces);
  std::iota(order.begin(), order.begin() + kPlaces / 2, std::size_t{0});
  for (std::size_t k = kPlaces / 2; k < kPlaces; ++k)
    order[k] = k;
  std::shuffle(order.begin() + kPlaces / 2, order.end(), std::mt19937_64(fresh_seed()));
  const auto place = [&](double t) {
    const auto k = std::min(static_cast<std::size_t>(t * 10.0 + 0.5) / kReadings, kPlaces - 1);
    const double half_way = order[k] < kPlaces / 2 ? 0.0 : 15.0;
    return (30.0 * static_cast<double>(order[k] % (kPlaces / 2)) + half_way) * kRadPerDeg;
  };
  expect_none(diagnose(bench.capture(kReadings * kPlaces, 10.0, 2, place), {}),
              {"reference-resolution"});
}

/// A hand cranks, twice as fast about two places of the turn as between them, and once in a while
/// in a hurry: where it is fastest, straight lines before and after are both too steep, and meet
/// with a gap that lies between no two samples.
void a_hand_in_a_hurry() {
  Bench bench;
  constexpr std::size_t kRows = 3300;
  const double dead = bench.within(0.3, 0.45), hurries_s = bench.within(10.0, 20.0);
  const double lasts_s = bench.within(0.5, 0.9), fastest = kTwoPi * bench.within(0.9, 1.3);
  std::vector<double> angle{0.0};
  for (std::size_t i = 1; i < kRows; ++i) {
    const double t = 0.01 * static_cast<double>(i), part = (t - hurries_s) / lasts_s;
    const double mean = kTwoPi * 0.15 + fastest * std::exp(-part * part);
    angle.push_back(angle.back() + 0.01 * mean * (1.0 + dead * std::cos(2.0 * angle.back())));
  }
  Capture c = bench.capture(kRows, 100.0, 1, [&](double t) {
    return angle[std::min(kRows - 1, static_cast<std::size_t>(t * 100.0 + 0.5))];
  });
  c.reference_deg.clear();
  expect_none(diagnose(c, {}), {"angle-slip"});
}

/// One in three of them has its fastest place where that shows.
KIND(a_hand_at_its_fastest_is_no_slip) {
  for (int k = 0; k < 5; ++k)
    a_hand_in_a_hurry();
}

/// A gearbox plays, and the field errs at the third order: partial likenesses of that order take no
/// place before it, or the play would be a delay beside them.
KIND(a_play_is_named_beside_a_field_that_errs) {
  Bench bench;
  const double width = bench.within(0.15, 0.4) * kRadPerDeg;
  const double third = bench.within(0.2, 0.6) * kRadPerDeg, hz = bench.within(0.4, 0.9);
  const auto shaft = [=](double t) { // there and back at one speed, and at another the next time
    const double whole = std::floor(t * 0.25), round = t * 0.25 - whole;
    const double faster = 1.0 + 0.3 * std::fmod(whole, 3.0);
    return kTwoPi * hz * 4.0 * faster * (round < 0.5 ? round : 1.0 - round);
  };
  double sensor = 0.0;
  Capture c = bench.capture(6000, 250.0, 1, [&](double t) {
    sensor = std::clamp(sensor, shaft(t) - 0.5 * width, shaft(t) + 0.5 * width);
    return sensor + third * std::sin(3.0 * sensor + 1.0);
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "hysteresis");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], width * kDegPerRad, 0.1 * width * kDegPerRad) << names(d);
  EXPECT_TRUE(named(d, "field-direction-error")) << names(d);
}

/// Of two causes that hold each a part of the radius none makes it worse on its way.
KIND(no_cause_leaves_more_than_before_where_the_angle_is_the_pairs_own) {
  Bench bench;
  Capture c = bench.capture(10000, 500.0, 1, from_place_to_place(bench));
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  ASSERT_GE(d.findings.size(), 2u) << names(d);
  for (const Finding &f : d.findings)
    EXPECT_LE(f.after.heldout.residual_rms_v, 1.02 * f.before.heldout.residual_rms_v) << names(d);
}

/// On a sixth of a turn a magnet that a field turns aside is told from no ellipse. What is said of
/// the pair holds it all the same within its errors.
KIND(on_a_short_arc_the_errors_of_the_pair_hold_what_a_stray_field_does) {
  Bench bench;
  bench.pair.noise_v = bench.within(0.001, 0.003);
  const double aside = bench.within(0.003, 0.009), towards = bench.within(0.0, kTwoPi),
               span = bench.within(0.14, 0.2), start = bench.within(0.0, kTwoPi);
  const auto shaft = [&](double t) {
    return start + kTwoPi * span * (0.5 - 0.5 * std::cos(kTwoPi * 0.3 * t));
  };
  Capture c = bench.capture(
      1500, 100.0, 2, [&](double t) { return shaft(t) - aside * std::sin(shaft(t) - towards); });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  constexpr double kErrors = 3.0;
  if (const Finding *k = named(d, "amplitude-mismatch")) {
    EXPECT_NEAR(k->values[0], bench.pair.k, kErrors * k->std_errors[0]) << left_of(d);
  }
  if (const Finding *delta = named(d, "quadrature-error")) {
    EXPECT_NEAR(delta->values[0], bench.pair.delta_rad * kDegPerRad, kErrors * delta->std_errors[0])
        << left_of(d);
  }
}

} // namespace
} // namespace ada::test

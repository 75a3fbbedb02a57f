// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// One turn against a reference, and a ring of many poles that its model does not describe: what is
// faster than anything that goes with the angle tells of an event, or of a tone, though no angle
// comes twice. Their signals are made here, and not by the model that is fitted to them.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

constexpr std::size_t kRows = 2000;
constexpr double kTurnRate = 2000.0;

/// A smooth function of the angle of many orders, of about this rms.
std::function<double(double)> many_orders(Bench &bench, int highest, double rms) {
  std::vector<double> amplitude, phase;
  double sum2 = 0.0;
  for (int n = 1; n <= highest; ++n) {
    amplitude.push_back(bench.normal(1.0) / n);
    phase.push_back(bench.within(0.0, kTwoPi));
    sum2 += 0.5 * amplitude.back() * amplitude.back();
  }
  const double scale = rms / std::sqrt(sum2);
  return [=](double angle) {
    double out = 0.0;
    for (std::size_t k = 0; k < amplitude.size(); ++k)
      out += scale * amplitude[k] * std::sin(static_cast<double>(k + 1) * angle + phase[k]);
    return out;
  };
}

struct OneTurn {
  Capture capture;
  int periods;
};

/// One turn of a field that no name describes: direction and strength go with the angle up to the
/// 20th order, as those of a magnet in a coil do.
OneTurn one_turn(Bench &bench) {
  const int periods = bench.within(0.0, 1.0) < 0.5 ? 1 : 2;
  const auto turned = many_orders(bench, 20, bench.within(0.1, 0.4) * kRadPerDeg);
  const auto longer = many_orders(bench, 20, bench.within(1e-3, 4e-3));
  const double turns = kTurnRate / static_cast<double>(kRows);
  Capture c = bench.capture(kRows, kTurnRate, periods, [&](double t) {
    const double angle = kTwoPi * turns * t;
    return angle + turned(angle);
  });
  for (std::size_t i = 0; i < kRows; ++i) {
    const double angle = kTwoPi * turns * c.time_s[i], gain = 1.0 + longer(angle);
    c.vsin_v[i] = 2.5 + gain * (c.vsin_v[i] - 2.5);
    c.vcos_v[i] = 2.5 + gain * (c.vcos_v[i] - 2.5);
    c.reference_deg[i] = wrap(angle * kDegPerRad, 360.0);
  }
  return {std::move(c), periods};
}

KIND(one_turn_alone_has_no_event_and_no_tone) {
  Bench bench;
  expect_none(diagnose(one_turn(bench).capture, {}),
              {"periodic-interference", "offset-step", "angle-slip", "impulse-noise", "sample-loss",
               "stuck-channel"});
}

KIND(one_turn_shows_a_tone_far_above_the_orders_of_the_turn) {
  Bench bench;
  Capture c = one_turn(bench).capture;
  const double hz = bench.within(0.12, 0.45) * kTurnRate, v = bench.within(0.01, 0.03),
               part = bench.within(0.2, 0.8), phase = bench.within(0.0, kTwoPi);
  for (std::size_t i = 0; i < kRows; ++i) {
    c.vsin_v[i] += v * std::sin(kTwoPi * hz * c.time_s[i]);
    c.vcos_v[i] += part * v * std::sin(kTwoPi * hz * c.time_s[i] + phase);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *tone = named(d, "periodic-interference");
  ASSERT_TRUE(tone) << left_of(d);
  EXPECT_NEAR(tone->values[0], hz, 5.0 * tone->std_errors[0]);
  EXPECT_NEAR(tone->values[1], v, std::max(5.0 * tone->std_errors[1], 0.05 * v));
  expect_none(d, {"offset-step", "angle-slip", "impulse-noise"});
}

KIND(one_turn_shows_an_offset_that_jumps) {
  Bench bench;
  Capture c = one_turn(bench).capture;
  const double step = bench.within(0.03, 0.06) * bench.pair.amplitude_v;
  const auto at = static_cast<std::size_t>(bench.within(0.3, 0.7) * kRows);
  for (std::size_t i = at; i < kRows; ++i)
    c.vcos_v[i] += step;
  const Diagnosis d = diagnose(c, {});
  const Finding *jump = named(d, "offset-step");
  ASSERT_TRUE(jump) << left_of(d);
  EXPECT_NEAR(jump->values[0], c.time_s[at], 2.0 / kTurnRate);
  EXPECT_NEAR(jump->values[2], step, 0.25 * step);
  expect_none(d, {"periodic-interference", "angle-slip", "impulse-noise"});
}

KIND(one_turn_shows_a_magnet_that_slips) {
  Bench bench;
  Capture c = one_turn(bench).capture;
  const double step_deg = bench.within(1.5, 4.0);
  const auto at = static_cast<std::size_t>(bench.within(0.3, 0.7) * kRows);
  for (std::size_t i = at; i < kRows; ++i) // as the reference has it: the other way
    c.reference_deg[i] = wrap(c.reference_deg[i] + step_deg, 360.0);
  const Diagnosis d = diagnose(c, {});
  const Finding *slip = named(d, "angle-slip");
  ASSERT_TRUE(slip) << left_of(d);
  EXPECT_NEAR(slip->values[0], c.time_s[at], 2.0 / kTurnRate);
  EXPECT_NEAR(slip->values[1], -step_deg, 0.25 * step_deg);
  expect_none(d, {"periodic-interference", "offset-step", "impulse-noise"});
}

KIND(one_turn_shows_a_gain_that_jumps_and_has_no_name) {
  Bench bench;
  Capture c = one_turn(bench).capture;
  const double left = 1.0 - bench.within(0.03, 0.08);
  const auto at = static_cast<std::size_t>(bench.within(0.3, 0.7) * kRows);
  for (std::size_t i = at; i < kRows; ++i) {
    c.vsin_v[i] = 2.5 + left * (c.vsin_v[i] - 2.5);
    c.vcos_v[i] = 2.5 + left * (c.vcos_v[i] - 2.5);
  }
  const Diagnosis d = diagnose(c, {});
  const auto said = std::find_if(d.structure.begin(), d.structure.end(), [](const Structure &s) {
    return s.description.find("changes at once") != std::string::npos;
  });
  EXPECT_NE(said, d.structure.end()) << left_of(d);
  EXPECT_NE(d.verdict, Verdict::explained) << left_of(d);
  expect_none(d, {"periodic-interference", "offset-step", "angle-slip", "gain-wander",
                  "offset-wander", "impulse-noise"});
}

KIND(one_turn_shows_a_level_at_which_both_channels_stop) {
  Bench bench;
  Capture c = one_turn(bench).capture;
  const double level = 2.5 + bench.within(0.8, 0.92) * bench.pair.amplitude_v;
  for (auto *column : {&c.vsin_v, &c.vcos_v})
    for (double &v : *column)
      v = std::min(v, level + bench.normal(bench.pair.noise_v));
  const Diagnosis d = diagnose(c, {});
  const Finding *stop = named(d, "clipping");
  ASSERT_TRUE(stop) << left_of(d);
  EXPECT_NEAR(stop->values[1], level, 0.02 * bench.pair.amplitude_v);
  expect_none(d, {"stuck-channel", "offset-step", "cubic-nonlinearity"});
}

KIND(noise_beyond_what_is_stated_is_named_beside_much_that_has_no_name) {
  Bench bench;
  Capture c = one_turn(bench).capture;
  const double more = bench.within(2.0, 4.0) * bench.pair.noise_v;
  c.meta.noise_rms_v = bench.pair.noise_v;
  for (auto *column : {&c.vsin_v, &c.vcos_v})
    for (double &v : *column)
      v += bench.normal(more);
  const Diagnosis d = diagnose(c, {});
  const Finding *noise = named(d, "excess-noise");
  ASSERT_TRUE(noise) << left_of(d);
  EXPECT_NEAR(noise->values[0], more, 0.15 * more);
}

/// A table that is read once at each of so many places: its angles are what it was told.
Capture told_places(Bench &bench, std::size_t places) {
  Capture c = bench.capture(
      places, 2.0, 1, [=](double t) { return kTwoPi * 2.0 * t / static_cast<double>(places); });
  for (double &a : c.reference_deg) // as text has them
    a = std::round(1e4 * a) / 1e4;
  return c;
}

KIND(a_channel_that_sticks_is_seen_in_a_hundred_readings) {
  Bench bench;
  const auto places = static_cast<std::size_t>(bench.within(90.0, 180.0));
  Capture c = told_places(bench, places);
  const auto at = static_cast<std::size_t>(bench.within(0.4, 0.7) * static_cast<double>(places));
  // Where it sticks at a peak nobody can tell.
  if (std::abs(c.vsin_v[at] - 2.5) > 0.9 * bench.pair.amplitude_v)
    return;
  for (std::size_t i = at; i < places; ++i)
    c.vsin_v[i] = c.vsin_v[at];
  const Diagnosis d = diagnose(c, {});
  const Finding *stuck = named(d, "stuck-channel");
  ASSERT_TRUE(stuck) << left_of(d);
  EXPECT_NEAR(stuck->values[1], c.time_s[at], 2.0);
  expect_none(d, {"clipping", "reference-resolution"});
}

KIND(angles_that_are_told_count_in_no_steps_though_the_magnet_slips) {
  Bench bench;
  const auto places = static_cast<std::size_t>(bench.within(90.0, 180.0));
  Capture c = told_places(bench, places);
  const double step_deg = bench.within(2.0, 5.0);
  const auto at = static_cast<std::size_t>(bench.within(0.4, 0.6) * static_cast<double>(places));
  const Capture whole = c;
  for (std::size_t i = at; i < places; ++i) {
    const double turn = step_deg * kRadPerDeg, s = whole.vsin_v[i] - 2.5, k = whole.vcos_v[i] - 2.5;
    c.vsin_v[i] = 2.5 + s * std::cos(turn) + k * std::sin(turn);
    c.vcos_v[i] = 2.5 + k * std::cos(turn) - s * std::sin(turn);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *slip = named(d, "angle-slip");
  ASSERT_TRUE(slip) << left_of(d);
  EXPECT_NEAR(slip->values[1], step_deg, 0.1 * step_deg);
  expect_none(d, {"reference-resolution", "offset-step"});
}

/// A ring of many poles, each of another length, turned by an uneven hand without a reference: what
/// its model leaves is much more than its noise, and smooth.
Capture uneven_ring(Bench &bench, double turns = 3.5) {
  constexpr int kPoles = 25;
  const auto turned = many_orders(bench, 70, bench.within(0.02, 0.06) / kPoles);
  const auto longer = many_orders(bench, 70, bench.within(0.04, 0.08));
  const double hz = turns / 4.8;
  Capture c = bench.capture(4800, 1000.0, kPoles, [&](double t) {
    const double angle = kTwoPi * hz * t;
    return angle + turned(angle);
  });
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double gain = 1.0 + longer(kTwoPi * hz * c.time_s[i]);
    c.vsin_v[i] = 2.5 + gain * (c.vsin_v[i] - 2.5);
    c.vcos_v[i] = 2.5 + gain * (c.vcos_v[i] - 2.5);
  }
  c.reference_deg.clear();
  return c;
}

KIND(a_ring_that_nothing_describes_has_no_spikes) {
  Bench bench;
  expect_none(diagnose(uneven_ring(bench), {}), {"impulse-noise", "periodic-interference"});
}

KIND(poles_that_differ_are_no_wander_where_no_pole_comes_twice) {
  Bench bench;
  expect_none(diagnose(uneven_ring(bench, bench.within(1.2, 1.9)), {}),
              {"gain-wander", "offset-wander", "flicker-noise", "supply-variation"});
}

KIND(spikes_stand_out_of_their_neighbours_beside_much_that_has_no_name) {
  Bench bench;
  Capture c = uneven_ring(bench);
  const double v = bench.within(0.15, 0.3) * bench.pair.amplitude_v;
  double count = 0.0;
  for (std::size_t i = 50; i < c.size(); i += static_cast<std::size_t>(bench.within(80.0, 220.0))) {
    c.vsin_v[i] += bench.within(-1.0, 1.0) < 0.0 ? -v : v;
    ++count;
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *spikes = named(d, "impulse-noise");
  ASSERT_TRUE(spikes) << left_of(d);
  const double rate = count / static_cast<double>(c.size());
  EXPECT_NEAR(spikes->values[0], rate, 0.25 * rate);
  EXPECT_NEAR(spikes->values[1], v, 0.25 * v);
}

/// The table of an encoder on the 200 full steps of a stepper, driven forth and back: errors of the
/// direction once, twice and four times a turn, of which each hides the others, and little beside.
KIND(orders_of_a_direction_that_hide_one_another_are_each_named) {
  constexpr int kOrders[] = {1, 2, 4};
  constexpr double kStepDeg = 1.8, kStepS = 0.05;
  Bench bench;
  double size[3], phase[3];
  for (std::size_t k = 0; k < 3; ++k) {
    size[k] = bench.within(0.2, 0.4) * kRadPerDeg;
    phase[k] = bench.within(0.0, kTwoPi);
  }
  const double rest = bench.within(0.03, 0.07) * kRadPerDeg, rest_phase = bench.within(0.0, kTwoPi);
  const int there = 400, n = 800;
  const auto step_of = [&](double t) {
    const int i = static_cast<int>(std::lround(t / kStepS));
    return i < there ? i : n - i;
  };
  const auto shaft = [&](double t) { return kStepDeg * kRadPerDeg * step_of(t); };
  Capture c = bench.capture(static_cast<std::size_t>(n), 1.0 / kStepS, 1, [&](double t) {
    const double a = shaft(t);
    double out = a + rest * std::sin(5.0 * a + rest_phase);
    for (std::size_t k = 0; k < 3; ++k)
      out += size[k] * std::sin(kOrders[k] * a + phase[k]);
    return out;
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(named(d, "stray-field") || named(d, "reference-eccentricity")) << left_of(d);
  EXPECT_TRUE(named(d, "sensor-off-axis") || named(d, "field-direction-error") ||
              named(d, "reference-harmonic"))
      << left_of(d);
  const bool fourth = std::any_of(d.findings.begin(), d.findings.end(), [&](const Finding &f) {
    return f.values[0] == 4.0 &&
           std::abs(f.values[1] - size[2] * kDegPerRad) < 0.2 * size[2] * kDegPerRad;
  });
  EXPECT_TRUE(fourth) << left_of(d);
}

} // namespace
} // namespace ada::test

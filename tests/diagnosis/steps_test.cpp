// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Benches on which the pair becomes another one at a moment: what no cause of the catalogue does is
// told by its moment and its size, and hides neither mismatch nor quadrature.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

constexpr double kStepSpan = 6.0; // s

/// Two speeds, there and back.
std::function<double(double)> there_and_back(Bench &bench) {
  const double slow = kTwoPi * bench.within(2.0, 4.0), fast = kTwoPi * bench.within(5.0, 8.0);
  return [=](double t) {
    return t < 0.5 * kStepSpan ? slow * t : slow * 0.5 * kStepSpan - fast * (t - 0.5 * kStepSpan);
  };
}

/// A moment away from the ends and from where the speed changes.
double some_moment(Bench &bench) {
  const double part = bench.within(0.1, 0.4);
  return kStepSpan * (bench.within(0.0, 1.0) < 0.5 ? part : 0.5 + part);
}

/// Of the sentences on what is left over, the one on the step at a moment; empty: there is none.
std::string step_at(const Diagnosis &d, double moment_s) {
  for (const Structure &s : d.structure)
    if (s.description.find(" s the pair changes at once") != std::string::npos &&
        std::abs(std::stod(s.description.substr(3)) - moment_s) < 1e-3)
      return s.description;
  return {};
}

/// The number after some words.
double number_after(const std::string &sentence, const std::string &words) {
  const std::size_t at = sentence.find(words);
  return at == std::string::npos ? std::nan("") : std::stod(sentence.substr(at + words.size()));
}

std::string all_of(const Diagnosis &d) {
  std::string out = names(d);
  for (const Structure &s : d.structure)
    out += "\n" + s.description;
  return out;
}

KIND(a_gain_that_is_switched_once_is_told_with_its_moment_and_size) {
  Bench bench;
  const double moment = some_moment(bench), by = bench.within(0.004, 0.03);
  const bool both = bench.within(0.0, 1.0) < 0.5;
  Capture c = bench.capture(18000, 18000 / kStepSpan, 2, there_and_back(bench));
  for (std::size_t i = 0; i < c.size(); ++i)
    if (c.time_s[i] >= moment) {
      c.vsin_v[i] += by * (c.vsin_v[i] - 2.5);
      if (both)
        c.vcos_v[i] += by * (c.vcos_v[i] - 2.5);
    }
  const Diagnosis d = diagnose(c, {});
  Pair mean = bench.pair;
  if (!both) // of the two states, as long as each lasts
    mean.k += by * (1.0 - moment / kStepSpan);
  expect_pair(d, mean, both ? 0.0 : by);
  for (const char *innocent : {"gain-wander", "offset-wander", "low-pass-rolloff"})
    EXPECT_FALSE(named(d, innocent)) << all_of(d);
  EXPECT_EQ(d.verdict, Verdict::partly_explained) << all_of(d);
  const std::string said = step_at(d, moment);
  ASSERT_FALSE(said.empty()) << moment << " s, " << all_of(d);
  EXPECT_NEAR(number_after(said, both ? "both amplitudes by " : "the amplitude of VSIN by "),
              1e2 * by, 5.0 * by)
      << said;
}

/// Between so few periods that an edge tells a step and so many that what is usual does, with and
/// without a reference.
KIND(a_magnet_that_loses_strength_at_once_does_not_wander) {
  Bench bench;
  const double turns = bench.within(20.0, 40.0), rate = 10000.0, length_s = bench.within(2.0, 5.0),
               moment = length_s * bench.within(0.2, 0.8), by = bench.within(0.02, 0.2);
  const auto samples = static_cast<std::size_t>(length_s * rate);
  const double speed = kTwoPi * turns / length_s / 2.0;
  Capture c = bench.capture(samples, rate, 2, [&](double t) { return speed * t; });
  if (bench.within(0.0, 1.0) < 0.5)
    c.reference_deg.clear();
  for (std::size_t i = 0; i < c.size(); ++i)
    if (c.time_s[i] >= moment)
      for (auto *column : {&c.vsin_v, &c.vcos_v})
        (*column)[i] -= by * ((*column)[i] - 2.5);
  const Diagnosis d = diagnose(c, {});
  const std::string what = std::to_string(turns) + " periods, " + std::to_string(by) + " at " +
                           std::to_string(moment) + " of " + std::to_string(length_s) + " s" +
                           (c.has_reference() ? "" : ", alone") + all_of(d);
  EXPECT_FALSE(named(d, "gain-wander")) << what;
  EXPECT_NE(d.verdict, Verdict::explained) << what;
  EXPECT_FALSE(step_at(d, moment).empty()) << what;
  const Finding *k = named(d, "amplitude-mismatch");
  ASSERT_TRUE(k) << what;
  EXPECT_NEAR(k->values[0], bench.pair.k, 4.0 * k->std_errors[0]) << what;
}

/// Without noise a slip has one moment, between two rows.
TEST(Steps, ASlipWithoutNoiseHasItsMoment) {
  Bench bench;
  bench.pair.noise_v = 0.0;
  const double moment = some_moment(bench);
  const auto shaft = there_and_back(bench);
  Capture c = bench.capture(18000, 18000 / kStepSpan, 2,
                            [&](double t) { return shaft(t) + (t >= moment ? kRadPerDeg : 0.0); });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  const Finding *slip = named(d, "angle-slip");
  ASSERT_TRUE(slip) << all_of(d);
  const double row_s = kStepSpan / 18000;
  EXPECT_NEAR(slip->values[0], moment, row_s);
  EXPECT_GT(slip->std_errors[0], 0.0);
  EXPECT_LT(slip->std_errors[0], row_s); // false for what is no number
}

KIND(slips_of_different_size_are_each_told) {
  Bench bench;
  const double first = kStepSpan * bench.within(0.1, 0.4),
               second = kStepSpan * bench.within(0.6, 0.9);
  const double large = bench.within(1.0, 2.0), small = bench.within(0.3, 0.8); // deg
  const bool large_first = bench.within(0.0, 1.0) < 0.5;
  const auto shaft = there_and_back(bench);
  Capture c = bench.capture(18000, 18000 / kStepSpan, 2, [&](double t) {
    const double one = large_first ? large : small, other = large_first ? small : large;
    return shaft(t) + kRadPerDeg * ((t >= first ? one : 0.0) + (t >= second ? other : 0.0));
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_EQ(d.verdict, Verdict::explained) << all_of(d);
  std::vector<const Finding *> slips;
  for (const Finding &f : d.findings)
    if (f.effect->info().id == "angle-slip")
      slips.push_back(&f);
  ASSERT_EQ(slips.size(), 2u) << all_of(d);
  std::sort(slips.begin(), slips.end(),
            [](const Finding *a, const Finding *b) { return a->values[0] < b->values[0]; });
  EXPECT_NEAR(slips[0]->values[0], first, 1e-3) << all_of(d);
  EXPECT_NEAR(slips[1]->values[0], second, 1e-3) << all_of(d);
  EXPECT_NEAR(slips[0]->values[1], large_first ? large : small, 0.02 * small) << all_of(d);
  EXPECT_NEAR(slips[1]->values[1], large_first ? small : large, 0.02 * small) << all_of(d);
}

KIND(offsets_that_step_up_or_down_twice_are_two_steps) {
  Bench bench;
  const double first = kStepSpan * bench.within(0.1, 0.4),
               second = kStepSpan * bench.within(0.6, 0.9);
  // What steps back again is a plateau, of which neither step is found without the other.
  const auto step_v = [&] {
    return bench.within(0.01, 0.03) * (bench.within(-1.0, 1.0) < 0.0 ? -1.0 : 1.0);
  };
  const double one = step_v(), other = step_v();
  Capture c = bench.capture(18000, 18000 / kStepSpan, 2, there_and_back(bench));
  for (std::size_t i = 0; i < c.size(); ++i)
    c.vsin_v[i] += (c.time_s[i] >= first ? one : 0.0) + (c.time_s[i] >= second ? other : 0.0);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_EQ(d.verdict, Verdict::explained) << all_of(d);
  std::vector<std::pair<double, double>> steps;
  for (const Finding &f : d.findings)
    if (f.effect->info().id == "offset-step")
      steps.emplace_back(f.values[0], f.values[1]);
  std::sort(steps.begin(), steps.end());
  ASSERT_EQ(steps.size(), 2u) << all_of(d);
  EXPECT_NEAR(steps[0].first, first, 1e-3);
  EXPECT_NEAR(steps[1].first, second, 1e-3);
  EXPECT_NEAR(steps[0].second, one, 2e-4);
  EXPECT_NEAR(steps[1].second, other, 2e-4);
}

// Two currents of a motor that runs to and fro under a load that comes and goes, and the zero of
// one sensor jumps: alpha and beta both show it. The amplitude wanders by much more than the step,
// and a course of the offsets could take the step in.
KIND(an_offset_that_jumps_beside_a_gain_that_wanders_is_a_step) {
  Bench bench;
  bench.pair.noise_v = bench.within(0.005, 0.01) * bench.pair.amplitude_v;
  const double rms = bench.within(0.06, 0.12), rate_hz = bench.within(25.0, 40.0),
               step = bench.within(0.03, 0.08) * bench.pair.amplitude_v,
               moment = kStepSpan * bench.within(0.3, 0.7);
  constexpr std::size_t kStretches = 5, kSines = 5;
  constexpr std::array<double, kStretches> kShares{1.0, 0.35, 0.7, 0.2, 0.85};
  std::array<double, kStretches> speed;
  for (std::size_t k = 0; k < kStretches; ++k)
    speed[k] = (k % 2 == 0 ? 1.0 : -1.0) * kShares[k] * rate_hz * bench.within(0.9, 1.1);
  // Runs of one speed each, which begin and end smoothly.
  const auto turns = [&](double t) {
    const double stretch = kStepSpan / kStretches;
    double out = 0.0;
    for (std::size_t k = 0; k < kStretches; ++k) {
      const double x = std::clamp(t / stretch - static_cast<double>(k), 0.0, 1.0);
      out += 0.2 * speed[k] * stretch * (x - std::sin(2.0 * kTwoPi * x) / (2.0 * kTwoPi) * 0.5);
    }
    return out;
  };
  std::array<std::array<double, 2>, kSines> sines;
  for (auto &[waves, at] : sines) {
    waves = bench.within(0.4, 2.2);
    at = bench.within(0.0, kTwoPi);
  }
  Capture c = bench.capture(12000, 2000.0, 3, [&](double t) { return kTwoPi * turns(t); });
  c.reference_deg.clear();
  for (std::size_t i = 0; i < c.size(); ++i) {
    double gain = 1.0;
    for (const auto &[waves, at] : sines)
      gain +=
          rms * std::sqrt(2.0 / kSines) * std::sin(kTwoPi * waves * c.time_s[i] / kStepSpan + at);
    const double jump = c.time_s[i] >= moment ? step : 0.0;
    c.vsin_v[i] = 2.5 + gain * (c.vsin_v[i] - 2.5) + jump / std::sqrt(3.0);
    c.vcos_v[i] = 2.5 + gain * (c.vcos_v[i] - 2.5) + jump;
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *jump = named(d, "offset-step");
  ASSERT_TRUE(jump) << all_of(d);
  EXPECT_NEAR(jump->values[0], moment, 0.05 * kStepSpan) << all_of(d);
  EXPECT_NEAR(std::hypot(jump->values[1], jump->values[2]), 2.0 / std::sqrt(3.0) * step, 0.2 * step)
      << all_of(d);
}

KIND(flicker_noise_makes_no_step) {
  Bench bench;
  constexpr double kRate = 4000.0;
  const double rms_v = bench.within(0.5, 1.5) * bench.pair.noise_v,
               corner_hz = bench.within(60.0, 150.0);
  Capture c = bench.capture(20000, kRate, 2, there_and_back(bench));
  // 1/f from the record's length to the corner: first-order processes of equal power, two an octave.
  const double lowest_hz = kRate / static_cast<double>(c.size());
  const int processes = static_cast<int>(2.0 * std::log2(corner_hz / lowest_hz));
  for (auto *v : {&c.vsin_v, &c.vcos_v})
    for (int k = 0; k < processes; ++k) {
      const double keeps = std::exp(-kTwoPi * lowest_hz * std::pow(2.0, 0.5 * k) / kRate);
      const double each_v = rms_v / std::sqrt(processes);
      double x = bench.normal(each_v);
      for (double &volts : *v) {
        volts += x;
        x = keeps * x + bench.normal(each_v * std::sqrt(1.0 - keeps * keeps));
      }
    }
  const Diagnosis d = diagnose(c, {});
  EXPECT_FALSE(named(d, "offset-step")) << all_of(d);
  expect_pair(d, bench.pair);
}

/// What moves slowly, however far, does nothing at once.
KIND(an_amplitude_that_drifts_is_no_step) {
  Bench bench;
  const double by = bench.within(0.005, 0.03), hz = bench.within(0.05, 0.3),
               start = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(18000, 18000 / kStepSpan, 2, there_and_back(bench));
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double gain = by * std::sin(kTwoPi * hz * c.time_s[i] + start);
    c.vsin_v[i] += gain * (c.vsin_v[i] - 2.5);
    c.vcos_v[i] += gain * (c.vcos_v[i] - 2.5);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_EQ(all_of(d).find("the pair changes at once"), std::string::npos) << all_of(d);
}

/// A table that goes from stop to stop, and a contact that gives while it rests: at rest the speed
/// is noise, and has no sense of its own.
KIND(an_offset_that_jumps_while_the_shaft_waits_is_a_step) {
  Bench bench;
  constexpr std::size_t kStops = 12;
  constexpr double kRate = 500.0, kRest = 0.8, kMove = 0.2, kReads = 0.002 * kRadPerDeg;
  const double way = kTwoPi * bench.within(0.6, 1.4) / static_cast<double>(kStops),
               sin_v = bench.within(0.01, 0.04) * (bench.within(-1.0, 1.0) < 0.0 ? -1.0 : 1.0),
               cos_v = bench.within(-0.04, 0.04);
  const auto stop = std::floor(bench.within(4.0, static_cast<double>(kStops) - 4.0));
  const double moment = stop * (kRest + kMove) + bench.within(0.2, 0.6) * kRest;
  Capture c = bench.capture(static_cast<std::size_t>(kStops * (kRest + kMove) * kRate), kRate, 2,
                            [&](double t) {
                              const double at = t / (kRest + kMove), whole = std::floor(at);
                              const double part = std::clamp(
                                  ((at - whole) * (kRest + kMove) - kRest) / kMove, 0.0, 1.0);
                              return way * (whole + part * part * (3.0 - 2.0 * part));
                            });
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.reference_deg[i] += bench.normal(kReads) * kDegPerRad;
    if (c.time_s[i] >= moment) {
      c.vsin_v[i] += sin_v;
      c.vcos_v[i] += cos_v;
    }
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "offset-step");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], moment, 0.02);
  EXPECT_NEAR(f->values[1], sin_v, 0.1 * std::abs(sin_v));
}

/// Turned forth, and back as fast, once: the centre and the length of the way back are other ones,
/// by more than all else that the pair has. What comes again at each place, there and back, is
/// found beside it, and no cause stands in for the step.
KIND(a_step_where_the_shaft_turns_back_hides_nothing_smaller) {
  Bench bench;
  const double speed = kTwoPi * bench.within(0.8, 1.2), moved_v = bench.within(0.01, 0.02),
               towards = bench.within(0.0, kTwoPi), longer = bench.within(0.005, 0.015),
               order_v = bench.within(0.25, 0.4) * moved_v;
  const double back_s = 0.5 * kStepSpan;
  const auto rows = static_cast<std::size_t>(bench.within(180.0, 600.0));
  Capture c = bench.capture(rows, static_cast<double>(rows) / kStepSpan, 1,
                            [&](double t) { return speed * (t < back_s ? t : 2.0 * back_s - t); });
  for (std::size_t i = 0; i < c.time_s.size(); ++i) {
    const double at = c.reference_deg[i] * kRadPerDeg;
    c.vsin_v[i] += order_v * std::sin(9.0 * at);
    c.vcos_v[i] += order_v * std::cos(9.0 * at);
    if (c.time_s[i] < back_s)
      continue;
    c.vsin_v[i] =
        kMiddleV + (1.0 + longer) * (c.vsin_v[i] - kMiddleV) + moved_v * std::sin(towards);
    c.vcos_v[i] =
        kMiddleV + (1.0 + longer) * (c.vcos_v[i] - kMiddleV) + moved_v * std::cos(towards);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *k = named(d, "amplitude-mismatch"), *delta = named(d, "quadrature-error");
  ASSERT_TRUE(k && delta) << all_of(d);
  EXPECT_NEAR(k->values[0], bench.pair.k, 2e-3) << all_of(d);
  EXPECT_NEAR(delta->values[0], bench.pair.delta_rad * kDegPerRad, 0.1) << all_of(d);
  EXPECT_TRUE(d.extended.remainder || named(d, "harmonic-distortion")) << all_of(d);
  EXPECT_TRUE(std::ranges::any_of(d.structure, [](const Structure &s) {
    return s.description.find("where the shaft turns back") != std::string::npos;
  })) << all_of(d);
  EXPECT_FALSE(std::ranges::any_of(d.structure, [](const Structure &s) {
    return s.description.find("too few to tell with what") != std::string::npos;
  })) << all_of(d);
  expect_none(
      d, {"reference-delay", "angle-slip", "reference-eccentricity", "hysteresis", "offset-step"});
}

/// Forth and back and again: what goes with the direction is told with it, and not a second time as
/// something that goes on from row to row.
KIND(what_goes_with_the_direction_in_few_rows_is_told_once) {
  Bench bench;
  const double speed = kTwoPi * bench.within(0.8, 1.2), moved_v = bench.within(0.005, 0.02),
               towards = bench.within(0.0, kTwoPi), back_s = kStepSpan / 4.0;
  const auto rows = static_cast<std::size_t>(bench.within(180.0, 390.0));
  const auto back = [&](double t) { return static_cast<int>(t / back_s) % 2 == 1; };
  Capture c = bench.capture(rows, static_cast<double>(rows) / kStepSpan, 1, [&](double t) {
    const double in = std::fmod(t, back_s);
    return speed * (back(t) ? back_s - in : in);
  });
  for (std::size_t i = 0; i < c.time_s.size(); ++i)
    if (back(c.time_s[i])) {
      c.vsin_v[i] += moved_v * std::sin(towards);
      c.vcos_v[i] += moved_v * std::cos(towards);
    }
  const Diagnosis d = diagnose(c, {});
  const auto told = [&](std::string_view words) {
    return std::ranges::any_of(d.structure, [&](const Structure &s) {
      return s.description.find(words) != std::string::npos;
    });
  };
  EXPECT_TRUE(told("change with speed or direction")) << all_of(d);
  EXPECT_FALSE(told("too few to tell with what")) << all_of(d);
}

} // namespace
} // namespace ada::test

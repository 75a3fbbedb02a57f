// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Tones that a bench shows only in part, what is no tone and looks like one, and levels that cut
// off some peaks.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

/// Rows of a shaft without a reference, so uneven that the angle is the pair's own.
Capture turned_unevenly(Bench &bench) {
  constexpr double kHz = 90.0;
  constexpr std::size_t kRows = 1800;
  const double speed = bench.within(0.35, 0.8), uneven = bench.within(0.08, 0.15),
               slow = bench.within(0.15, 0.4), at = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(kRows, kHz, 2, [&](double t) {
    return kTwoPi * speed * (t + uneven * std::sin(kTwoPi * slow * t + at) / slow / kTwoPi * 4.0);
  });
  c.reference_deg.clear();
  return c;
}

/// Where the angle is the pair's own only the radius is seen, and along it a tone is two lines, of
/// which one that turns has hardly the second.
KIND(a_tone_on_a_pair_that_is_its_own_reference_has_its_name) {
  Bench bench;
  Capture c = turned_unevenly(bench);
  const double hz = bench.within(30.0, 44.0), in_sin = bench.within(4.0, 9.0) * bench.pair.noise_v,
               in_cos = in_sin * bench.within(0.8, 1.25), phase = bench.within(0.0, kTwoPi),
               apart = std::copysign(bench.within(1.2, 1.9), bench.within(-1.0, 1.0));
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.vsin_v[i] += in_sin * std::sin(kTwoPi * hz * c.time_s[i] + phase);
    c.vcos_v[i] += in_cos * std::sin(kTwoPi * hz * c.time_s[i] + phase + apart);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *tone = named(d, "periodic-interference");
  ASSERT_TRUE(tone) << left_of(d);
  EXPECT_NEAR(tone->values[0], hz, 0.01) << left_of(d);
  EXPECT_NEAR(tone->values[1], in_sin, 0.3 * in_sin) << left_of(d);
  EXPECT_NEAR(tone->values[2], in_cos, 0.3 * in_cos) << left_of(d);
  expect_pair(d, bench.pair);
}

/// Beside the pair's own frequency one of a tone's two lines is slow, seen from the pair.
KIND(a_tone_beside_the_frequency_of_the_pair_has_its_name) {
  Bench bench;
  constexpr double kRate = 1000.0;
  constexpr std::size_t kRows = 4100;
  const double speed = bench.within(15.0, 40.0), uneven = bench.within(0.002, 0.01),
               slow = bench.within(0.5, 1.5), at = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(kRows, kRate, 1, [&](double t) {
    return kTwoPi * speed * (t + uneven * std::sin(kTwoPi * slow * t + at) / slow / kTwoPi);
  });
  c.reference_deg.clear();
  const double hz = speed + std::copysign(bench.within(0.4, 3.0), bench.within(-1.0, 1.0)),
               in_cos = bench.within(4.0, 8.0) * bench.pair.noise_v,
               in_sin = in_cos * bench.within(0.05, 0.3), phase = bench.within(0.0, kTwoPi);
  for (std::size_t i = 0; i < kRows; ++i) {
    c.vsin_v[i] += in_sin * std::sin(kTwoPi * hz * c.time_s[i] + phase);
    c.vcos_v[i] += in_cos * std::sin(kTwoPi * hz * c.time_s[i] + phase);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *tone = named(d, "periodic-interference");
  ASSERT_TRUE(tone) << left_of(d);
  EXPECT_NEAR(tone->values[0], hz, 0.02) << left_of(d);
  EXPECT_NEAR(tone->values[2], in_cos, 0.4 * in_cos) << left_of(d);
}

/// A gain that swings at one frequency on the same motion.
KIND(a_gain_that_swings_on_a_pair_that_is_its_own_reference_is_no_tone) {
  Bench bench;
  Capture c = turned_unevenly(bench);
  const double hz = bench.within(5.0, 40.0),
               part = bench.within(4.0, 9.0) * bench.pair.noise_v / bench.pair.amplitude_v,
               phase = bench.within(0.0, kTwoPi);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double gain = 1.0 + part * std::sin(kTwoPi * hz * c.time_s[i] + phase);
    c.vsin_v[i] = kMiddleV + gain * (c.vsin_v[i] - kMiddleV);
    c.vcos_v[i] = kMiddleV + gain * (c.vcos_v[i] - kMiddleV);
  }
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"periodic-interference"});
}

/// Three to five soaks of a chamber, a few turns at each and hours between them.
KIND(offsets_of_a_few_stretches_are_no_tone) {
  Bench bench;
  constexpr double kRate = 5.0;
  const auto soaks = static_cast<std::size_t>(bench.within(3.0, 4.99));
  const double speed = bench.within(0.02, 0.06), pause_s = bench.within(1500.0, 4000.0);
  const double part = bench.within(0.3, 1.0);
  constexpr std::size_t kRows = 400;
  Capture c = bench.capture(kRows * soaks, kRate, 2, [&](double t) { return kTwoPi * speed * t; });
  std::vector<double> sin, cos;
  for (std::size_t k = 0; k < soaks; ++k) {
    sin.push_back(bench.normal(0.01)); // of one cause: alike but for their size
    cos.push_back(part * sin.back());
  }
  for (std::size_t i = 0; i < c.size(); ++i) {
    const std::size_t soak = i / kRows;
    c.time_s[i] += static_cast<double>(soak) * pause_s;
    c.vsin_v[i] += sin[soak];
    c.vcos_v[i] += cos[soak];
  }
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"periodic-interference", "supply-variation", "low-pass-rolloff"});
  expect_pair(d, bench.pair);
}

/// A joint that swings evenly: a reference whose ratio is off errs with the angle, which in time is
/// lines at multiples of the swing.
KIND(what_goes_with_the_angle_of_a_joint_that_swings_is_no_tone) {
  Bench bench;
  constexpr double kRate = 250.0;
  constexpr std::size_t kRows = 1800;
  const double swings_hz = bench.within(3.0, 5.0), reach = bench.within(30.0, 45.0) * kRadPerDeg,
               phase = bench.within(0.0, kTwoPi), ratio = bench.within(0.002, 0.006);
  Capture c = bench.capture(
      kRows, kRate, 2, [&](double t) { return reach * std::sin(kTwoPi * swings_hz * t + phase); });
  for (std::size_t i = 0; i < kRows; ++i) {
    const double angle = reach * std::sin(kTwoPi * swings_hz * c.time_s[i] + phase);
    // Stiffer at the ends, as a belt is.
    c.reference_deg[i] =
        wrap(kDegPerRad * (angle + ratio * (angle + std::pow(angle, 3) / reach / reach)), 360.0);
  }
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"periodic-interference"});
}

/// What repeats with the angle so often that the sampling folds it between the lower orders.
KIND(an_order_of_the_turn_that_the_sampling_folds_is_no_tone) {
  Bench bench;
  constexpr double kRate = 11.3;
  constexpr std::size_t kRows = 6000;
  const int order = 2 * static_cast<int>(bench.within(5.0, 7.99)); // what a channel makes of itself
  const double speed = kRate / order * bench.within(0.55, 0.95);
  Capture c = bench.capture(kRows, kRate, 2, [&](double t) { return kTwoPi * speed * t; });
  const double in_sin = bench.within(5.0, 12.0) * bench.pair.noise_v,
               in_cos = in_sin * bench.within(0.3, 0.8), phase = bench.within(0.0, kTwoPi);
  for (std::size_t i = 0; i < kRows; ++i) {
    const double at = order * kTwoPi * speed * c.time_s[i] + phase;
    c.vsin_v[i] += in_sin * std::sin(at);
    c.vcos_v[i] += in_cos * std::sin(at + 1.0);
  }
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"periodic-interference"});
  expect_pair(d, bench.pair);
}

/// An amplitude that drifts by a tenth, and an output stage that is at its end in the part where it
/// is large: its level stands in the readings.
KIND(a_level_that_cuts_off_some_of_the_peaks_is_read_off) {
  Bench bench;
  constexpr double kRate = 500.0;
  const auto n = static_cast<std::size_t>(bench.within(2500.0, 6000.0));
  const double speed = bench.within(1.2, 2.4);
  Capture c = bench.capture(n, kRate, 1, [&](double t) { return kTwoPi * speed * t; });
  const double drift = bench.within(0.04, 0.1), at = bench.within(0.0, kTwoPi),
               level = kMiddleV + bench.pair.amplitude_v * (1.0 - 0.2 * drift);
  std::size_t cut = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double gain =
        1.0 + drift * std::sin(kTwoPi * 0.8 * static_cast<double>(i) / static_cast<double>(n) + at);
    for (auto *v : {&c.vsin_v[i], &c.vcos_v[i]}) {
      *v = kMiddleV + gain * (*v - kMiddleV);
      cut += *v > level;
      *v = std::min(*v, level);
    }
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *stop = named(d, "clipping");
  ASSERT_TRUE(stop) << cut << " rows of " << n << "; " << left_of(d);
  EXPECT_NEAR(stop->values[1], level, 1e-3) << left_of(d);
  EXPECT_TRUE(std::isnan(stop->values[0])) << left_of(d);
  EXPECT_TRUE(std::isnan(stop->values[2])) << left_of(d);
  expect_pair(d, bench.pair);
}

/// An encoder of few counts, of which one is lost over each turn and put right at its index: a ramp
/// once a turn, of which the rms is that of the rounding.
KIND(what_comes_again_beside_the_counts_of_a_reference_is_left_over) {
  Bench bench;
  constexpr double kRate = 200.0, kCount = 0.72;
  constexpr std::size_t kRows = 7900;
  const double speed = bench.within(0.55, 0.75), wander = bench.within(0.05, 0.15),
               at = bench.within(0.0, kTwoPi), lost = kCount;
  const auto angle = [&](double t) {
    return kTwoPi * speed * (t + wander * std::sin(kTwoPi * 0.05 * t + at) / 0.05 / kTwoPi);
  };
  Capture c = bench.capture(kRows, kRate, 1, angle);
  for (std::size_t i = 0; i < kRows; ++i) {
    const double true_deg = wrap(angle(c.time_s[i]) * kDegPerRad, 360.0);
    c.reference_deg[i] =
        wrap(kCount * std::round((true_deg - lost * true_deg / 360.0) / kCount), 360.0);
  }
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(named(d, "reference-resolution")) << left_of(d);
  EXPECT_NE(d.verdict, Verdict::explained) << left_of(d);
}

/// A transfer that is bent like a bow and stops at a level, without a reference: the noise behind
/// the level puts readings below it, which make no second one.
KIND(one_level_of_a_bent_channel_is_one_clipping) {
  Bench bench;
  const double bow = bench.within(0.006, 0.015) * (bench.within(-1.0, 1.0) < 0.0 ? -1.0 : 1.0),
               part = bench.within(0.85, 0.95), turns_hz = bench.within(3.0, 8.0),
               noise_v = bench.pair.noise_v;
  bench.pair.noise_v = 0.0;
  Capture c = bench.capture(16000, 1000.0, 2, [&](double t) { return kTwoPi * turns_hz * t; });
  const double level = kMiddleV + part * bench.pair.amplitude_v;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const auto bent = [&](double v) {
      const double x = v - kMiddleV;
      return kMiddleV + x + bow * x * x;
    };
    c.vsin_v[i] = bent(c.vsin_v[i]) + bench.normal(noise_v);
    c.vcos_v[i] = std::min(bent(c.vcos_v[i]), level) + bench.normal(noise_v);
  }
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  EXPECT_EQ(std::ranges::count_if(
                d.findings, [](const Finding &f) { return f.effect->info().id == "clipping"; }),
            1)
      << names(d);
  const Finding *f = named(d, "clipping");
  ASSERT_TRUE(f);
  EXPECT_NEAR(f->values[1], level, noise_v);
}

} // namespace
} // namespace ada::test

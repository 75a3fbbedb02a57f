// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What no cause of the catalogue explains, without a reference: it must be said, not taken for a
// rough motion or for a cause that is like it.

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "diagnosis/captures.h"
#include "diagnosis/diagnose.h"
#include "support/seed.h"

namespace ada::test {
namespace {

class Leftovers : public testing::Test {
protected:
  /// Two speeds after each other, or one; no reference.
  Capture sound(bool two_speeds) {
    Drive drive;
    drive.samples = 30000;
    drive.turns_back = false;
    drive.slow_rpm = drive.fast_rpm = 500.0;
    Capture c = capture_of(plain_sensor(), drive, rng_);
    if (two_speeds) { // the second half is another drive, joined where both stand at one angle
      drive.slow_rpm = drive.fast_rpm = 900.0;
      const Capture fast = capture_of(plain_sensor(), drive, rng_);
      const std::size_t half = drive.samples / 2;
      const double period = 360.0 / c.meta.periods_per_turn;
      const auto from = static_cast<std::size_t>(
          std::min_element(fast.reference_deg.begin(), fast.reference_deg.begin() + 500,
                           [&](double a, double b) {
                             const double at = c.reference_deg[half];
                             return std::abs(wrap_centred(a - at, period)) <
                                    std::abs(wrap_centred(b - at, period));
                           }) -
          fast.reference_deg.begin());
      for (std::size_t i = 0; half + i < drive.samples && from + i < drive.samples; ++i) {
        c.vsin_v[half + i] = fast.vsin_v[from + i];
        c.vcos_v[half + i] = fast.vcos_v[from + i];
      }
    }
    c.reference_deg.clear();
    return c;
  }

  static bool says(const Diagnosis &d, const std::string &words) {
    return std::any_of(d.structure.begin(), d.structure.end(), [&](const Structure &s) {
      return s.description.find(words) != std::string::npos;
    });
  }

  std::mt19937_64 rng_{fresh_seed()};
};

TEST_F(Leftovers, a_burst_of_hum_is_no_rough_motion) {
  Capture c = sound(false);
  for (std::size_t i = 12000; i < 18000; ++i) {
    c.vsin_v[i] += 0.01 * std::sin(kTwoPi * 50.0 * c.time_s[i]);
    c.vcos_v[i] += 0.007 * std::sin(kTwoPi * 50.0 * c.time_s[i] + 0.5);
  }
  const Diagnosis d = diagnose(c, {});
  // 50 Hz is the sixth order of the turn here: a little of it may pass for a cause, never for much.
  EXPECT_TRUE(d.verdict == Verdict::unexplained || d.verdict == Verdict::partly_explained);
  EXPECT_GT(d.extended_quality.heldout.residual_rms_v,
            0.8 * d.baseline_quality.heldout.residual_rms_v)
      << (d.findings.empty() ? "" : d.findings.front().explanation);
  EXPECT_TRUE(says(d, "the noise is not constant"));
}

TEST_F(Leftovers, an_angle_that_jitters_from_sample_to_sample_is_neither_noise_nor_motion) {
  Capture c = sound(false);
  std::normal_distribution<> jitter(0.0, 1e-3); // rad, electrical
  const double mid = 0.5 * c.meta.supply_v;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double turned = jitter(rng_), s = c.vsin_v[i] - mid, k = c.vcos_v[i] - mid;
    c.vsin_v[i] += turned * k;
    c.vcos_v[i] -= turned * s;
  }
  const Diagnosis d = diagnose(c, {});
  EXPECT_EQ(d.verdict, Verdict::unexplained);
  EXPECT_TRUE(says(d, "from sample to sample"));
}

TEST_F(Leftovers, offsets_that_settle_slowly_wander_and_are_no_step) {
  Capture c = sound(false);
  const double whole = c.time_s.back();
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.vsin_v[i] += 0.015 * std::exp(-5.0 * c.time_s[i] / whole);
    c.vcos_v[i] -= 0.008 * std::exp(-5.0 * c.time_s[i] / whole);
  }
  const Diagnosis d = diagnose(c, {});
  for (const Finding &f : d.findings)
    EXPECT_EQ(f.effect->info().id, "offset-wander");
}

TEST_F(Leftovers, offsets_that_come_with_the_speed_are_no_step) {
  Capture c = sound(true);
  for (std::size_t i = c.size() / 2; i < c.size(); ++i) {
    c.vsin_v[i] += 0.012;
    c.vcos_v[i] += 0.005;
  }
  const Diagnosis d = diagnose(c, {});
  // Nothing tells a wander that comes at the same moment from it, and nothing of it is corrected.
  for (const Finding &f : d.findings)
    EXPECT_EQ(f.effect->info().id, "offset-wander");
}

TEST_F(Leftovers, nothing_is_left_over_of_two_speeds_alone) {
  const Diagnosis d = diagnose(sound(true), {});
  EXPECT_EQ(d.verdict, Verdict::no_discrepancy);
}

/// A converter that misses codes: every `period`-th stretch of its range comes out at its end.
TEST_F(Leftovers, uneven_steps_of_a_converter_live_along_the_level) {
  constexpr double kStep = 5.0 / 65536.0, kPeriod = 256.0;
  const double missing = std::uniform_real_distribution<>(40.0, 90.0)(rng_);
  Drive drive;
  drive.samples = 40000;
  Capture c = capture_of(plain_sensor(), drive, rng_);
  for (auto *channel : {&c.vsin_v, &c.vcos_v})
    for (double &v : *channel) {
      const double code = std::round(v / kStep), rest = std::fmod(code, kPeriod);
      v = kStep * (rest > kPeriod - missing ? code - rest + kPeriod : code);
    }
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(says(d, "errs with its own level"));
  EXPECT_NE(d.verdict, Verdict::explained);
  // What of it repeats with the angle may pass for a small cause, never for much.
  for (const Finding &f : d.findings)
    EXPECT_GT(f.after.heldout.residual_rms_v, 0.95 * f.before.heldout.residual_rms_v)
        << f.explanation;
}

/// A housing that vibrates turns the vector at its own frequency. In the channels that shows to
/// both sides of it, as far off as the vector turns, and nothing at the frequency itself.
TEST_F(Leftovers, a_line_that_turns_the_vector_is_told_at_its_own_frequency) {
  Drive drive;
  drive.samples = 16000;
  drive.turns_back = false;
  drive.slow_rpm = 120.0; // at one speed it would be an order of the turn
  drive.fast_rpm = 240.0;
  Capture c = capture_of(plain_sensor(), drive, rng_);
  const double rate_hz = static_cast<double>(c.size() - 1) / (c.time_s.back() - c.time_s.front());
  const double hz = std::uniform_real_distribution<>(20.0, 90.0)(rng_);
  ASSERT_LT(hz, 0.3 * rate_hz);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double turned = 4e-3 * std::sin(kTwoPi * hz * c.time_s[i]);
    const double s = c.vsin_v[i] - 0.5 * c.meta.supply_v, k = c.vcos_v[i] - 0.5 * c.meta.supply_v;
    c.vsin_v[i] += turned * k;
    c.vcos_v[i] -= turned * s;
  }
  const Diagnosis d = diagnose(c, {});
  bool told = false;
  for (const Structure &s : d.structure)
    if (const auto at = s.description.find("across the vector at "); at != std::string::npos) {
      told = true;
      EXPECT_NEAR(std::stod(s.description.substr(at + 21)), hz, 2.0 * rate_hz / 16000.0)
          << s.description;
    }
  EXPECT_TRUE(told) << hz << " Hz";
}

/// A mean over many rows shortens the vector with the speed. That is no matter of the levels,
/// though at one speed each level errs by its own part.
TEST_F(Leftovers, a_mean_over_many_rows_is_no_uneven_converter) {
  Drive drive;
  drive.samples = 16000;
  drive.slow_rpm = 300.0;
  drive.fast_rpm = 1200.0;
  Capture c = capture_of(plain_sensor(), drive, rng_);
  const int rows = std::uniform_int_distribution<>(12, 20)(rng_);
  for (auto *channel : {&c.vsin_v, &c.vcos_v}) {
    const std::vector<double> raw = *channel;
    for (std::size_t i = static_cast<std::size_t>(rows); i < raw.size(); ++i) {
      double sum = 0.0;
      for (std::size_t k = 0; k < static_cast<std::size_t>(rows); ++k)
        sum += raw[i - k];
      (*channel)[i] = sum / rows;
    }
  }
  EXPECT_FALSE(says(diagnose(c, {}), "errs with its own level")) << rows << " rows";
}

TEST_F(Leftovers, an_even_converter_is_no_structure) {
  Drive drive;
  drive.samples = 40000;
  drive.noise_v = 1e-4; // far below its step
  Capture c = capture_of(plain_sensor(), drive, rng_);
  const int bits = std::uniform_int_distribution<>(10, 13)(rng_);
  const double step = 5.0 / std::exp2(bits);
  for (auto *channel : {&c.vsin_v, &c.vcos_v})
    for (double &v : *channel)
      v = step * std::round(v / step);
  c.meta.adc_bits = bits;
  c.meta.adc_reference_v = 5.0;
  const Diagnosis d = diagnose(c, {});
  EXPECT_FALSE(says(d, "errs with its own level")) << bits << " bits";
  EXPECT_TRUE(d.findings.empty());
}

TEST_F(Leftovers, a_channel_that_died_is_named_however_little_is_left) {
  for (double turns : {4.0, 1.5}) {
    Drive drive;
    drive.slow_rpm = drive.fast_rpm = 600.0;
    drive.turns_back = false;
    Capture c = capture_of(plain_sensor(), drive, rng_);
    const auto dead = static_cast<std::size_t>(turns / 10.0 * drive.rate_hz);
    std::fill(c.vsin_v.begin() + static_cast<std::ptrdiff_t>(dead), c.vsin_v.end(), 2.5);
    const Diagnosis d = diagnose(c, {});
    ASSERT_EQ(d.findings.size(), 1u)
        << turns << " turns" << (d.findings.empty() ? "" : ": " + d.findings.back().explanation);
    EXPECT_EQ(d.findings[0].effect->info().id, "stuck-channel");
    EXPECT_EQ(d.verdict, Verdict::explained)
        << (d.structure.empty() ? "" : d.structure.front().description);
  }
}

} // namespace
} // namespace ada::test

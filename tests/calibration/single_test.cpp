// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/single.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "base/error.h"
#include "conversion/ellipse.h"
#include "conversion/frame_converter.h"
#include "support/angle_error.h"
#include "support/effect_value.h"
#include "support/seed.h"
#include "support/sensor_pair.h"

namespace ada::test {
namespace {

/// A sensor with offsets and imperfections of its own, drawn from the seed.
SensorPair drawn_pair(Sampler &draw, bool elliptic) {
  SensorPair pair;
  pair.offset_sin_v = draw.uniform(-0.1, 0.1);
  pair.offset_cos_v = draw.uniform(-0.1, 0.1);
  if (elliptic) {
    pair.k = draw.uniform(-0.01, 0.01);
    pair.delta_rad = draw.uniform(-0.05, 0.05) * kRadPerDeg;
  }
  return pair;
}

double error_on_another_capture(const Model &model, const SensorPair &pair, std::uint64_t seed) {
  Sampler sampler(pair, seed);
  const Capture test = sampler.capture(10000, 5.0, swinging_speed(23.0, 0.5, 0.37));
  std::vector<ada4571_angle> angles(test.size());
  FrameConverter(model).capture(test, angles);
  return rms_error_deg(angles, test);
}

struct Target {
  CalibrationMethod method;
  double limit_deg;
};

class SingleAccuracy : public testing::TestWithParam<Target> {};

TEST_P(SingleAccuracy, another_capture_at_other_speeds_stays_within_the_limit) {
  const std::uint64_t seed = fresh_seed();
  Sampler draw(SensorPair{}, seed);
  for (const bool elliptic : {false, true})
    for (int i = 0; i < 5; ++i) {
      const SensorPair pair = drawn_pair(draw, elliptic);
      Sampler sampler(pair, seed + 100 + i);
      const Capture capture = sampler.capture(10000, 7.0, swinging_speed(11.1, 0.3, 0.61));
      const Model model = calibrate_single(capture, GetParam().method);
      const double error = error_on_another_capture(model, pair, seed + 200 + i);
      std::printf("  %s: %.5f deg rms\n", method_name(GetParam().method), error);
      EXPECT_LT(error, GetParam().limit_deg);
      EXPECT_GT(error, 0.0095); // the noise is there: nothing looked at the reference
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, SingleAccuracy,
                         testing::Values(Target{CalibrationMethod::fit, 0.0112},
                                         Target{CalibrationMethod::mean, 0.0125},
                                         Target{CalibrationMethod::extrema, 0.05}),
                         [](const auto &i) { return std::string(method_name(i.param.method)); });

TEST(SingleFit, works_without_a_time_base_in_any_order) {
  SensorPair pair;
  Sampler sampler(pair, fresh_seed());
  Capture c = sampler.capture(2000, 2.0, constant_speed(3.3));
  const Model before = calibrate_single(c, CalibrationMethod::fit);
  std::mt19937_64 rng(7);
  std::vector<std::size_t> order(c.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    order[i] = i;
  std::shuffle(order.begin(), order.end(), rng);
  Capture shuffled = c;
  for (std::size_t i = 0; i < order.size(); ++i) {
    shuffled.vsin_v[i] = c.vsin_v[order[i]];
    shuffled.vcos_v[i] = c.vcos_v[order[i]];
    shuffled.time_s[i] = 0;
  }
  const Model after = calibrate_single(shuffled, CalibrationMethod::fit);
  EXPECT_NEAR(after.baseline.offset_sin_v, before.baseline.offset_sin_v, 1e-9);
  EXPECT_NEAR(after.baseline.amplitude_v, before.baseline.amplitude_v, 1e-9);
}

TEST(SingleFit, half_a_turn_is_enough) {
  const std::uint64_t seed = fresh_seed();
  SensorPair pair;
  Sampler sampler(pair, seed);
  // Half a mechanical turn is one electrical period; a third of a turn less than one.
  for (const double turns : {0.5, 0.33}) {
    const Capture c = sampler.capture(10000, 2.0, constant_speed(turns / 2.0));
    EXPECT_LT(error_on_another_capture(calibrate_single(c, CalibrationMethod::fit), pair, seed + 1),
              0.0112);
  }
}

TEST(SingleFit, a_short_arc_leaves_out_what_it_cannot_tell) {
  SensorPair pair;
  Sampler sampler(pair, fresh_seed());
  const Capture c = sampler.capture(1000, 0.5, constant_speed(55.0 / 360 / 0.5)); // 110 deg elec.
  const Model model = calibrate_single(c, CalibrationMethod::fit);
  EXPECT_FALSE(test::effect_value(model, "amplitude-mismatch", "k").has_value());
  EXPECT_NEAR(model.baseline.offset_sin_v, pair.offset_sin_v, 0.003);
}

TEST(SingleMean, uneven_speed_does_not_bias_it) {
  // Ripple at the second order a turn, which shifts a mean over time by 1 % of the amplitude.
  SensorPair pair;
  Sampler sampler(pair, fresh_seed());
  const Capture c = sampler.capture(10000, 2.0, swinging_speed(5.0, 0.2, 2.0));
  double plain = 0;
  for (const double v : c.vcos_v)
    plain += v / static_cast<double>(c.size());
  const Model model = calibrate_single(c, CalibrationMethod::mean);
  EXPECT_NEAR(model.baseline.offset_sin_v, pair.offset_sin_v, 0.0001);
  EXPECT_NEAR(model.baseline.offset_cos_v, pair.offset_cos_v, 0.0001);
  EXPECT_GT(std::hypot(plain - 2.5 - pair.offset_cos_v, 0.0) +
                std::abs(std::accumulate(c.vsin_v.begin(), c.vsin_v.end(), 0.0) /
                             static_cast<double>(c.size()) -
                         2.5 - pair.offset_sin_v),
            0.01); // what the even mean would have been off by
}

TEST(SingleMean, turning_to_and_fro_counts_net_turns) {
  SensorPair pair;
  Sampler sampler(pair, fresh_seed());
  const Motion swing = [](double t) { return 1.3 * kTwoPi * (1 - std::cos(kTwoPi * t / 2)) / 2; };
  const Capture c = sampler.capture(5000, 4.0, swing); // 1.3 turns there and back, twice
  const Model model = calibrate_single(c, CalibrationMethod::mean);
  EXPECT_NEAR(model.baseline.offset_sin_v, pair.offset_sin_v, 0.0002);
  EXPECT_NEAR(model.baseline.offset_cos_v, pair.offset_cos_v, 0.0002);
}

TEST(SingleMean, whole_mechanical_turns_average_a_stray_field_out) {
  SensorPair pair;
  pair.stray = 0.01;
  Sampler sampler(pair, fresh_seed());
  // 3.4 turns: 0.4 of a turn is most of a period, which alone would be off by 0.6 % of A = 9 mV.
  const Capture c = sampler.capture(10000, 2.0, constant_speed(1.7));
  const Model model = calibrate_single(c, CalibrationMethod::mean);
  EXPECT_NEAR(model.baseline.offset_sin_v, pair.offset_sin_v, 0.0005);
  EXPECT_NEAR(model.baseline.offset_cos_v, pair.offset_cos_v, 0.0005);
}

TEST(Single, model_carries_where_it_came_from) {
  SensorPair pair;
  Sampler sampler(pair, 3);
  Capture c = sampler.capture(1000, 2.0, constant_speed(2.0), [](double t) { return 20 + 5 * t; });
  c.meta.serial = "S7";
  c.meta.gain_control = true;
  const Model m = calibrate_single(c, CalibrationMethod::fit);
  EXPECT_EQ(m.provenance.serial, "S7");
  EXPECT_EQ(m.provenance.method, "single fit");
  EXPECT_EQ(m.provenance.capture_identity, "test");
  EXPECT_NEAR(m.provenance.heldout_residual_rms_v.value(), *m.provenance.fit_residual_rms_v,
              0.01 * *m.provenance.fit_residual_rms_v);
  EXPECT_EQ(m.provenance.gain_control, true);
  EXPECT_NEAR(*m.provenance.vtemp_min_v, pair.vtemp_of(20), 0.003);
  EXPECT_NEAR(*m.provenance.vtemp_max_v, pair.vtemp_of(30), 0.003);
  EXPECT_NEAR(m.vtemp_reference_v, pair.vtemp_of(25), 0.003);
  EXPECT_NEAR(*m.noise_rms_v, 0.0005, 0.00005);
  EXPECT_GT(m.baseline_std_error.offset_sin_v, 0);
}

// --- guards: each with its reason

void expect_refusal(const Capture &capture, CalibrationMethod method, const std::string &reason) {
  try {
    calibrate_single(capture, method);
    ADD_FAILURE() << "not refused: " << reason;
  } catch (const Error &e) {
    EXPECT_EQ(e.status(), ADA4571_ERROR_UNUSABLE_DATA);
    EXPECT_NE(std::string(e.what()).find(reason), std::string::npos) << e.what();
  }
}

Capture sound_capture(double turns, std::uint64_t seed = 5) {
  return Sampler(SensorPair{}, seed).capture(2000, 2.0, constant_speed(turns / 2.0));
}

TEST(SingleGuards, too_little_coverage) {
  expect_refusal(sound_capture(0.1), CalibrationMethod::fit, "electrical degrees (36 mechanical)");
  expect_refusal(sound_capture(0.9), CalibrationMethod::mean, "whole mechanical turn");
  expect_refusal(sound_capture(0.45), CalibrationMethod::extrema, "whole electrical period");
  EXPECT_NO_THROW(calibrate_single(sound_capture(0.6), CalibrationMethod::extrema));
  EXPECT_NO_THROW(calibrate_single(sound_capture(1.1), CalibrationMethod::mean));
}

TEST(SingleGuards, standstill) {
  expect_refusal(sound_capture(0.0), CalibrationMethod::fit, "does not turn");
}

/// What no file may hold is a fault of the capture, told before anything is written.
TEST(SingleGuards, a_circle_that_is_no_sensors) {
  for (const auto &[scale, shift] : {std::pair(1e5, 0.0), std::pair(1.0, 200.0),
                                     std::pair(1.0, -8.0), std::pair(1e-7, 0.0)}) {
    Capture c = sound_capture(3);
    for (auto *channel : {&c.vsin_v, &c.vcos_v})
      for (double &v : *channel)
        v = shift + scale * v;
    for (const auto method :
         {CalibrationMethod::fit, CalibrationMethod::mean, CalibrationMethod::extrema})
      expect_refusal(c, method, scale < 1 ? "" : "supply_v or");
  }
}

TEST(SingleGuards, stuck_channel) {
  Capture c = sound_capture(3);
  c.vsin_v.assign(c.size(), 2.5);
  expect_refusal(c, CalibrationMethod::fit, "VSIN is stuck");
  c = sound_capture(3);
  for (std::size_t i = c.size() / 2; i < c.size(); ++i)
    c.vcos_v[i] = c.vcos_v[c.size() / 2];
  expect_refusal(c, CalibrationMethod::fit, "VCOS is stuck for a part");
}

TEST(SingleGuards, shorted_channels) {
  Capture c = sound_capture(3);
  c.vcos_v = c.vsin_v;
  expect_refusal(c, CalibrationMethod::fit, "along one line");
}

TEST(SingleGuards, clipping) {
  for (const double fraction : {0.9, 0.97}) {
    Capture c = sound_capture(3);
    Sampler sampler(SensorPair{}, 9);
    for (double &v : c.vsin_v)
      v = std::min(v, 2.531 + fraction * 1.45) + sampler.noise(0.0003);
    for (const auto method :
         {CalibrationMethod::fit, CalibrationMethod::mean, CalibrationMethod::extrema})
      expect_refusal(c, method, "VSIN is clipped");
  }
}

TEST(SingleGuards, a_peak_with_two_humps_is_not_taken_for_clipping) {
  // As measured on a sensor in a weak field: a dent of 2 % of the amplitude at the peak.
  Capture c = sound_capture(3);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double s = (c.vsin_v[i] - 2.531) / 1.45, k = (c.vcos_v[i] - 2.482) / 1.45;
    if (s > 0)
      c.vsin_v[i] -= 0.02 * 1.45 * std::exp(-k * k / 0.004);
  }
  EXPECT_NO_THROW(calibrate_single(c, CalibrationMethod::fit));
}

TEST(SingleGuards, one_turn_that_ends_a_sample_early_is_whole) {
  Capture c = sound_capture(1.0);
  EXPECT_NO_THROW(calibrate_single(c, CalibrationMethod::mean));
  EXPECT_NO_THROW(calibrate_single(c, CalibrationMethod::extrema));
}

TEST(SingleGuards, known_distortions_are_not_refused) {
  // Third harmonic as a weak field gives it, bow and cubic transfer errors, all at 3 %.
  for (const int shape : {0, 1, 2, 3}) {
    Capture c = sound_capture(3);
    for (std::size_t i = 0; i < c.size(); ++i) {
      const double psi = 2 * c.reference_deg[i] * kRadPerDeg;
      const double s = (c.vsin_v[i] - 2.5) / 1.45, k = (c.vcos_v[i] - 2.5) / 1.45;
      const double ds[] = {-std::sin(3 * psi), s * s, -s * s * s, s * s * s};
      const double dk[] = {std::cos(3 * psi), k * k, -k * k * k, k * k * k};
      c.vsin_v[i] += 0.03 * 1.45 * ds[shape];
      c.vcos_v[i] += 0.03 * 1.45 * dk[shape];
    }
    for (const auto method :
         {CalibrationMethod::fit, CalibrationMethod::mean, CalibrationMethod::extrema})
      EXPECT_NO_THROW(calibrate_single(c, method)) << shape;
  }
}

TEST(SingleGuards, a_clipped_peak_of_a_table_of_one_turn_is_seen) {
  Sampler sampler(SensorPair{}, fresh_seed());
  Capture c = sampler.capture(200, 20.0, constant_speed(0.05)); // one mechanical turn
  Capture whole = c;
  for (double &v : c.vcos_v)
    v = std::min(v, 2.5 + 0.85 * 1.45);
  expect_refusal(c, CalibrationMethod::fit, "VCOS is clipped");
  EXPECT_NO_THROW(calibrate_single(whole, CalibrationMethod::fit));
}

TEST(SingleGuards, a_flat_ellipse_is_no_arc) {
  // Soft iron beside a magnetometer: one channel five times weaker, a third of a radian off.
  SensorPair pair;
  pair.k = -1.34;
  pair.delta_rad = 20.0 * kRadPerDeg;
  pair.amplitude_v = 0.7;
  pair.noise_rms_v = 0.002;
  Sampler sampler(pair, fresh_seed());
  const Model model =
      calibrate_single(sampler.capture(2000, 20.0, constant_speed(0.3)), CalibrationMethod::fit);
  EXPECT_NEAR(effect_value(model, "amplitude-mismatch", "k").value(), pair.k, 0.01);
}

} // namespace
} // namespace ada::test

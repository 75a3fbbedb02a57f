// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "conversion/frame_converter.h"

#include <cmath>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "base/error.h"
#include "calibration/single.h"
#include "conversion/sample_status.h"
#include "support/angle_error.h"
#include "support/sensor_pair.h"

namespace ada::test {
namespace {

Frame frame_at(double time_s, double alpha, const SensorPair &pair = {}) {
  SensorPair quiet = pair;
  quiet.noise_rms_v = 0;
  Frame f = empty_frame();
  f.time_s = time_s;
  Sampler(quiet, 1).pair_at(alpha, quiet.vtemp_reference_v, f.vsin_v, f.vcos_v);
  return f;
}

Model model_of_pair(const SensorPair &pair = {}) {
  Model m;
  m.periods_per_turn = pair.periods;
  m.baseline = {pair.amplitude_v, pair.offset_sin_v, pair.offset_cos_v, 0};
  m.vtemp_reference_v = pair.vtemp_reference_v;
  return m;
}

ada4571_angle convert_one(const Model &model, const Frame &f) {
  ada4571_angle a;
  FrameConverter(model).frames({&f, 1}, {&a, 1});
  return a;
}

TEST(FrameConverter, angle_is_mechanical_and_in_its_range) {
  for (const int p : {1, 2}) {
    SensorPair pair;
    pair.periods = p;
    for (int i = 0; i < 720; ++i) {
      const double alpha = i * 0.5 * kRadPerDeg;
      const auto a = convert_one(model_of_pair(pair), frame_at(i, alpha, pair));
      EXPECT_GE(a.angle_deg, 0.0);
      EXPECT_LT(a.angle_deg, 360.0 / p);
      EXPECT_NEAR(wrap_centred(a.angle_deg - i * 0.5, 360.0 / p), 0, 1e-9);
      EXPECT_NEAR(a.radius, 1, 1e-12);
      EXPECT_EQ(a.status, 0u);
      EXPECT_EQ(a.time_s, i);
    }
  }
}

TEST(FrameConverter, zero_angle_is_subtracted) {
  Model model = model_of_pair();
  model.baseline.angle_zero_deg = 30; // psi = p (alpha + zero)
  EXPECT_NEAR(convert_one(model, frame_at(0, 50 * kRadPerDeg)).angle_deg, 20, 1e-9);
}

TEST(FrameConverter, status_tells_what_is_wrong) {
  Frame f = frame_at(0, 0.3);
  f.vsin_v = std::nan("");
  auto a = convert_one(model_of_pair(), f);
  EXPECT_EQ(a.status, unsigned{ADA4571_SAMPLE_INVALID});
  EXPECT_TRUE(std::isnan(a.angle_deg));
  f = frame_at(0, 0.3);
  f.vsin_v = 0.01; // at a rail
  EXPECT_TRUE(convert_one(model_of_pair(), f).status & ADA4571_SAMPLE_RAIL);
  f = frame_at(0, 0.0); // cos at its peak
  f.vcos_v = 4.96;      // at the other rail, 1.70 of the amplitude
  EXPECT_EQ(convert_one(model_of_pair(), f).status,
            unsigned{ADA4571_SAMPLE_RAIL | ADA4571_SAMPLE_RADIUS});
  f = frame_at(0, 0.0);
  f.vcos_v = 2.5; // a broken wire at mid-supply where the other channel crosses it
  EXPECT_EQ(convert_one(model_of_pair(), f).status, unsigned{ADA4571_SAMPLE_RADIUS});
}

TEST(FrameConverter, radius_band_has_its_documented_ends) {
  for (const auto &[scale, sound] : {std::pair{kRadiusMin - 1e-6, false},
                                     {kRadiusMin + 1e-6, true},
                                     {kRadiusMax - 1e-6, true},
                                     {kRadiusMax + 1e-6, false}}) {
    Model model = model_of_pair();
    model.baseline.amplitude_v /= scale;
    EXPECT_EQ(convert_one(model, frame_at(0, 0.4)).status == 0, sound) << scale;
  }
}

TEST(FrameConverter, gaps_in_time_are_flagged_once) {
  FrameConverter converter(model_of_pair());
  std::vector<Frame> frames;
  for (int i = 0; i < 300; ++i)
    frames.push_back(frame_at((i < 200 ? i : i + 3) * 1e-3, 0.01 * i));
  std::vector<ada4571_angle> angles(frames.size());
  // Block after block: the state goes over the seam.
  converter.frames({frames.data(), 200}, {angles.data(), 200});
  converter.frames({frames.data() + 200, 100}, {angles.data() + 200, 100});
  for (std::size_t i = 0; i < angles.size(); ++i)
    EXPECT_EQ(angles[i].status, i == 200 ? unsigned{ADA4571_SAMPLE_GAP} : 0u) << i;
}

TEST(FrameConverter, a_ragged_clock_is_no_row_of_gaps) {
  FrameConverter converter(model_of_pair());
  std::mt19937_64 rng(4);
  std::exponential_distribution<double> step(1000);
  double t = 0;
  int flagged = 0;
  for (int i = 0; i < 5000; ++i) {
    const Frame f = frame_at(t += step(rng), 0.01 * i);
    ada4571_angle a;
    converter.frames({&f, 1}, {&a, 1});
    flagged += (a.status & ADA4571_SAMPLE_GAP) != 0;
  }
  EXPECT_LT(flagged, 25); // Poisson steps: not one in 200
}

TEST(FrameConverter, temperature_is_followed_and_held_over_a_missing_vtemp) {
  SensorPair pair;
  pair.tc_sin = 0.02;
  Model model = model_of_pair(pair);
  model.effects.push_back(effect_instance("offset-temperature-drift", {0.02, 0.0}, {}));
  FrameConverter converter(model);
  const double vtemp = pair.vtemp_reference_v + 0.5, alpha = 0.7;
  Frame f = empty_frame();
  f.time_s = 0;
  Sampler(pair, 1).pair_at(alpha, vtemp, f.vsin_v, f.vcos_v);
  ada4571_angle a;
  converter.frames({&f, 1}, {&a, 1});
  EXPECT_EQ(a.status, unsigned{ADA4571_SAMPLE_INVALID}); // none seen yet
  f.vtemp_v = vtemp;
  converter.frames({&f, 1}, {&a, 1});
  EXPECT_NEAR(a.angle_deg * kRadPerDeg, alpha, 1e-12);
  f.vtemp_v = std::nan("");
  converter.frames({&f, 1}, {&a, 1});
  EXPECT_NEAR(a.angle_deg * kRadPerDeg, alpha, 1e-12);
}

TEST(FrameConverter, a_capture_at_another_supply_scales) {
  SensorPair at_5v, at_4v;
  at_5v.noise_rms_v = at_4v.noise_rms_v = 0;
  at_5v.adc_bits = at_4v.adc_bits = 0;
  at_4v.supply_v = 4;
  at_4v.amplitude_v *= 0.8;
  at_4v.offset_sin_v *= 0.8;
  at_4v.offset_cos_v *= 0.8;
  const Capture c = Sampler(at_4v, 1).capture(1000, 1, constant_speed(1));
  std::vector<ada4571_angle> angles(c.size());
  FrameConverter(model_of_pair(at_5v)).capture(c, angles);
  EXPECT_LT(rms_error_deg(angles, c), 1e-9);
}

TEST(FrameConverter, a_capture_of_another_kind_of_sensor_is_refused) {
  SensorPair tmr;
  tmr.periods = 1;
  const Capture c = Sampler(tmr, 1).capture(1000, 1, constant_speed(1));
  std::vector<ada4571_angle> angles(c.size());
  EXPECT_THROW(FrameConverter(model_of_pair()).capture(c, angles), Error);
}

} // namespace
} // namespace ada::test

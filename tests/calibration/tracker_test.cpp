// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/tracker.h"

#include <cmath>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "base/error.h"
#include "calibration/single.h"
#include "conversion/frame_converter.h"
#include "support/angle_error.h"
#include "support/seed.h"
#include "support/sensor_pair.h"

namespace {
thread_local bool counting = false;
thread_local std::size_t allocations = 0;
} // namespace

// Every allocation of this program passes here, so that "no allocation" is counted, not believed.
// Not inlined: GCC would see a free() of what looks like its own new.
[[gnu::noinline]] void *operator new(std::size_t size) {
  allocations += counting;
  if (void *p = std::malloc(size))
    return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void *p) noexcept {
  std::free(p);
}
[[gnu::noinline]] void operator delete(void *p, std::size_t) noexcept {
  std::free(p);
}

namespace ada::test {
namespace {

Model stored_model(const SensorPair &pair) {
  Model m;
  m.periods_per_turn = pair.periods;
  m.supply_v = pair.supply_v;
  m.baseline = {pair.amplitude_v, pair.offset_sin_v, pair.offset_cos_v, 0};
  m.noise_rms_v = pair.noise_rms_v;
  m.effects = {effect_instance("amplitude-mismatch", {pair.k}, {}),
               effect_instance("quadrature-error", {pair.delta_rad * kDegPerRad}, {})};
  return m;
}

/// What drifts, as functions of time, on top of the sensor.
struct Drift {
  std::function<double(double)> sin_v = [](double) { return 0.0; };
  std::function<double(double)> cos_v = [](double) { return 0.0; };
  std::function<double(double)> k = [](double) { return 0.0; };
  std::function<double(double)> delta = [](double) { return 0.0; };
  std::function<double(double)> gain = [](double) { return 1.0; };
};

Drift ramp(double sin_v_per_s, double cos_v_per_s) {
  Drift d;
  d.sin_v = [=](double t) { return sin_v_per_s * t; };
  d.cos_v = [=](double t) { return cos_v_per_s * t; };
  return d;
}

Capture drifting(const SensorPair &pair, const Motion &motion, double rate_hz, double duration_s,
                 const Drift &drift, std::uint64_t seed) {
  Capture c;
  c.meta.periods_per_turn = pair.periods;
  SensorPair now = pair;
  Sampler noise(pair, seed);
  const auto n = static_cast<std::size_t>(std::lround(rate_hz * duration_s));
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / rate_hz;
    now.offset_sin_v = pair.offset_sin_v + drift.sin_v(t);
    now.offset_cos_v = pair.offset_cos_v + drift.cos_v(t);
    now.k = pair.k + drift.k(t);
    now.delta_rad = pair.delta_rad + drift.delta(t);
    now.amplitude_v = pair.amplitude_v * drift.gain(t);
    double s, k;
    Sampler(now, 0).pair_at(motion(t), pair.vtemp_reference_v, s, k);
    c.time_s.push_back(t);
    c.vsin_v.push_back(noise.convert(s));
    c.vcos_v.push_back(noise.convert(k));
    c.reference_deg.push_back(motion(t) * kDegPerRad);
  }
  return c;
}

std::vector<Frame> frames_of(const Capture &c) {
  std::vector<Frame> frames;
  for (std::size_t i = 0; i < c.size(); ++i) {
    Frame f = empty_frame();
    f.time_s = c.time_s[i];
    f.vsin_v = c.vsin_v[i];
    f.vcos_v = c.vcos_v[i];
    frames.push_back(f);
  }
  return frames;
}

std::vector<ada4571_angle> tracked(const Model &model, const Capture &c,
                                   const TrackerOptions &options = {}) {
  const std::vector<Frame> frames = frames_of(c);
  std::vector<ada4571_angle> angles(frames.size());
  Tracker(model, options).frames(frames, angles);
  return angles;
}

std::vector<ada4571_angle> stored(const Model &model, const Capture &c) {
  std::vector<ada4571_angle> angles(c.size());
  FrameConverter(model).capture(c, angles);
  return angles;
}

class TrackerTest : public testing::Test {
protected:
  std::uint64_t seed = fresh_seed();
  SensorPair pair;
  Model model = stored_model(pair);

  /// Never worse than what is stored, but for the noise of the estimates themselves: a fiftieth of
  /// the floor that the noise of the samples sets.
  void expect_no_worse(const Capture &c, const TrackerOptions &options = {}) {
    const double with = rms_error_deg(tracked(model, c, options), c);
    const double without = rms_error_deg(stored(model, c), c);
    std::printf("  tracked %.5f, stored %.5f deg rms\n", with, without);
    EXPECT_LT(with, 1.005 * without + 0.0002);
  }
};

TEST_F(TrackerTest, offsets_that_drift_by_4_mv_a_second_are_followed) {
  for (const double turns_per_s : {1.0, 10.0, 60.0})
    for (const auto &[s, k] : {std::pair{0.004, -0.004}, std::pair{-0.004, 0.0}}) {
      const Capture c =
          drifting(pair, swinging_speed(turns_per_s, 0.3, 0.4), 10000, 20, ramp(s, k), seed);
      const double with = rms_error_deg(tracked(model, c), c);
      const double without = rms_error_deg(stored(model, c), c);
      std::printf("  %g turns/s: tracked %.5f, stored %.5f deg rms\n", turns_per_s, with, without);
      EXPECT_LT(with, 0.02);
      EXPECT_GT(without, 0.3);
    }
}

TEST_F(TrackerTest, a_constant_drift_leaves_no_lag) {
  // Mean offset error over the second half, where any lag would show as a constant.
  const Capture c = drifting(pair, constant_speed(8), 10000, 30, ramp(0.004, -0.003), seed);
  const std::vector<Frame> frames = frames_of(c);
  std::vector<ada4571_angle> angles(frames.size());
  Tracker tracker(model, {});
  double sum_sin = 0, sum_cos = 0, n = 0;
  for (std::size_t i = 0; i < frames.size(); i += 500) {
    tracker.frames({frames.data() + i, 500}, {angles.data() + i, 500});
    const double t = frames[i + 499].time_s;
    if (t < 15)
      continue;
    const Model now = tracker.model();
    sum_sin += now.baseline.offset_sin_v - (pair.offset_sin_v + 0.004 * t);
    sum_cos += now.baseline.offset_cos_v - (pair.offset_cos_v - 0.003 * t);
    n += 1;
  }
  // One turn of lag would be 0.125 s * 4 mV/s = 0.5 mV.
  EXPECT_NEAR(sum_sin / n, 0, 2e-5);
  EXPECT_NEAR(sum_cos / n, 0, 2e-5);
}

TEST_F(TrackerTest, amplitude_and_phase_are_followed_where_wanted) {
  Drift d;
  d.k = [](double t) { return 0.0008 * t; };
  d.delta = [](double t) { return 0.0006 * t; };
  d.gain = [](double t) { return 1 - 0.003 * t; };
  const Capture c = drifting(pair, constant_speed(12), 10000, 20, d, seed);
  TrackerOptions both{.track_amplitude = true, .track_phase = true};
  const auto angles = tracked(model, c, both);
  EXPECT_LT(rms_error_deg(angles, c), 0.02);
  EXPECT_GT(rms_error_deg(stored(model, c), c), 0.1);
  EXPECT_NEAR(angles.back().radius, 1, 0.003);
  const auto alone = tracked(model, c);
  EXPECT_GT(std::abs(alone.back().radius - 1), 0.05); // not wanted, not followed
}

TEST_F(TrackerTest, stored_calibration_is_in_force_from_the_first_sample) {
  const Capture c = drifting(pair, constant_speed(3), 1000, 0.2, {}, seed);
  const auto with = tracked(model, c), without = stored(model, c);
  for (std::size_t i = 0; i < c.size(); ++i)
    EXPECT_EQ(with[i].angle_deg, without[i].angle_deg) << i; // less than a turn teaches nothing
}

TEST_F(TrackerTest, steady_turning_is_no_worse) {
  for (const double turns_per_s : {0.2, 5.0, 70.0})
    expect_no_worse(drifting(pair, constant_speed(turns_per_s), 10000, 15, {}, seed));
}

TEST_F(TrackerTest, standstill_is_no_worse) {
  expect_no_worse(drifting(pair, constant_speed(0), 1000, 30, {}, seed));
  const Motion then_turning = [](double t) { return 0.7 + kTwoPi * std::max(t - 10, 0.0) * 2; };
  expect_no_worse(drifting(pair, then_turning, 1000, 20, {}, seed));
  // Drifting all the time, at rest from second 5 to 15.
  const Motion pause = [](double t) {
    return kTwoPi * 4 * (std::min(t, 5.0) + std::max(t - 15, 0.0));
  };
  expect_no_worse(drifting(pair, pause, 5000, 25, ramp(0.004, 0.002), seed));
  // A drift that ends as soon as the magnet stops.
  Drift ends;
  ends.sin_v = [](double t) { return 0.004 * std::min(t, 5.0); };
  expect_no_worse(drifting(pair, pause, 5000, 25, ends, seed));
}

TEST_F(TrackerTest, reversals_are_no_worse) {
  const Motion swing = [](double t) { return 0.45 * kTwoPi * std::sin(kTwoPi * 0.7 * t); };
  expect_no_worse(drifting(pair, swing, 5000, 20, {}, seed)); // never a whole turn
  const Motion wide = [](double t) { return 2.3 * kTwoPi * std::sin(kTwoPi * 0.2 * t); };
  expect_no_worse(drifting(pair, wide, 5000, 20, {}, seed));
  expect_no_worse(drifting(pair, wide, 5000, 20, ramp(0.004, -0.004), seed));
}

TEST_F(TrackerTest, slow_turning_is_no_worse) {
  for (const double electrical_hz : {0.05, 0.3, 0.9}) {
    expect_no_worse(drifting(pair, constant_speed(electrical_hz / 2), 1000, 60, {}, seed));
    expect_no_worse(
        drifting(pair, constant_speed(electrical_hz / 2), 1000, 60, ramp(0.001, 0.001), seed));
  }
}

TEST_F(TrackerTest, spikes_are_no_worse) {
  Capture c = drifting(pair, constant_speed(9), 10000, 10, {}, seed);
  Sampler spike(pair, seed + 1);
  for (std::size_t i = 0; i < c.size(); ++i)
    if (spike.uniform(0, 1) < 0.01)
      (i % 2 ? c.vsin_v : c.vcos_v)[i] += spike.noise(0.5);
  expect_no_worse(c);
}

TEST_F(TrackerTest, gaps_are_no_worse) {
  Capture c = drifting(pair, constant_speed(9), 10000, 10, {}, seed);
  Sampler draw(pair, seed + 1);
  Capture holes = c;
  for (auto *column : {&holes.time_s, &holes.vsin_v, &holes.vcos_v, &holes.reference_deg})
    column->clear();
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (draw.uniform(0, 1) < 0.0005)
      i += static_cast<std::size_t>(draw.uniform(1, 3000));
    if (i >= c.size())
      break;
    holes.time_s.push_back(c.time_s[i]);
    holes.vsin_v.push_back(c.vsin_v[i]);
    holes.vcos_v.push_back(c.vcos_v[i]);
    holes.reference_deg.push_back(c.reference_deg[i]);
  }
  ASSERT_LT(holes.size(), c.size());
  expect_no_worse(holes);
}

TEST_F(TrackerTest, a_stray_field_does_not_move_the_offsets) {
  pair.stray = 0.01;
  const Capture c = drifting(pair, constant_speed(5), 10000, 10, {}, seed);
  const std::vector<Frame> frames = frames_of(c);
  std::vector<ada4571_angle> angles(frames.size());
  Tracker tracker(model, {});
  tracker.frames(frames, angles);
  // A single electrical period would see 0.6 % of the amplitude, 9 mV.
  EXPECT_NEAR(tracker.model().baseline.offset_sin_v, pair.offset_sin_v, 2e-4);
  EXPECT_NEAR(tracker.model().baseline.offset_cos_v, pair.offset_cos_v, 2e-4);
}

TEST_F(TrackerTest, a_wrong_stored_offset_is_put_right_within_two_turns) {
  model.baseline.offset_sin_v += 0.02;
  const Capture c = drifting(pair, constant_speed(5), 10000, 2, {}, seed);
  const auto angles = tracked(model, c);
  EXPECT_GT(rms_error_deg(angles, c, false, 0, 1900), 0.2);
  EXPECT_LT(rms_error_deg(angles, c, false, 4100), 0.0115);
}

TEST_F(TrackerTest, a_broken_wire_teaches_nothing) {
  Capture c = drifting(pair, constant_speed(5), 5000, 10, {}, seed);
  for (std::size_t i = 15000; i < 35000; ++i)
    c.vsin_v[i] = 2.5; // stuck in the middle for four seconds
  const auto with = tracked(model, c), without = stored(model, c);
  EXPECT_LT(rms_error_deg(with, c, false, 35000), 1.02 * rms_error_deg(without, c, false, 35000));
}

TEST_F(TrackerTest, a_sample_allocates_nothing) {
  const std::vector<Frame> frames =
      frames_of(drifting(pair, constant_speed(9), 10000, 2, ramp(0.004, 0), seed));
  std::vector<ada4571_angle> angles(frames.size());
  Tracker tracker(model, {.track_amplitude = true, .track_phase = true});
  allocations = 0;
  counting = true;
  tracker.frames(frames, angles);
  counting = false;
  EXPECT_EQ(allocations, 0u);
}

TEST_F(TrackerTest, numbers_that_are_none_are_survived) {
  std::vector<Frame> frames =
      frames_of(drifting(pair, constant_speed(9), 10000, 2, ramp(0.004, 0), seed));
  for (std::size_t i = 100; i < frames.size(); i += 37) {
    double *fields[] = {&frames[i].vsin_v, &frames[i].vcos_v, &frames[i].time_s};
    *fields[i % 3] = i % 2 ? NAN : INFINITY;
  }
  std::vector<ada4571_angle> angles(frames.size());
  Tracker tracker(model, {});
  tracker.frames(frames, angles);
  EXPECT_TRUE(std::isfinite(angles.back().angle_deg));
  EXPECT_TRUE(std::isfinite(tracker.model().baseline.offset_sin_v));
}

TEST_F(TrackerTest, refuses_what_it_cannot_follow) {
  EXPECT_THROW(Tracker(model, {.max_offset_rate_v_per_s = 0}), Error);
  EXPECT_THROW(Tracker(model, {.max_offset_rate_v_per_s = NAN}), Error);
  model.effects.push_back(effect_instance("weak-field", {0.01}, {}));
  EXPECT_THROW(Tracker(model, {}), Error);
}

} // namespace
} // namespace ada::test

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Benches on which a cause shows by the speed, the time or the temperature, beside much that
// repeats with the angle.

#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "conversion/frame_converter.h"
#include "diagnosis/bench.h"

namespace ada::test {
namespace {

using Shaft = std::function<double(double)>;

/// A shaft that turns at several speeds, in turns a second, for as long each.
Shaft at_speeds(std::vector<double> hz, double each_s) {
  return [=](double t) {
    double turns = 0.0;
    for (double speed : hz) {
      turns += speed * std::min(std::max(t, 0.0), each_s);
      t -= each_s;
    }
    return kTwoPi * turns;
  };
}

/// VCOS as it is so much later.
void sample_later(Capture &c, const Pair &pair, const Shaft &magnet, double late_s) {
  for (std::size_t i = 0; i < c.size(); ++i) {
    const auto cosine = [&](double t) {
      return pair.amplitude_v * (1.0 - 0.5 * pair.k) *
             std::cos(c.meta.periods_per_turn * magnet(t) + pair.zero_rad - 0.5 * pair.delta_rad);
    };
    c.vcos_v[i] += cosine(c.time_s[i] + late_s) - cosine(c.time_s[i]);
  }
}

/// Speeds in one direction or both, as a test bench drives them.
std::vector<double> some_speeds(Bench &bench) {
  const double slow = bench.within(3.0, 6.0), fast = bench.within(10.0, 14.0);
  switch (static_cast<int>(bench.within(0.0, 3.0))) {
  case 0:
    return {slow, fast};
  case 1:
    return {fast, slow};
  default:
    return {slow, fast, -0.8 * fast};
  }
}

/// At the turns its acceleration is the largest, and is no noise of the angle behind which the way
/// back would begin unseen.
KIND(a_lever_that_swings_shows_its_hysteresis_and_no_delay) {
  Bench bench;
  const double swing_rad = bench.within(120.0, 170.0) * kRadPerDeg, hz = bench.within(0.3, 0.8),
               falls = bench.within(0.02, 0.06), width = bench.within(0.2, 0.8) * kRadPerDeg;
  const auto angle = [&](double t) {
    return 3.0 + swing_rad * std::exp(-falls * t) * std::cos(kTwoPi * hz * t);
  };
  const auto behind = [&](double t) {
    return angle(t) - 0.5 * std::copysign(width, angle(t + 1e-6) - angle(t - 1e-6));
  };
  Capture c = bench.capture(6000, 250.0, 2, behind);
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(angle(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "hysteresis");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0] * kRadPerDeg, width, 0.02 * width);
  EXPECT_EQ(d.findings.size(), 3u) << left_of(d);
  EXPECT_EQ(d.verdict, Verdict::explained) << left_of(d);
}

KIND(a_skew_beside_a_large_quadrature_error_and_a_stray_field_is_named) {
  Bench bench;
  const double late_s = bench.within(8e-6, 16e-6), stray = bench.within(0.005, 0.015),
               direction = bench.within(0.0, kTwoPi);
  const std::vector<double> speeds = some_speeds(bench);
  const Shaft shaft = at_speeds(speeds, 3.0 / static_cast<double>(speeds.size()));
  const Shaft field = [&](double t) {
    const double a = shaft(t);
    return a + std::atan2(stray * std::sin(direction - a), 1.0 + stray * std::cos(direction - a));
  };
  Capture c = bench.capture(15000, 5000.0, 2, field);
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
  sample_later(c, bench.pair, field, late_s);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "channel-skew");
  ASSERT_TRUE(f && named(d, "stray-field")) << names(d);
  EXPECT_NEAR(f->values[0], late_s, 0.1 * late_s);
  EXPECT_EQ(d.verdict, Verdict::explained) << names(d);
}

/// A capture at two speeds that are nearly the same.
Diagnosis at_near_speeds(Bench &bench, double apart, double late_s) {
  const double hz = bench.within(4.0, 8.0);
  const Shaft shaft = at_speeds({hz, hz * (1.0 + apart), hz, hz * (1.0 + apart)}, 2.0);
  Capture c = bench.capture(16000, 2000.0, 2, shaft);
  sample_later(c, bench.pair, shaft, late_s);
  return diagnose(c, {});
}

KIND(a_skew_is_told_from_a_quadrature_error_at_speeds_a_tenth_apart) {
  Bench bench;
  const double apart = bench.within(0.08, 0.15), late_s = bench.within(1e-4, 2e-4);
  const Diagnosis d = at_near_speeds(bench, apart, late_s);
  const Finding *delta = named(d, "quadrature-error"), *f = named(d, "channel-skew");
  ASSERT_TRUE(f && delta) << names(d);
  EXPECT_NEAR(f->values[0], late_s, 4.0 * f->std_errors[0]);
  EXPECT_NEAR(delta->values[0], bench.pair.delta_rad * kDegPerRad, 4.0 * delta->std_errors[0]);
  EXPECT_EQ(d.verdict, Verdict::explained) << names(d);
}

KIND(what_hangs_on_a_skew_that_is_not_told_has_an_error_that_says_so) {
  Bench bench;
  const double apart = bench.within(0.003, 0.015), late_s = bench.within(3e-5, 1e-4);
  const Diagnosis d = at_near_speeds(bench, apart, late_s);
  const Finding *delta = named(d, "quadrature-error");
  ASSERT_TRUE(delta) << names(d);
  if (named(d, "channel-skew"))
    return; // told apart after all
  EXPECT_TRUE(std::count(delta->alternatives.begin(), delta->alternatives.end(), "channel-skew"))
      << names(d);
  EXPECT_NEAR(delta->values[0], bench.pair.delta_rad * kDegPerRad, 4.0 * delta->std_errors[0]);
  // And says no more than that: it would not otherwise be told that there is one at all.
  EXPECT_LT(delta->std_errors[0], 1.0) << names(d);
}

/// A shaft that swings slowly to and fro, and back again before it came from.
Shaft swinging(Bench &bench) {
  const double wide = bench.within(1.5, 4.0), hz = bench.within(0.1, 0.2),
               other = hz * bench.within(1.5, 2.5), start = bench.within(0.0, kTwoPi);
  return [=](double t) {
    return wide * (std::sin(kTwoPi * hz * t + start) + 0.5 * std::sin(kTwoPi * other * t));
  };
}

/// The diagnosis of a pair whose field trails the shaft, as `field` makes it of the shaft's angles.
Diagnosis
of_trailing(Bench &bench, const Shaft &shaft,
            const std::function<std::vector<double>(const std::vector<double> &)> &field) {
  constexpr double kRate = 500.0;
  std::vector<double> angle;
  for (int i = 0; i < 20000; ++i)
    angle.push_back(shaft(i / kRate));
  const std::vector<double> trailing = field(angle);
  Capture c = bench.capture(angle.size(), kRate, 2, [&](double t) {
    return trailing[static_cast<std::size_t>(std::lround(t * kRate))];
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(angle[i] * kDegPerRad, 360.0);
  return diagnose(c, {});
}

KIND(a_hysteresis_that_crosses_its_loop_with_the_way_is_a_play) {
  Bench bench;
  const double width = bench.within(0.15, 0.4) * kRadPerDeg;
  const Diagnosis d = of_trailing(bench, swinging(bench), [&](const std::vector<double> &angle) {
    std::vector<double> out;
    double held = angle.front();
    for (double a : angle)
      out.push_back(held = std::clamp(held, a - 0.5 * width, a + 0.5 * width));
    return out;
  });
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "hysteresis");
  ASSERT_TRUE(f) << names(d);
  EXPECT_EQ(f->values[1], 1.0) << names(d);
  EXPECT_NEAR(f->values[0] * kRadPerDeg, width, 4.0 * f->std_errors[0] * kRadPerDeg) << names(d);
  EXPECT_EQ(d.verdict, Verdict::explained) << names(d);
}

KIND(a_hysteresis_that_changes_over_at_once_is_none) {
  Bench bench;
  const double width = bench.within(0.15, 0.4) * kRadPerDeg;
  const Diagnosis d = of_trailing(bench, swinging(bench), [&](const std::vector<double> &angle) {
    std::vector<double> out;
    for (std::size_t i = 0; i < angle.size(); ++i) {
      const std::size_t to = std::max<std::size_t>(i, 1);
      out.push_back(angle[i] - std::copysign(0.5 * width, angle[to] - angle[to - 1]));
    }
    return out;
  });
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "hysteresis");
  ASSERT_TRUE(f) << names(d);
  EXPECT_TRUE(std::isnan(f->values[1])) << names(d);
  EXPECT_NEAR(f->values[0] * kRadPerDeg, width, 4.0 * f->std_errors[0] * kRadPerDeg) << names(d);
}

/// A shaft that comes to a tenth to a half of its speed, or runs up to it.
struct RunDown {
  double hz, tau_s, span_s;
  bool up;
  explicit RunDown(Bench &bench)
      : hz(bench.within(8.0, 14.0)), tau_s(0.0), span_s(bench.within(8.0, 12.0)),
        up(bench.within(0.0, 1.0) < 0.5) {
    tau_s = span_s / bench.within(1.0, 1.8);
  }
  double at(double t) const { return up ? span_s - t : t; }
  double speed(double t) const { return kTwoPi * hz * std::exp(-at(t) / tau_s); }
  double angle(double t) const {
    const double gone = kTwoPi * hz * tau_s * (1.0 - std::exp(-at(t) / tau_s));
    return up ? -gone : gone;
  }
};

KIND(what_stays_as_a_shaft_runs_down_is_the_sensors) {
  Bench bench;
  const RunDown run(bench);
  const double off = bench.within(0.2, 1.2) * kRadPerDeg, along = bench.within(0.0, kTwoPi);
  const bool field = bench.within(0.0, 1.0) < 0.5;
  const double stray = field ? bench.within(0.004, 0.02) : 0.0;
  Capture c =
      bench.capture(static_cast<std::size_t>(2000.0 * run.span_s), 2000.0, 2, [&](double t) {
        const double a = run.angle(t);
        const double x = std::cos(a) + stray, y = std::sin(a);
        const double u = (1.0 - off) * (x * std::cos(along) + y * std::sin(along)),
                     v = (1.0 + off) * (y * std::cos(along) - x * std::sin(along));
        return a + wrap_centred(std::atan2(v, u) + along - a, kTwoPi);
      });
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "sensor-off-axis");
  ASSERT_TRUE(f) << names(d);
  EXPECT_NEAR(f->values[0] * kRadPerDeg, off, 0.02 * off);
  EXPECT_EQ(named(d, "stray-field") != nullptr, field) << names(d);
  EXPECT_FALSE(named(d, "rotation-nonuniformity")) << names(d);
  EXPECT_EQ(d.verdict, Verdict::explained) << names(d);
}

KIND(what_falls_with_the_square_of_the_speed_is_the_shafts) {
  Bench bench;
  const RunDown run(bench);
  const double order = std::floor(bench.within(1.0, 4.0)),
               ripple = bench.within(0.3, 1.5) / order * kRadPerDeg,
               start = bench.within(0.0, kTwoPi), slowest = run.speed(run.up ? 0.0 : run.span_s);
  Capture c =
      bench.capture(static_cast<std::size_t>(2000.0 * run.span_s), 2000.0, 2, [&](double t) {
        const double a = run.angle(t), falls = std::pow(slowest / run.speed(t), 2);
        return a + ripple * falls * std::sin(order * a + start);
      });
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "rotation-nonuniformity");
  ASSERT_TRUE(f) << names(d);
  EXPECT_EQ(f->values[0], order);
  // Of what it is at another speed than the slowest.
  const double there = std::pow(slowest / (f->values[3] * kTwoPi / 60.0), 2);
  EXPECT_NEAR(f->values[1] * kRadPerDeg, ripple * there, 0.05 * ripple * there) << names(d);
  EXPECT_TRUE(f->alternatives.empty()) << f->alternatives.front();
  for (const char *of_the_sensor : {"stray-field", "sensor-off-axis", "field-direction-error"})
    EXPECT_FALSE(named(d, of_the_sensor)) << names(d);
}

KIND(a_chipped_magnet_hides_no_skew) {
  Bench bench;
  const double late_s = bench.within(6e-6, 12e-6), chip = bench.within(0.0, kTwoPi),
               width = bench.within(0.1, 0.2), depth = bench.within(0.01, 0.03);
  const Shaft shaft = at_speeds({bench.within(1.0, 2.0), 10.0, -10.0}, 2.0);
  Capture c = bench.capture(60000, 10000.0, 2, shaft);
  sample_later(c, bench.pair, shaft, late_s);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double off = wrap_centred(shaft(c.time_s[i]) - chip, kTwoPi) / width;
    const double length = 1.0 - depth * std::exp(-0.5 * off * off);
    c.vsin_v[i] = 2.5 + length * (c.vsin_v[i] - 2.5);
    c.vcos_v[i] = 2.5 + length * (c.vcos_v[i] - 2.5);
  }
  const Diagnosis d = diagnose(c, {});
  // What a chip holds of a mismatch and of a quadrature error.
  expect_pair(d, bench.pair, depth * width);
  const Finding *f = named(d, "channel-skew");
  ASSERT_TRUE(f) << names(d);
  EXPECT_NEAR(f->values[0], late_s, 0.1 * late_s);
  EXPECT_FALSE(named(d, "flicker-noise")) << names(d);
  EXPECT_EQ(d.verdict, Verdict::partly_explained);
}

KIND(the_magnet_of_another_shaft_is_no_error_of_the_reference) {
  Bench bench;
  const double ratio = bench.within(1.2, 1.45), part = bench.within(0.01, 0.03);
  const Shaft shaft = at_speeds({bench.within(2.0, 3.5), bench.within(5.0, 6.5), 8.0}, 1.1);
  Capture c = bench.capture(13200, 4000.0, 1, shaft);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double other = ratio * shaft(c.time_s[i]) + 1.0;
    c.vsin_v[i] += part * bench.pair.amplitude_v * std::sin(other);
    c.vcos_v[i] += part * bench.pair.amplitude_v * std::cos(other);
  }
  const Diagnosis d = diagnose(c, {});
  EXPECT_FALSE(named(d, "reference-harmonic")) << names(d);
  // Nothing of the catalogue has it.
  EXPECT_NE(d.verdict, Verdict::explained) << names(d);
  EXPECT_NE(d.verdict, Verdict::no_discrepancy) << names(d);
}

KIND(a_hysteresis_is_seen_with_long_rests_and_a_noisy_reference) {
  Bench bench;
  const double width = bench.within(0.15, 0.4) * kRadPerDeg, rest_s = bench.within(0.2, 0.5);
  // Some turns there and back, with a rest after each way.
  const double way_s = 1.0, hz = bench.within(2.0, 4.0);
  const auto way_at = [=](double t) { return static_cast<int>(t / (way_s + rest_s)); };
  const Shaft shaft = [=](double t) {
    const int way = way_at(t);
    const double moved = std::min(t - way * (way_s + rest_s), way_s) * hz * kTwoPi;
    return way % 2 == 0 ? moved : way_s * hz * kTwoPi - moved;
  };
  const Shaft field = [&](double t) {
    return shaft(t) - 0.5 * width * (way_at(t) % 2 == 0 ? 1.0 : -1.0);
  };
  Capture c = bench.capture(24000, 4000.0, 2, field);
  std::mt19937_64 rng(fresh_seed());
  std::normal_distribution<> noise(0.0, 0.002);
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad + noise(rng), 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "hysteresis");
  ASSERT_TRUE(f) << names(d);
  EXPECT_NEAR(f->values[0] * kRadPerDeg, width, 0.05 * width);
  EXPECT_FALSE(named(d, "propagation-delay")) << names(d);
}

KIND(two_temperatures_in_one_record_are_a_drift_and_no_step) {
  Bench bench;
  const double tc_sin = bench.within(0.01, 0.03), tc_cos = -bench.within(0.01, 0.03);
  const double cold_v = bench.within(1.0, 1.3), hot_v = cold_v + bench.within(0.15, 0.4);
  Capture c = bench.capture(8000, 400.0, 2, wandering(bench, 1.5, 0.3, 0.11));
  if (bench.within(0.0, 1.0) < 0.5)
    c.reference_deg.clear();
  std::mt19937_64 rng(fresh_seed());
  std::normal_distribution<> noise(0.0, 3e-4);
  const double mean = 0.5 * (cold_v + hot_v);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double v = i < c.size() / 2 ? cold_v : hot_v;
    c.vtemp_v.push_back(v + noise(rng));
    c.vsin_v[i] += tc_sin * (v - mean);
    c.vcos_v[i] += tc_cos * (v - mean);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "offset-temperature-drift");
  ASSERT_TRUE(f) << names(d);
  EXPECT_NEAR(f->values[0], tc_sin, 0.05 * tc_sin);
  EXPECT_NEAR(f->values[1], tc_cos, 0.05 * std::abs(tc_cos));
  EXPECT_FALSE(named(d, "offset-step")) << names(d);
}

KIND(an_amplitude_that_droops_leaves_the_axes_of_the_ellipse) {
  Bench bench;
  const double droop = bench.within(0.05, 0.15);
  const Shaft shaft = at_speeds({bench.within(3.0, 6.0), bench.within(7.0, 10.0)}, 5.0);
  Capture c = bench.capture(20000, 2000.0, 1, shaft);
  c.reference_deg.clear();
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double length = 1.0 - droop * c.time_s[i] / c.time_s.back();
    c.vsin_v[i] = 2.5 + length * (c.vsin_v[i] - 2.5);
    c.vcos_v[i] = 2.5 + length * (c.vcos_v[i] - 2.5);
  }
  // Without the droop both are known to a thousandth of a radian.
  expect_pair(diagnose(c, {}), bench.pair, 1e-3);
}

KIND(the_lines_of_a_disc_are_its_own_error_at_an_even_spin) {
  Bench bench;
  const double order = std::floor(bench.within(24.0, 60.0)), e_deg = bench.within(0.02, 0.06);
  const double hz = bench.within(3.0, 6.0), phase = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(40000, 10000.0, 2, [&](double t) { return kTwoPi * hz * t; });
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double a = kTwoPi * hz * c.time_s[i];
    c.reference_deg[i] = wrap(a * kDegPerRad + e_deg * std::sin(order * a + phase), 360.0);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "reference-harmonic");
  ASSERT_TRUE(f) << names(d);
  EXPECT_EQ(f->values[0], order);
  EXPECT_NEAR(f->values[1], e_deg, 0.05 * e_deg);
  EXPECT_FALSE(named(d, "field-direction-error")) << names(d);
}

/// Both outputs of a capture at a supply of `level` that goes up and down by `ripple`, and its
/// record.
void feed(Capture &c, double level, double ripple, double hz, double phase) {
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double vdd = level * (1.0 + ripple * std::sin(kTwoPi * hz * c.time_s[i] + phase));
    c.vsin_v[i] *= vdd / 5.0;
    c.vcos_v[i] *= vdd / 5.0;
    c.vdd_v.push_back(vdd);
  }
}

/// RMS error against the shaft, mechanical degrees, a constant angle aside.
double angle_error(const Capture &c, const std::vector<ada4571_angle> &angles) {
  std::vector<double> error;
  double sum = 0.0;
  const double first = angles[0].angle_deg - c.reference_deg[0];
  for (std::size_t i = 0; i < c.size(); ++i) {
    error.push_back(wrap_centred(angles[i].angle_deg - c.reference_deg[i] - first,
                                 360.0 / c.meta.periods_per_turn));
    sum += error.back();
  }
  const double mean = sum / static_cast<double>(error.size());
  sum = 0.0;
  for (double e : error)
    sum += (e - mean) * (e - mean);
  return std::sqrt(sum / static_cast<double>(error.size()));
}

KIND(a_model_learnt_at_one_supply_serves_at_another_that_is_recorded) {
  Bench bench;
  const Shaft shaft = at_speeds({bench.within(1.0, 2.0), bench.within(3.0, 5.0)}, 4.0);
  const double hz = bench.within(1.0, 8.0), ripple = bench.within(0.003, 0.01);
  const double one = bench.within(4.7, 5.3), other = bench.within(4.7, 5.3);
  Capture learnt = bench.capture(20000, 2500.0, 2, shaft);
  feed(learnt, one, ripple, hz, bench.within(0.0, kTwoPi));
  const Diagnosis d = diagnose(learnt, {});
  ASSERT_TRUE(named(d, "supply-variation")) << names(d);
  // One that stays where it is says as much as one that moves.
  for (const double moves : {0.0, ripple}) {
    Capture served = bench.capture(20000, 2500.0, 2, shaft);
    feed(served, other, moves, hz, bench.within(0.0, kTwoPi));
    const double noise_deg =
        bench.pair.noise_v * 5.0 / other / bench.pair.amplitude_v / 2.0 * kDegPerRad;
    std::vector<ada4571_angle> angles(served.size());
    FrameConverter(d.extended).capture(served, angles);
    EXPECT_LT(angle_error(served, angles), 1.1 * noise_deg + 0.002) << one << " V, " << other;
    FrameConverter live(d.extended);
    std::vector<Frame> frames;
    for (std::size_t i = 0; i < served.size(); ++i)
      frames.push_back(frame_at(served, i));
    live.frames(frames, angles);
    EXPECT_LT(angle_error(served, angles), 1.1 * noise_deg + 0.002) << one << " V, " << other;
  }
}

/// Output of a bridge whose stripes lie along `theta` and across it, in a field at `alpha`, h =
/// Hk/H: each stripe's magnetisation where the torques balance.
double bridge_output(double alpha, double theta, double h) {
  const auto stripe = [&](double easy) {
    double phi = alpha;
    for (int k = 0; k < 60; ++k) // contracts by h each time
      phi = alpha - std::asin(0.5 * h * std::sin(2.0 * (phi - easy)));
    return std::cos(2.0 * (phi - easy));
  };
  return 0.5 * (stripe(theta) - stripe(theta + 0.5 * kPi));
}

KIND(bridges_that_are_turned_in_a_weak_field_are_no_field_error) {
  Bench bench;
  const double q = bench.within(0.01, 0.035), h = std::sqrt(8.0 * q / 3.0);
  const Pair &p = bench.pair;
  const Shaft shaft = at_speeds({bench.within(1.0, 2.0), bench.within(3.0, 5.0)}, 4.0);
  const double none = bench.pair.amplitude_v;
  bench.pair.amplitude_v = 0.0;
  Capture c = bench.capture(20000, 2500.0, 2, shaft); // the noise alone
  bench.pair.amplitude_v = none;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double alpha = shaft(c.time_s[i]) + 0.5 * p.zero_rad, turned = 0.25 * p.delta_rad;
    c.vsin_v[i] += p.amplitude_v * (1.0 + 0.5 * p.k) * bridge_output(alpha + turned, 0.25 * kPi, h);
    c.vcos_v[i] += p.amplitude_v * (1.0 - 0.5 * p.k) * bridge_output(alpha - turned, 0.0, h);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, p);
  const Finding *f = named(d, "weak-field");
  ASSERT_TRUE(f) << names(d);
  EXPECT_NEAR(f->values[0], q, 0.01 * q);
  EXPECT_EQ(d.findings.size(), 3u) << names(d);
  EXPECT_EQ(d.verdict, Verdict::explained) << names(d);
}

KIND(a_sensor_that_vibrates_is_not_explained_by_flicker_noise) {
  Bench bench;
  const double hz = bench.within(60.0, 110.0), a_rad = bench.within(0.06, 0.12) * kRadPerDeg;
  const Shaft shaft = at_speeds({bench.within(4.0, 8.0), bench.within(9.0, 13.0)}, 2.0);
  Capture c = bench.capture(24000, 6000.0, 2,
                            [&](double t) { return shaft(t) + a_rad * std::sin(kTwoPi * hz * t); });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_NE(d.verdict, Verdict::explained) << names(d);
}

/// In a few turns a sawtooth of a coupling looks like steps in time. What repeats with the angle is
/// on its axis all the same, and the budget counts it there.
KIND(what_repeats_with_the_angle_is_counted_there_and_not_as_steps_in_time) {
  Bench bench;
  bench.pair.k = bench.within(0.01, 0.03);
  bench.pair.delta_rad = 0.0;
  const double turns = bench.within(3.0, 6.0), teeth = std::round(bench.within(3.0, 9.0)),
               saw = bench.within(0.1, 0.3) * kRadPerDeg;
  constexpr double kRows = 1500.0, kRate = 5000.0;
  Capture c = bench.capture(static_cast<std::size_t>(kRows), kRate, 2, [&](double t) {
    const double turn = turns * t * kRate / kRows;
    return kTwoPi * turn + saw * (teeth * turn - std::floor(teeth * turn) - 0.5);
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(360.0 * turns * static_cast<double>(i) / kRows, 360.0);
  const Diagnosis d = diagnose(c, {});
  ASSERT_FALSE(d.budget.empty());
  EXPECT_EQ(d.budget.front().axis, Axis::angle) << left_of(d);
  for (const BudgetLine &line : d.budget)
    if (line.axis == Axis::time) {
      EXPECT_LT(line.rms_v, 0.2 * d.budget.front().rms_v) << left_of(d);
    }
}

} // namespace
} // namespace ada::test

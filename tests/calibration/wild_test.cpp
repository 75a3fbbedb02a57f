// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A few wild samples never decide: no method moves by a standard error, whatever their size, place
// and the speed.

#include <array>
#include <cmath>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "base/error.h"
#include "calibration/dual.h"
#include "calibration/ellipse_fit.h"
#include "calibration/pair_estimate.h"
#include "model/effect.h"
#include "support/seed.h"
#include "support/sensor_pair.h"
#include "support/wild.h"

namespace ada::test {
namespace {

constexpr double kRate = 10000, kDuration = 7;

std::array<double, kEllipseSize> values(const PairEstimate &e) {
  return {e.value.amplitude_v, e.value.k, e.value.delta_rad, e.value.centre_sin_v,
          e.value.centre_cos_v};
}

SensorPair plain_pair() {
  SensorPair pair;
  pair.k = 0.009;
  pair.delta_rad = 0.35 * kRadPerDeg;
  return pair;
}

/// Turns so many times a second, and one turn at least.
Motion turning(double rpm) {
  return swinging_speed(std::max(rpm / 60, 1.1 / kDuration), 0.3, 0.61);
}

class Wild : public testing::TestWithParam<std::tuple<CalibrationMethod, std::size_t, double>> {};

TEST_P(Wild, samples_do_not_move_a_calibration_by_a_standard_error) {
  const auto [method, count, rpm] = GetParam();
  const std::uint64_t seed = fresh_seed();
  Sampler sampler(plain_pair(), seed);
  const Capture clean = sampler.capture(kRate, kDuration, turning(rpm));
  const PairEstimate before = estimate_pair(clean, method);
  std::mt19937_64 rng(seed);
  for (int draw = 0; draw < 2; ++draw) {
    Capture struck = clean;
    add_wild(struck, count, rng);
    const PairEstimate after = estimate_pair(struck, method);
    EXPECT_EQ(after.has_mismatch, before.has_mismatch);
    for (std::size_t i = 0; i < kEllipseSize; ++i)
      EXPECT_LE(std::abs(values(after)[i] - values(before)[i]), before.std_error[i])
          << "parameter " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, Wild,
                         testing::Combine(testing::Values(CalibrationMethod::fit,
                                                          CalibrationMethod::mean,
                                                          CalibrationMethod::extrema),
                                          testing::Values(1u, 3u, 30u),
                                          testing::Values(6.0, 60.0, 600.0, 30000.0)),
                         [](const auto &i) {
                           return std::string(method_name(std::get<0>(i.param))) + "_" +
                                  std::to_string(std::get<1>(i.param)) + "_samples_at_" +
                                  std::to_string(static_cast<int>(std::get<2>(i.param))) + "_rpm";
                         });

/// Wild samples close together, at every speed that a fast capture has: the steps across them are
/// of half a period and more, and what stands between them has no neighbours to be judged by.
class WildNeighbours : public testing::TestWithParam<const char *> {};

TEST_P(WildNeighbours, do_not_tear_the_path) {
  const std::string pattern = GetParam(); // of samples: w is wild
  const std::uint64_t seed = fresh_seed();
  Sampler sampler(plain_pair(), seed);
  const Capture clean = sampler.capture(kRate, 3, turning(30000.0));
  for (const auto method : {CalibrationMethod::fit, CalibrationMethod::mean}) {
    const PairEstimate before = estimate_pair(clean, method);
    for (const double value : {1000.0, 2.5}) {
      Capture struck = clean;
      for (std::size_t i = 500; i + pattern.size() < struck.size(); i += 1999)
        for (std::size_t j = 0; j < pattern.size(); ++j)
          if (pattern[j] == 'w')
            struck.vsin_v[i + j] = struck.vcos_v[i + j] = value;
      const PairEstimate after = estimate_pair(struck, method);
      for (std::size_t i = 0; i < kEllipseSize; ++i)
        EXPECT_LE(std::abs(values(after)[i] - values(before)[i]), before.std_error[i])
            << method_name(method) << " parameter " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Patterns, WildNeighbours,
                         testing::Values("ww", "www", "wwww", "wow", "woow", "wowow", "woowow",
                                         "woowoow", "wwow", "woowww", "wooow"),
                         [](const auto &i) { return std::string(i.param); });

/// A sample that lies on the ellipse by chance, but elsewhere on it: nothing but its neighbours
/// tell that it is none of the path.
TEST(WildOnTheEllipse, samples_do_not_move_a_calibration_by_a_standard_error) {
  const std::uint64_t seed = fresh_seed();
  std::mt19937_64 rng(seed);
  Sampler sampler(plain_pair(), seed);
  for (const double rpm : {6.0, 60.0, 600.0, 30000.0}) {
    const Capture clean = sampler.capture(kRate, kDuration, turning(rpm));
    Capture struck = clean;
    std::uniform_int_distribution<std::size_t> anywhere(2, clean.size() - 3);
    for (int k = 0; k < 3; ++k) {
      const std::size_t at = anywhere(rng), from = anywhere(rng);
      struck.vsin_v[at] = clean.vsin_v[from];
      struck.vcos_v[at] = clean.vcos_v[from];
    }
    for (const auto method :
         {CalibrationMethod::fit, CalibrationMethod::mean, CalibrationMethod::extrema}) {
      const PairEstimate before = estimate_pair(clean, method);
      const PairEstimate after = estimate_pair(struck, method);
      for (std::size_t i = 0; i < kEllipseSize; ++i)
        EXPECT_LE(std::abs(values(after)[i] - values(before)[i]), before.std_error[i])
            << method_name(method) << " at " << rpm << " rpm, parameter " << i;
    }
  }
}

/// A contact that opens leaves rows of samples at one place, far from the circle. More of them than
/// any fence cuts off, and they pull a fit of all samples to where it finds no way back. Those that
/// happen to lie on the curve to within the fit's own limit nobody can tell from sound ones: they
/// stay, in both fits. Of one channel that stands they are hundreds where it stands at its centre,
/// about the other one's peak.
TEST(WildRows, at_a_rail_do_not_move_a_calibration) {
  const std::uint64_t seed = fresh_seed();
  Sampler sampler(plain_pair(), seed);
  for (int draw = 0; draw < 12; ++draw) {
    const Capture clean = sampler.capture(kRate, 2, turning(300.0));
    const EllipseFit sound = fit_ellipse(clean.vsin_v, clean.vcos_v);
    Capture struck = clean;
    const double share = sampler.uniform(0.005, 0.25); // of the record, in rows of 100 samples
    const bool both = sampler.uniform(0, 1) < 0.6;
    const double cos_v = sampler.uniform(-1, 6);
    double sin_v = sampler.uniform(-1, 6);
    // A place within the noise of the curve belongs to it, and pulls: not nearer than 0.1 V.
    const EllipseParameters &e = sound.value;
    const auto near = [&] {
      const double x = sin_v - e.centre_sin_v, y = both ? cos_v - e.centre_cos_v : 0.0;
      return std::abs(std::hypot(x, y) - e.amplitude_v) < 0.1;
    };
    while (near())
      sin_v = sampler.uniform(-1, 6);
    std::size_t wrong = 0;
    for (std::size_t row = 0; row + 100 < clean.size(); row += 100)
      if (sampler.uniform(0, 1) < share)
        for (std::size_t i = row; i < row + 100; ++i, ++wrong) {
          struck.vsin_v[i] = sin_v;
          if (both)
            struck.vcos_v[i] = cos_v;
        }
    const EllipseFit after = fit_ellipse(struck.vsin_v, struck.vcos_v);
    const EllipseInverse inverse = invert(e);
    std::vector<double> near_sin, near_cos;
    for (std::size_t i = 0; i < struck.size(); ++i) {
      const double radius = std::hypot(inverse.sine(struck.vsin_v[i], struck.vcos_v[i]),
                                       inverse.cosine(struck.vsin_v[i], struck.vcos_v[i]));
      if (std::abs(radius - 1) * e.amplitude_v <= sound.limit_v) {
        near_sin.push_back(struck.vsin_v[i]);
        near_cos.push_back(struck.vcos_v[i]);
      }
    }
    const EllipseFit before = fit_ellipse(near_sin, near_cos);
    // Those at the very limit are in one fit and not in the other.
    for (std::size_t i = 0; i < kEllipseSize; ++i) {
      const auto value = [&](const EllipseFit &fit) {
        return std::array{fit.value.amplitude_v, fit.value.k, fit.value.delta_rad,
                          fit.value.centre_sin_v, fit.value.centre_cos_v}[i];
      };
      EXPECT_LE(std::abs(value(after) - value(before)),
                3.0 * before.std_error(static_cast<EllipseIndex>(i)))
          << "parameter " << i << ", " << wrong << " rows at " << sin_v << (both ? " both " : " ")
          << cos_v;
    }
  }
}

TEST(WildDual, samples_of_every_channel_do_not_move_it) {
  const std::uint64_t seed = fresh_seed();
  std::mt19937_64 rng(seed);
  SensorPair pair = plain_pair();
  pair.tc_sin = 0.01;
  Sampler sampler(pair, seed);
  std::vector<Capture> clean, struck;
  for (const double deg_c : {0.0, 110.0}) {
    clean.push_back(sampler.capture(kRate, 3, turning(300), [=](double) { return deg_c; }));
    struck.push_back(clean.back());
    add_wild(struck.back(), 30, rng);
    struck.back().vtemp_v[1234] = -1e6;
    struck.back().vtemp_v[4321] = 1e6;
  }
  const Model a = calibrate_dual(clean[0], clean[1], CalibrationMethod::fit);
  const Model b = calibrate_dual(struck[0], struck[1], CalibrationMethod::fit);
  EXPECT_NEAR(b.baseline.offset_sin_v, a.baseline.offset_sin_v, a.baseline_std_error.offset_sin_v);
  EXPECT_NEAR(b.baseline.offset_cos_v, a.baseline.offset_cos_v, a.baseline_std_error.offset_cos_v);
  const auto drift = [](const Model &m) {
    for (const EffectInstance &e : m.effects)
      if (e.effect->info().id == "offset-temperature-drift")
        return e;
    throw std::runtime_error("no drift");
  };
  EXPECT_NEAR(drift(b).values[0], drift(a).values[0], drift(a).std_errors[0]);
  EXPECT_NEAR(b.vtemp_reference_v, a.vtemp_reference_v, 1e-6);
}

TEST(WildShort, one_sample_of_a_short_capture_does_not_decide) {
  const std::uint64_t seed = fresh_seed();
  std::mt19937_64 rng(seed);
  Sampler sampler(plain_pair(), seed);
  for (int draw = 0; draw < 20; ++draw) {
    const Capture clean = sampler.capture(100, 2.2, constant_speed(0.5));
    Capture struck = clean;
    add_wild(struck, 1, rng);
    const PairEstimate before = estimate_pair(clean, CalibrationMethod::fit);
    const PairEstimate after = estimate_pair(struck, CalibrationMethod::fit);
    for (std::size_t i = 0; i < kEllipseSize; ++i)
      EXPECT_LE(std::abs(values(after)[i] - values(before)[i]), before.std_error[i]) << i;
  }
}

TEST(Rotation, noise_is_refused_by_every_method) {
  const std::uint64_t seed = fresh_seed();
  Sampler sampler(plain_pair(), seed);
  for (const int shape : {0, 1}) {
    Capture noise = sampler.capture(kRate, 2, turning(60));
    for (std::size_t i = 0; i < noise.size(); ++i)
      for (auto *channel : {&noise.vsin_v, &noise.vcos_v})
        (*channel)[i] = shape == 0 ? sampler.uniform(0, 5) : 2.5 + sampler.noise(0.6);
    for (const auto method :
         {CalibrationMethod::fit, CalibrationMethod::mean, CalibrationMethod::extrema})
      try {
        estimate_pair(noise, method);
        ADD_FAILURE() << method_name(method);
      } catch (const Error &e) {
        EXPECT_NE(std::string(e.what()).find("draw no circle"), std::string::npos) << e.what();
      }
  }
}

TEST(Rotation, a_square_wave_is_refused) {
  Capture c = Sampler(plain_pair(), 1).capture(kRate, 2, turning(60));
  for (std::size_t i = 0; i < c.size(); ++i) {
    const std::size_t quarter = i / 7 % 4;
    c.vsin_v[i] = quarter < 2 ? 1.5 : 3.5;
    c.vcos_v[i] = quarter == 1 || quarter == 2 ? 1.5 : 3.5;
  }
  try {
    estimate_pair(c, CalibrationMethod::fit);
    ADD_FAILURE();
  } catch (const Error &e) {
    EXPECT_NE(std::string(e.what()).find("stand at 4 angles only"), std::string::npos) << e.what();
  }
}

} // namespace
} // namespace ada::test

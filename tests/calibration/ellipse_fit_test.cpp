// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/ellipse_fit.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "base/error.h"
#include "calibration/circle_start.h"
#include "calibration/pair_estimate.h"
#include "support/seed.h"
#include "support/sensor_pair.h"

namespace ada::test {
namespace {

SensorPair elliptic_pair() {
  SensorPair pair;
  pair.k = 0.009;
  pair.delta_rad = 0.35 * kRadPerDeg;
  pair.adc_bits = 0;
  return pair;
}

/// Cramer-Rao bound of theta for samples at these angles, psi unknown, by numeric derivatives of
/// the test's own forward model: independent of the library's Jacobian.
std::array<double, 5> bound(const SensorPair &pair, const Capture &capture) {
  const auto curve = [&](const std::array<double, 5> &t, double psi) {
    return std::pair{t[3] + t[0] * (1 + t[1] / 2) * std::sin(psi + t[2] / 2),
                     t[4] + t[0] * (1 - t[1] / 2) * std::cos(psi - t[2] / 2)};
  };
  const std::array<double, 5> theta = {pair.amplitude_v, pair.k, pair.delta_rad, pair.offset_sin_v,
                                       pair.offset_cos_v};
  std::array<std::array<double, 5>, 5> info{};
  for (const double deg : capture.reference_deg) {
    const double psi = pair.periods * deg * kRadPerDeg, h = 1e-6;
    const auto [s0, c0] = curve(theta, psi - h);
    const auto [s1, c1] = curve(theta, psi + h);
    const double length = std::hypot(s1 - s0, c1 - c0);
    const double ns = -(c1 - c0) / length, nc = (s1 - s0) / length;
    std::array<double, 5> row{};
    for (int j = 0; j < 5; ++j) {
      auto lo = theta, hi = theta;
      lo[j] -= h;
      hi[j] += h;
      const auto [sl, cl] = curve(lo, psi);
      const auto [sh, ch] = curve(hi, psi);
      row[j] = (ns * (sh - sl) + nc * (ch - cl)) / (2 * h);
    }
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j)
        info[i][j] += row[i] * row[j] / (pair.noise_rms_v * pair.noise_rms_v);
  }
  // Inverse by Gauss-Jordan.
  std::array<std::array<double, 5>, 5> inverse{};
  for (int i = 0; i < 5; ++i)
    inverse[i][i] = 1;
  for (int i = 0; i < 5; ++i) {
    const double pivot = info[i][i];
    for (int j = 0; j < 5; ++j) {
      info[i][j] /= pivot;
      inverse[i][j] /= pivot;
    }
    for (int r = 0; r < 5; ++r)
      if (r != i) {
        const double factor = info[r][i];
        for (int j = 0; j < 5; ++j) {
          info[r][j] -= factor * info[i][j];
          inverse[r][j] -= factor * inverse[i][j];
        }
      }
  }
  std::array<double, 5> out{};
  for (int i = 0; i < 5; ++i)
    out[i] = std::sqrt(inverse[i][i]);
  return out;
}

/// Spread of the estimates of one method over many noise draws, relative to the bound.
struct Spread {
  std::array<double, 5> ratio{};    ///< root mean square error / bound
  std::array<double, 5> reported{}; ///< mean reported standard error / bound
};

Spread spread_over_draws(CalibrationMethod method, const SensorPair &pair, const Motion &motion,
                         int draws, std::uint64_t seed) {
  Sampler sampler(pair, seed);
  std::array<double, 5> square{}, reported{}, crb{};
  const std::array<double, 5> truth = {pair.amplitude_v, pair.k, pair.delta_rad,
                                       pair.supply_v / 2 + pair.offset_sin_v,
                                       pair.supply_v / 2 + pair.offset_cos_v};
  for (int d = 0; d < draws; ++d) {
    const Capture capture = sampler.capture(1000, 0.4, motion);
    if (d == 0)
      crb = bound(pair, capture);
    const PairEstimate e = estimate_pair(capture, method);
    const std::array<double, 5> value = {e.value.amplitude_v, e.value.k, e.value.delta_rad,
                                         e.value.centre_sin_v, e.value.centre_cos_v};
    for (int i = 0; i < 5; ++i) {
      square[i] += std::pow(value[i] - truth[i], 2);
      reported[i] += e.std_error[i];
    }
  }
  Spread s;
  for (int i = 0; i < 5; ++i) {
    s.ratio[i] = std::sqrt(square[i] / draws) / crb[i];
    s.reported[i] = reported[i] / draws / crb[i];
    std::printf("  %s parameter %d: rms error / bound = %.3f, reported / bound = %.3f\n",
                method_name(method), i, s.ratio[i], s.reported[i]);
  }
  return s;
}

// The relative error of a standard deviation from n draws is 1/sqrt(2 n): with 6000 draws 0.91 %,
// so that 5 % stands 5.5 standard errors off and a fit at the bound fails about once in 10^7 runs.
constexpr int kDraws = 6000;

// 2.3 mechanical turns at a speed that swings by 60 %: no time base, no whole number of turns.
const Motion kUnevenMotion = swinging_speed(2.3 / 0.4, 0.6, 1.0);

TEST(EllipseFitBound, fit_reaches_the_cramer_rao_bound_within_5_percent) {
  const Spread s = spread_over_draws(CalibrationMethod::fit, elliptic_pair(), kUnevenMotion, kDraws,
                                     fresh_seed());
  for (int i = 0; i < 5; ++i) {
    EXPECT_NEAR(s.ratio[i], 1.0, 0.05) << "parameter " << i;
    EXPECT_NEAR(s.reported[i], 1.0, 0.05) << "parameter " << i;
  }
}

TEST(EllipseFitBound, fit_reaches_the_bound_on_part_of_a_turn) {
  // 250 electrical degrees: most of one period, about a third of a mechanical turn.
  const Motion part = constant_speed(125.0 / 360 / 0.4);
  const Spread s =
      spread_over_draws(CalibrationMethod::fit, elliptic_pair(), part, kDraws, fresh_seed());
  for (int i = 0; i < 5; ++i)
    EXPECT_NEAR(s.ratio[i], 1.0, 0.05) << "parameter " << i;
}

TEST(EllipseFitBound, mean_and_extrema_miss_the_bound) {
  const std::uint64_t seed = fresh_seed();
  const Spread mean =
      spread_over_draws(CalibrationMethod::mean, elliptic_pair(), kUnevenMotion, kDraws / 2, seed);
  const Spread extrema =
      spread_over_draws(CalibrationMethod::extrema, elliptic_pair(), kUnevenMotion, 1000, seed);
  for (const int i : {kAmplitude, kCentreSin, kCentreCos}) {
    EXPECT_GT(mean.ratio[i], 1.05) << "parameter " << i;
    EXPECT_GT(extrema.ratio[i], 2.0) << "parameter " << i;
  }
}

TEST(EllipseFit, derivatives_agree_with_numeric_ones) {
  // At the minimum of exact data the reported covariance must be the inverse information that
  // numeric derivatives of an independent forward model give.
  SensorPair pair = elliptic_pair();
  pair.k = 0.2;
  pair.delta_rad = 0.15;
  Sampler sampler(pair, fresh_seed());
  const Capture c = sampler.capture(1000, 2.0, constant_speed(1.3));
  const EllipseFit fit = fit_ellipse(c.vsin_v, c.vcos_v);
  const auto crb = bound(pair, c);
  for (int i = 0; i < 5; ++i)
    EXPECT_NEAR(fit.std_error(static_cast<EllipseIndex>(i)) / crb[i] *
                    (pair.noise_rms_v / fit.residual_rms_v),
                1.0, 0.01);
}

TEST(EllipseFit, exact_data_give_exact_parameters) {
  SensorPair pair = elliptic_pair();
  pair.noise_rms_v = 0;
  for (const double k : {-0.3, 0.0, 0.02, 0.5})
    for (const double delta_deg : {-20.0, 0.0, 0.1, 10.0}) {
      pair.k = k;
      pair.delta_rad = delta_deg * kRadPerDeg;
      Sampler sampler(pair, 1);
      const Capture c = sampler.capture(1000, 0.7, constant_speed(0.9));
      const EllipseFit fit = fit_ellipse(c.vsin_v, c.vcos_v);
      EXPECT_NEAR(fit.value.amplitude_v, pair.amplitude_v, 1e-8);
      EXPECT_NEAR(fit.value.k, k, 1e-8);
      EXPECT_NEAR(fit.value.delta_rad, pair.delta_rad, 1e-8);
      EXPECT_NEAR(fit.value.centre_sin_v, 2.5 + pair.offset_sin_v, 1e-8);
      EXPECT_NEAR(fit.value.centre_cos_v, 2.5 + pair.offset_cos_v, 1e-8);
    }
}

TEST(EllipseFit, a_flat_ellipse_in_coarse_steps_is_found) {
  // One channel five times weaker than the other, and read in steps of a seventh of its amplitude:
  // of a circle to begin with only a short part would be left.
  SensorPair pair;
  pair.k = -1.36;
  pair.delta_rad = 19.0 * kRadPerDeg;
  pair.amplitude_v = 0.55;
  pair.noise_rms_v = 0.01;
  pair.offset_sin_v = 0.5;
  Sampler sampler(pair, fresh_seed());
  Capture c = sampler.capture(560, 28.0, constant_speed(0.053));
  constexpr double kStep = 0.025;
  for (auto *channel : {&c.vsin_v, &c.vcos_v})
    for (double &v : *channel)
      v = kStep * std::round(v / kStep);
  const EllipseFit fit = fit_ellipse(c.vsin_v, c.vcos_v);
  EXPECT_NEAR(fit.coverage_deg, 360.0, 20.0);
  EXPECT_NEAR(fit.value.k, pair.k, 0.02);
  EXPECT_NEAR(fit.value.delta_rad, pair.delta_rad, 3.0 * kRadPerDeg);
}

TEST(EllipseFit, a_flat_ellipse_across_both_channels_is_found) {
  // Two channels five sixths of a half period apart, of a ring whose periods differ: a part of a
  // large circle would fit nearly as well.
  SensorPair pair;
  pair.k = 0.25;
  pair.delta_rad = -64.0 * kRadPerDeg;
  pair.noise_rms_v = 0.002;
  Sampler sampler(pair, fresh_seed());
  Capture c = sampler.capture(450, 0.45, constant_speed(17.8));
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double size = 1.0 + 0.12 * std::sin(kTwoPi * 2.9 * static_cast<double>(i) / 450.0);
    c.vsin_v[i] = 2.5 + size * (c.vsin_v[i] - 2.5);
    c.vcos_v[i] = 2.5 + size * (c.vcos_v[i] - 2.5);
  }
  const EllipseFit fit = fit_ellipse(c.vsin_v, c.vcos_v);
  EXPECT_NEAR(fit.coverage_deg, 360.0, 20.0);
  EXPECT_NEAR(fit.value.k, pair.k, 0.1);
  EXPECT_NEAR(fit.value.delta_rad, pair.delta_rad, 5.0 * kRadPerDeg);
}

TEST(EllipseFit, spikes_do_not_move_it) {
  SensorPair pair = elliptic_pair();
  Sampler sampler(pair, fresh_seed());
  Capture c = sampler.capture(1000, 4.0, constant_speed(1.7));
  const EllipseFit clean = fit_ellipse(c.vsin_v, c.vcos_v);
  for (std::size_t i = 0; i < c.size(); i += 50)
    (i % 100 == 0 ? c.vsin_v : c.vcos_v)[i] += sampler.noise(1.0);
  const EllipseFit hit = fit_ellipse(c.vsin_v, c.vcos_v);
  EXPECT_GT(hit.rejected, 60u);
  // 2 % of the samples gone: the change stays within the spread that a fiftieth of the data has.
  EXPECT_NEAR(hit.value.centre_sin_v, clean.value.centre_sin_v, clean.std_error(kCentreSin));
  EXPECT_NEAR(hit.value.centre_cos_v, clean.value.centre_cos_v, clean.std_error(kCentreCos));
  EXPECT_NEAR(hit.value.amplitude_v, clean.value.amplitude_v, clean.std_error(kAmplitude));
}

TEST(EllipseFit, a_dwell_does_not_bend_a_distorted_curve) {
  // A third harmonic of 1 % and nine tenths of the time at one angle: with samples weighed alike
  // the ellipse would be drawn to that angle.
  SensorPair pair;
  Sampler sampler(pair, fresh_seed());
  const Motion dwell = [](double t) { return t < 3.6 ? 0.4 : 0.4 + 2 * kTwoPi * (t - 3.6) / 0.4; };
  Capture c = sampler.capture(5000, 4.0, dwell);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double psi = 2 * c.reference_deg[i] * kRadPerDeg;
    c.vsin_v[i] -= 0.01 * pair.amplitude_v * std::sin(3 * psi);
    c.vcos_v[i] += 0.01 * pair.amplitude_v * std::cos(3 * psi);
  }
  const EllipseFit fit = fit_ellipse(c.vsin_v, c.vcos_v);
  EXPECT_GT(fit.structure_rms_v, 0.003);
  // 14.5 mV of distortion; a plain fit is off by more than 5 mV here.
  EXPECT_NEAR(fit.value.centre_sin_v, 2.5 + pair.offset_sin_v, 0.001);
  EXPECT_NEAR(fit.value.centre_cos_v, 2.5 + pair.offset_cos_v, 0.001);
}

TEST(CircleStart, finds_a_circle_from_a_short_noisy_arc) {
  SensorPair pair;
  Sampler sampler(pair, fresh_seed());
  const Capture c = sampler.capture(1000, 1.0, constant_speed(50.0 / 360)); // 100 deg electrical
  const EllipseParameters circle = circle_start(c.vsin_v, c.vcos_v);
  EXPECT_NEAR(circle.amplitude_v, pair.amplitude_v, 0.005);
  EXPECT_NEAR(circle.centre_sin_v, 2.5 + pair.offset_sin_v, 0.005);
}

TEST(CircleStart, reports_none_for_points_on_a_line) {
  const std::vector<double> x = {1, 2, 3, 4, 5}, y = {2, 4, 6, 8, 10}, same(5, 1.0);
  EXPECT_EQ(circle_start(x, y).amplitude_v, 0.0);
  EXPECT_EQ(circle_start(same, same).amplitude_v, 0.0);
}

TEST(EllipseFit, refuses_numbers_that_are_none) {
  const std::vector<double> bad(100, std::nan(""));
  EXPECT_THROW(fit_ellipse(bad, bad), Error);
  EXPECT_THROW(fit_ellipse({}, {}), Error);
}

/// Distances from fits that really leave out their third of the samples, each of thirty stretches
/// in turn.
double left_out(const Capture &c) {
  double square = 0;
  for (std::size_t part = 0; part < 3; ++part) {
    std::array<std::vector<double>, 2> sin, cos; // of the fit, and left out of it
    for (std::size_t i = 0; i < c.size(); ++i) {
      const std::size_t out = i * 30 / c.size() % 3 == part;
      sin[out].push_back(c.vsin_v[i]);
      cos[out].push_back(c.vcos_v[i]);
    }
    const EllipseParameters e = fit_ellipse(sin[0], cos[0]).value;
    // To the nearest of many points of the curve.
    constexpr int kPoints = 4000;
    for (std::size_t i = 0; i < sin[1].size(); ++i) {
      double best = 1e9;
      for (int k = 0; k < kPoints; ++k) {
        const double psi = kTwoPi * k / kPoints, h = e.delta_rad / 2;
        best = std::min(
            best,
            std::hypot(
                e.centre_sin_v + e.amplitude_v * (1 + e.k / 2) * std::sin(psi + h) - sin[1][i],
                e.centre_cos_v + e.amplitude_v * (1 - e.k / 2) * std::cos(psi - h) - cos[1][i]));
      }
      square += best * best;
    }
  }
  return std::sqrt(square / static_cast<double>(c.size()));
}

TEST(ellipse_fit, tells_how_far_samples_are_off_that_no_fit_has_seen) {
  SensorPair pair = elliptic_pair();
  pair.noise_rms_v = 0.01;
  Sampler sampler(pair, fresh_seed());
  Capture few = sampler.capture(240, 1.0, constant_speed(3.1));
  Capture drifting = sampler.capture(300, 1.0, constant_speed(3.1));
  for (std::size_t i = 0; i < drifting.size(); ++i)
    drifting.vsin_v[i] += 0.05 * static_cast<double>(i) / static_cast<double>(drifting.size());
  for (Capture *c : {&few, &drifting}) {
    const EllipseFit fit = fit_ellipse(c->vsin_v, c->vcos_v);
    EXPECT_GT(fit.heldout_rms_v,
              fit.residual_rms_v *
                  std::sqrt(1 - 5.0 / static_cast<double>(c->size()))); // of the samples of the fit
    EXPECT_NEAR(fit.heldout_rms_v / left_out(*c), 1, 0.02) << c->size();
  }
}

} // namespace
} // namespace ada::test

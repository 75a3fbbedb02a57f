// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The fit in passes over a long recording is the fit of all its samples.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "calibration/recording_fit.h"
#include "recording/capture_file.h"
#include "support/seed.h"
#include "support/sensor_pair.h"
#include "support/temp_folder.h"

using namespace ada;
using namespace ada::test;

namespace {

constexpr double kRate = 100'000;
constexpr double kSeconds = 1.02 * static_cast<double>(kFittedWhole) / kRate;

std::array<double, kEllipseSize> values(const EllipseParameters &e) {
  return {e.amplitude_v, e.k, e.delta_rad, e.centre_sin_v, e.centre_cos_v};
}

/// Within a hundredth of a standard error of the fit that holds every sample. The limits of the
/// outliers may differ by a thousandth, so that a wild sample that lies just there may count in one
/// and not in the other: it moves a parameter by up to 6 sqrt(8/N) standard errors.
/// `least`: standard errors that are allowed in any case.
void expect_equal(const EllipseFit &passes, const EllipseFit &whole, double limit = 0.002,
                  double least = 0.01) {
  const double flips = std::abs(static_cast<double>(passes.used) - static_cast<double>(whole.used));
  const double samples = static_cast<double>(whole.used);
  const double part = least + flips * kOutlierSigmas * std::sqrt(8 / samples);
  EXPECT_LE(flips, 2);
  EXPECT_NEAR(passes.limit_v / whole.limit_v, 1, limit);
  const auto a = values(passes.value), b = values(whole.value);
  for (std::size_t i = 0; i < kEllipseSize; ++i) {
    const auto index = static_cast<EllipseIndex>(i);
    if (whole.std_error(index) == 0) { // held
      EXPECT_EQ(passes.std_error(index), 0);
      EXPECT_EQ(a[i], b[i]);
      continue;
    }
    EXPECT_LT(std::abs(a[i] - b[i]), part * whole.std_error(index)) << i;
    EXPECT_NEAR(passes.std_error(index) / whole.std_error(index), 1, 0.01) << i;
  }
  EXPECT_NEAR(passes.residual_rms_v / whole.residual_rms_v, 1, 0.001);
  EXPECT_NEAR(passes.coverage_deg, whole.coverage_deg, 1.01); // a degree is a bin
}

struct Case {
  const char *name;
  double noise_v, stray;
  std::size_t spikes;
};

class RecordingFit : public testing::TestWithParam<Case> {};

TEST_P(RecordingFit, is_the_fit_of_all_samples) {
  const std::uint64_t seed = fresh_seed();
  SensorPair pair;
  pair.k = 0.02;
  pair.delta_rad = 0.03;
  pair.noise_rms_v = GetParam().noise_v;
  pair.stray = GetParam().stray;
  Sampler sampler(pair, seed);
  Capture c = sampler.capture(kRate, kSeconds, swinging_speed(7.3, 0.2, 1));
  for (std::size_t i = 0; i < GetParam().spikes; ++i)
    c.vsin_v[static_cast<std::size_t>(sampler.uniform(0, static_cast<double>(c.size())))] =
        sampler.uniform(0, 5);
  const auto recording = recording_of(c);
  const RecordingToFit what(*recording);
  ASSERT_TRUE(what.is_long);
  EXPECT_NEAR(fit_ellipse(what).heldout_rms_v / fit_ellipse(c.vsin_v, c.vcos_v).heldout_rms_v, 1,
              0.001);
  // Where some tens of spikes lie within the limit, the two differ by up to 0.03 standard errors in
  // one capture of fifteen, with the same samples in use. That is not understood yet.
  const double least = GetParam().spikes > 0 ? 0.05 : 0.01;
  expect_equal(fit_ellipse(what), fit_ellipse(c.vsin_v, c.vcos_v), 0.002, least);
  expect_equal(fit_ellipse(what, {.circle = true}),
               fit_ellipse(c.vsin_v, c.vcos_v, {.circle = true}), 0.002, least);
}

INSTANTIATE_TEST_SUITE_P(Sensors, RecordingFit,
                         testing::Values(Case{"quiet", 0.0005, 0, 0}, Case{"noisy", 0.02, 0, 0},
                                         Case{"distorted", 0.0005, 0.02, 0},
                                         Case{"spikes", 0.002, 0, 500}),
                         [](const auto &sensor) { return std::string(sensor.param.name); });

/// The magnet stands, turns for a moment and stands again: stretches show little of the circle.
TEST(RecordingFitOfATurn, in_a_long_rest_is_the_fit_of_all_samples) {
  Sampler sampler(SensorPair(), fresh_seed());
  const double begin = sampler.uniform(0.1, 0.9) * kSeconds, length = 0.03 * kSeconds;
  const Capture c = sampler.capture(kRate, kSeconds, [=](double t) {
    return 0.3 + 2 * std::numbers::pi * std::clamp((t - begin) / length, 0.0, 1.0);
  });
  const auto recording = recording_of(c);
  const RecordingToFit what(*recording);
  ASSERT_TRUE(what.is_long);
  const EllipseFit fit = fit_ellipse(what);
  const EllipseFit whole = fit_ellipse(c.vsin_v, c.vcos_v);
  // At rest the converter gives a few codes, so that the median distance is one of them, and a
  // histogram knows it to one of its cells. A cell is a part of the first fit's sigma, and the limit
  // is the median in sigmas, times so many: both limits differ by that part at most.
  constexpr double kSigmaPerMad = 1.4827; // of a Gaussian, rounded up
  const double cell = kDistanceSigmas / static_cast<double>(kDistanceCells);
  const double first_v = fit_ellipse_to_sample(what).limit_v;
  expect_equal(fit, whole, cell * kSigmaPerMad * first_v / whole.limit_v);
  ASSERT_EQ(fit.accepted.size(), what.sample->size());
  EXPECT_EQ(std::count(fit.accepted.begin(), fit.accepted.end(), 0), 0);
}

TEST(RecordingFitThreads, do_not_change_a_bit) {
  Sampler sampler(SensorPair(), fresh_seed());
  const TempFolder folder;
  const std::string path = folder / "c.sigmf-meta";
  Capture c = sampler.capture(kRate, kSeconds, constant_speed(11.1));
  c.meta.sample_rate_hz = kRate;
  c.meta.adc_bits = 16;
  c.meta.adc_reference_v = 5.0;
  write_capture(c, path);
  const auto recording = open_recording(path);
  ASSERT_GT(recording->blocks(), 8u);
  set_jobs(1);
  const EllipseFit one = fit_ellipse(RecordingToFit(*recording));
  for (const unsigned jobs : {2u, 7u}) {
    set_jobs(jobs);
    const EllipseFit many = fit_ellipse(RecordingToFit(*recording));
    EXPECT_EQ(values(many.value), values(one.value));
    EXPECT_EQ(many.covariance, one.covariance);
  }
  set_jobs(0);
}

} // namespace

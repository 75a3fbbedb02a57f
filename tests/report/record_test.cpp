// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/record.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "base/angle.h"
#include "report/samples.h"
#include "report/spectrum.h"
#include "support/seed.h"

namespace ada {
namespace {

/// The model of a capture without effects, as it was simulated.
Model true_model() {
  return Model();
}

TEST(Record, ARareDisturbanceStandsOutWhereverItIs) {
  std::mt19937_64 rng(test::fresh_seed());
  Capture capture = test::capture_with({}, true, rng());
  const std::size_t at = 100 + test::below(rng, capture.size() - 200);
  capture.vcos_v[at] += 0.05; // a hundred times the noise, in one sample
  const Scene scene = prepare(capture, false);
  const Record r = record_of(scene, true_model());
  EXPECT_NEAR(r.worst_s, capture.time_s[at], 1e-9);
  EXPECT_FALSE(r.worst_in_sin);
  EXPECT_NEAR(r.worst_v, 0.05, 0.01);
  ASSERT_EQ(r.near_s.size(), r.near_cos.size());
  const auto zero = std::find(r.near_s.begin(), r.near_s.end(), 0.0) - r.near_s.begin();
  ASSERT_LT(static_cast<std::size_t>(zero), r.near_s.size());
  EXPECT_NEAR(r.near_cos[static_cast<std::size_t>(zero)], 50.0, 10.0);
  EXPECT_TRUE(std::is_sorted(r.near_s.begin(), r.near_s.end()));
  // One stretch of time holds it, the others only noise.
  std::size_t high = 0;
  for (const Extremes &e : r.extremes)
    high += e.cos_high > 25.0;
  EXPECT_EQ(high, 1u);
  EXPECT_LE(r.shown, capture.size());
  EXPECT_GT(r.shown, capture.size() / 2);
}

TEST(Spectrum, IsEvenOnALogarithmicAxisAndKeepsALine) {
  const double hz = 700.0;
  Capture capture = test::capture_with({}, true, test::fresh_seed());
  for (std::size_t i = 0; i < capture.size(); ++i)
    capture.vsin_v[i] += 0.001 * std::sin(kTwoPi * hz * capture.time_s[i]);
  const Model model = true_model();
  const Spectrum s = residual_spectrum(prepare(capture, false).all, {&model});
  ASSERT_EQ(s.density.size(), 1u);
  ASSERT_GT(s.frequency_hz.size(), 50u);
  EXPECT_LT(s.frequency_hz.size(), 400u);
  EXPECT_NEAR(s.highest_hz, 2500.0, 1e-6); // times of six decimals
  double step = 0.0;
  for (std::size_t i = 1; i < s.frequency_hz.size(); ++i) {
    EXPECT_GT(s.frequency_hz[i], s.frequency_hz[i - 1]);
    step = s.frequency_hz[i] / s.frequency_hz[i - 1];
  }
  EXPECT_LT(step, 1.05); // at the upper end many lines make one step
  const auto &peak = s.density[0].peak, &mean = s.density[0].mean;
  const auto at =
      static_cast<std::size_t>(std::max_element(peak.begin(), peak.end()) - peak.begin());
  EXPECT_NEAR(s.frequency_hz[at], hz, 0.03 * hz);
  // Elsewhere white: 0.5 mV rms of each channel over 2500 Hz are 10 uV/sqrt(Hz).
  std::vector<double> sorted = mean;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<long>(sorted.size() / 2),
                   sorted.end());
  EXPECT_NEAR(sorted[sorted.size() / 2], 10.0, 3.0);
  EXPECT_GT(peak[at], 5.0 * sorted[sorted.size() / 2]);
}

} // namespace
} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Standard errors that are right: of 1000 fits 95 % intervals hold the truth in 93 to 97 %.

#include <cmath>
#include <map>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "diagnosis/captures.h"
#include "diagnosis/conditions/observations.h"
#include "diagnosis/search/fit.h"
#include "support/seed.h"

namespace ada::test {
namespace {

/// Conditions straight from the drive: preparing a capture is not what is tested here.
Observations observations_of(const Model &truth, std::mt19937_64 &rng) {
  Drive drive;
  drive.samples = 1200;
  drive.rate_hz = 400.0;
  const Capture c = capture_of(truth, drive, rng);
  return prepare(c, false).all;
}

TEST(FitCoverage, intervals_hold_the_truth_as_often_as_they_say) {
  std::mt19937_64 rng(fresh_seed());
  const auto draw = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
  constexpr int kRuns = 1000;
  std::map<std::string, int> inside;
  int all = 0, parameters = 0;
  for (int run = 0; run < kRuns; ++run) {
    Model truth = plain_sensor();
    truth.baseline = {draw(1.3, 1.5), draw(-0.01, 0.01), draw(-0.01, 0.01), 0.0};
    for (const auto &[name, values] : std::map<std::string, std::vector<double>>{
             {"amplitude-mismatch", {draw(-0.015, 0.015)}},
             {"quadrature-error", {draw(-0.8, 0.8)}},
             {"stray-field", {draw(0.003, 0.015), draw(20.0, 340.0)}},
             {"weak-field", {draw(0.002, 0.02), std::nan("")}}}) {
      ASSERT_EQ(values.size(), find_effect(name)->info().parameters.size()) << name;
      truth.effects.push_back({find_effect(name), values, {}});
    }
    const Observations data = observations_of(truth, rng);
    FitResult result = fit(data, truth, 8);
    ASSERT_TRUE(result.determined);
    attach_errors(result);
    const auto check = [&](const std::string &name, double error, double std_error) {
      const bool good = std::abs(error) < 1.96 * std_error;
      inside[name] += good;
      all += good;
      ++parameters;
    };
    const Baseline &b = result.model.baseline, &e = result.model.baseline_std_error;
    check("amplitude", b.amplitude_v - truth.baseline.amplitude_v, e.amplitude_v);
    check("offset sin", b.offset_sin_v - truth.baseline.offset_sin_v, e.offset_sin_v);
    check("offset cos", b.offset_cos_v - truth.baseline.offset_cos_v, e.offset_cos_v);
    check("zero", b.angle_zero_deg, e.angle_zero_deg);
    for (std::size_t k = 0; k < truth.effects.size(); ++k)
      for (std::size_t p = 0; p < truth.effects[k].values.size(); ++p)
        if (std::isfinite(truth.effects[k].values[p])) // not present, and not fitted
          check(std::string(truth.effects[k].effect->info().id) + std::to_string(p),
                result.model.effects[k].values[p] - truth.effects[k].values[p],
                result.model.effects[k].std_errors[p]);
  }
  // All together; each alone within what 1000 draws of 95 % may do by chance (4 deviations).
  EXPECT_GT(all, 0.93 * parameters);
  EXPECT_LT(all, 0.97 * parameters);
  for (const auto &[name, count] : inside) {
    std::printf("%-24s %.1f %%\n", name.c_str(), 100.0 * count / kRuns);
    EXPECT_NEAR(count, 0.95 * kRuns, 4.0 * std::sqrt(kRuns * 0.95 * 0.05)) << name;
  }
}

TEST(Fit, says_when_a_coordinate_is_not_determined) {
  std::mt19937_64 rng(fresh_seed());
  Drive drive;
  drive.turns_back = false;
  drive.fast_rpm = drive.slow_rpm;
  const Capture c = capture_of(plain_sensor(), drive, rng);
  Model twice = plain_sensor();
  for (const char *delay : {"propagation-delay", "hysteresis"}) // one speed, one sense
    twice.effects.push_back(parse_effect(delay));
  EXPECT_FALSE(fit(prepare(c, false).all, twice, 5).determined);
}

} // namespace
} // namespace ada::test

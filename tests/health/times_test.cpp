// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What `check` says of time columns of every kind: any origin, any unit, any rounding.

#include <cmath>
#include <functional>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "health/health.h"
#include "recording/capture_file.h"
#include "support/health.h"
#include "support/seed.h"

namespace ada::test {
namespace {

constexpr double kTimesRate = 10000;

/// Seven seconds whose times went through `write`, with the rate in the header.
Capture written(const std::function<double(double)> &write) {
  Capture c = Sampler(SensorPair{}, fresh_seed()).capture(kTimesRate, 7, constant_speed(5));
  c.meta.sample_rate_hz = kTimesRate;
  for (double &t : c.time_s)
    t = write(t);
  c.gaps = gaps_in_time(c);
  return c;
}

HealthCheck gaps(const Capture &c) {
  return find(check_health(c, nullptr), "gaps");
}

TEST(Times, of_any_origin_are_fine) {
  for (const double origin : {-1.0, 0.0, 86400.0, 1.76e9}) {
    const HealthCheck check = gaps(written([=](double t) { return origin + t; }));
    EXPECT_EQ(check.state, HealthState::passed) << origin << ": " << check.explanation;
  }
}

/// A table that is read ten times where it stops, and the same rows of a shaft that turns on.
TEST(Times, of_a_table_that_stops_have_no_gaps) {
  for (const bool stops : {true, false}) {
    Sampler sampler(SensorPair{}, fresh_seed());
    const auto place = [=](double row) { return stops ? std::floor(row / 10) : row / 10; };
    Capture c = sampler.capture(1, 170, [=](double t) { return 0.37 * place(t + 0.5); });
    for (std::size_t i = 0; i < c.size(); ++i)
      c.time_s[i] = 0.02 * static_cast<double>(i) + 0.9 * std::floor(static_cast<double>(i) / 10);
    c.gaps = gaps_in_time(c);
    const HealthCheck check = gaps(c);
    EXPECT_EQ(check.state, stops ? HealthState::passed : HealthState::failed) << check.explanation;
    EXPECT_EQ(check.explanation.find("where it rests, 17 times") != std::string::npos, stops)
        << check.explanation;
    if (!stops)
      continue;
    for (const std::size_t row : {63u, 64u}) // within the seventh stop
      for (std::vector<double> *column : {&c.time_s, &c.vsin_v, &c.vcos_v, &c.reference_deg})
        column->erase(column->begin() + static_cast<std::ptrdiff_t>(row));
    c.gaps = gaps_in_time(c);
    const HealthCheck lost = gaps(c);
    EXPECT_EQ(lost.state, HealthState::failed) << lost.explanation;
    EXPECT_NE(lost.explanation.find("within a rest samples are missing"), std::string::npos)
        << lost.explanation;
  }
}

TEST(Times, in_whole_steps_are_too_coarse) {
  for (const double origin : {0.0, 1.76e9})
    for (const double step : {1e-3, 1.0}) {
      // Not on the border between two steps, where rounding decides.
      const HealthCheck check =
          gaps(written([=](double t) { return origin + step * std::floor((t + 1e-5) / step); }));
      EXPECT_EQ(check.state, HealthState::failed);
      EXPECT_NE(check.explanation.find(step < 1 ? "in steps of 0.001 s, with about 10 samples"
                                                : "in steps of 1 s, with about 10000 samples"),
                std::string::npos)
          << check.explanation;
    }
}

TEST(Times, of_another_unit_contradict_the_rate) {
  for (const double unit : {1e-3, 1e3, 1e4, 1e6}) { // ks, ms, a count of samples, us
    const Capture c = written([=](double t) { return unit * t; });
    EXPECT_TRUE(c.gaps.empty());
    const HealthCheck check = gaps(c);
    EXPECT_EQ(check.state, HealthState::failed);
    EXPECT_NE(check.explanation.find("but sample_rate_hz says 0.0001 s"), std::string::npos)
        << check.explanation;
  }
}

TEST(Times, that_stand_or_run_back_are_told_with_their_place) {
  EXPECT_NE(gaps(written([](double) { return 3.0; })).explanation.find("the same time, 3 s"),
            std::string::npos);
  Capture c = written([](double t) { return 1.76e9 + t; });
  c.time_s[12345] = c.time_s[12344];
  EXPECT_NE(gaps(c).explanation.find("1 times, first at 1760000001.2344"), std::string::npos)
      << gaps(c).explanation;
  c.time_s[12345] = c.time_s[12344] - 1;
  EXPECT_NE(gaps(c).explanation.find("goes back"), std::string::npos) << gaps(c).explanation;
}

TEST(Times, with_a_hole_lack_samples) {
  Capture c = written([](double t) { return t < 3 ? t : t + 0.01; });
  const HealthCheck check = gaps(c);
  EXPECT_EQ(check.state, HealthState::failed);
  EXPECT_NE(check.explanation.find("about 100 samples are missing"), std::string::npos)
      << check.explanation;
}

/// Rows of a shaft that turns, read evenly and stamped when some of them were delivered; and with
/// stamps of their own, a quarter of them lost.
TEST(Times, of_a_delivery_lack_no_samples) {
  std::mt19937_64 rng(fresh_seed());
  std::uniform_real_distribution<> late(0.0, 0.4);
  for (const bool lost : {false, true}) {
    constexpr std::size_t kRows = 32;
    const Capture all = Sampler(SensorPair{}, fresh_seed()).capture(1250, 8, constant_speed(3));
    Capture c = all;
    for (std::vector<double> *column : {&c.time_s, &c.vsin_v, &c.vcos_v, &c.reference_deg})
      column->clear();
    double wakes_s = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::size_t batch = i / kRows, row = i % kRows;
      if (lost && batch % 4 == 3)
        continue;
      if (row == 0)
        wakes_s = 0.0256 * (static_cast<double>(batch + 1) + late(rng));
      c.time_s.push_back(lost ? all.time_s[i] : wakes_s + 1e-6 * static_cast<double>(row));
      c.vsin_v.push_back(all.vsin_v[i]);
      c.vcos_v.push_back(all.vcos_v[i]);
      c.reference_deg.push_back(all.reference_deg[i]);
    }
    c.gaps = gaps_in_time(c);
    const HealthCheck check = gaps(c);
    EXPECT_EQ(check.state, HealthState::failed) << check.explanation;
    EXPECT_EQ(check.explanation.find("were delivered") != std::string::npos, !lost)
        << check.explanation;
    EXPECT_EQ(check.explanation.find("samples are missing") != std::string::npos, lost)
        << check.explanation;
  }
}

} // namespace
} // namespace ada::test

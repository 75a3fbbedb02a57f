// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Rows that are not of their moment: a reference that keeps its value, a block that comes twice.

#include "health/wrong_stretches.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "diagnosis/captures.h"
#include "diagnosis/diagnose.h"
#include "health/health.h"
#include "support/seed.h"

namespace ada::test {
namespace {

double between(std::mt19937_64 &rng, double low, double high) {
  return std::uniform_real_distribution<>(low, high)(rng);
}

std::size_t row_between(std::mt19937_64 &rng, std::size_t low, std::size_t high) {
  return std::uniform_int_distribution<std::size_t>(low, high)(rng);
}

Model of_two() {
  Model model = plain_sensor();
  model.effects.push_back(parse_effect("amplitude-mismatch:k=0.01"));
  model.effects.push_back(parse_effect("quadrature-error:delta_deg=0.4"));
  return model;
}

Drive any_drive(std::mt19937_64 &rng) {
  Drive drive;
  drive.samples = 8000;
  drive.turns_back = rng() % 2 == 0;
  drive.slow_rpm = between(rng, 60.0, 200.0);
  drive.fast_rpm = between(rng, 200.0, 600.0);
  return drive;
}

bool tells(const Diagnosis &d, const std::string &words) {
  return std::ranges::any_of(d.structure, [&](const Structure &s) {
    return s.description.find(words) != std::string::npos;
  });
}

const Finding *found(const Diagnosis &d, std::string_view id) {
  for (const Finding &f : d.findings)
    if (f.effect->info().id == id)
      return &f;
  return nullptr;
}

const HealthCheck &check(const Health &health, std::string_view id) {
  return *std::ranges::find_if(health.checks, [&](const HealthCheck &c) { return c.id == id; });
}

class HeldReference : public testing::TestWithParam<double> {};

TEST_P(HeldReference, is_named_and_left_out) {
  std::mt19937_64 rng(fresh_seed());
  Capture c = capture_of(of_two(), any_drive(rng), rng);
  std::normal_distribution<> noise(0.0, 1.0);
  // In one sense: held over a turn there and back the reference has nothing to catch up.
  const std::size_t length = row_between(rng, 100, 1500);
  const std::size_t first = row_between(rng, 1000, 3500 - length);
  std::fill_n(c.reference_deg.begin() + static_cast<std::ptrdiff_t>(first), length,
              c.reference_deg[first]);
  for (double &deg : c.reference_deg)
    deg += GetParam() * noise(rng);
  const std::vector<RowRange> held = held_reference(c);
  ASSERT_EQ(held.size(), 1u);
  // Within its noise of it the reference is still that value.
  EXPECT_NEAR(static_cast<double>(held[0].first), static_cast<double>(first + 1), 3.0);
  EXPECT_NEAR(static_cast<double>(held[0].end), static_cast<double>(first + length), 3.0);
  const HealthCheck of = check(check_health(c, nullptr), "reference");
  EXPECT_EQ(of.state, HealthState::failed);
  EXPECT_NE(of.explanation.find("keeps its value"), std::string::npos) << of.explanation;
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(tells(d, "the reference keeps its value"));
  EXPECT_NE(d.verdict, Verdict::explained);
  const Finding *k = found(d, "amplitude-mismatch");
  ASSERT_TRUE(k);
  EXPECT_NEAR(k->values[0], 0.01, 5.0 * k->std_errors[0]);
}

INSTANTIATE_TEST_SUITE_P(Noise, HeldReference, testing::Values(0.0, 0.003));

/// Whatever else holds a reference for some rows is usual for it.
TEST(HeldReference, is_none_where_it_holds_all_its_values) {
  std::mt19937_64 rng(fresh_seed());
  const Capture sound = capture_of(of_two(), any_drive(rng), rng);
  EXPECT_TRUE(held_reference(sound).empty());
  for (const double lines : {100.0, 1000.0}) {
    Capture coarse = sound;
    for (double &deg : coarse.reference_deg)
      deg = 360.0 / lines * std::floor(deg * lines / 360.0);
    EXPECT_TRUE(held_reference(coarse).empty()) << lines;
  }
  Capture read_less = sound;
  for (std::size_t i = 0, next = 0; i < read_less.size(); ++i)
    if (i == next)
      next += row_between(rng, 3, 9);
    else
      read_less.reference_deg[i] = read_less.reference_deg[i - 1];
  EXPECT_TRUE(held_reference(read_less).empty());
  // A shaft that stands first, and starts.
  Capture starts = sound;
  for (auto *column : {&starts.vsin_v, &starts.vcos_v, &starts.reference_deg})
    column->insert(column->begin(), 2000, column->front());
  std::normal_distribution<> noise(0.0, 5e-4);
  for (std::size_t i = 0; i < 2000; ++i) {
    starts.vsin_v[i] += noise(rng);
    starts.vcos_v[i] += noise(rng);
  }
  for (auto *column : {&starts.vsin_v, &starts.vcos_v, &starts.reference_deg})
    column->resize(sound.size());
  EXPECT_TRUE(held_reference(starts).empty());
}

class Twice : public testing::TestWithParam<bool> {};

TEST_P(Twice, a_block_is_named_and_left_out) {
  std::mt19937_64 rng(fresh_seed());
  Capture c = capture_of(of_two(), any_drive(rng), rng);
  if (!GetParam())
    c.reference_deg.clear();
  const std::size_t rows = row_between(rng, 12, 64), blocks = row_between(rng, 1, 4);
  for (std::size_t k = 0; k < blocks; ++k) {
    const std::size_t first = 500 + 1800 * k + row_between(rng, 0, 1000);
    for (auto *column : {&c.vsin_v, &c.vcos_v, &c.reference_deg})
      for (std::size_t i = first; i < first + rows && !column->empty(); ++i)
        (*column)[i] = (*column)[i - rows];
  }
  const std::vector<RowRange> found_ranges = repeated_blocks(c);
  ASSERT_EQ(found_ranges.size(), blocks);
  for (const RowRange &r : found_ranges)
    EXPECT_EQ(r.size(), rows);
  EXPECT_EQ(check(check_health(c, nullptr), "gaps").state, HealthState::failed);
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(tells(d, "a block of rows is that of an earlier moment"));
  EXPECT_FALSE(found(d, "sample-loss"));
  EXPECT_FALSE(found(d, "angle-slip"));
  const Finding *k = found(d, "amplitude-mismatch");
  ASSERT_TRUE(k);
  EXPECT_NEAR(k->values[0], 0.01, 5.0 * k->std_errors[0]);
}

INSTANTIATE_TEST_SUITE_P(Reference, Twice, testing::Bool());

TEST(Twice, coarse_readings_or_a_signal_without_noise_are_not) {
  std::mt19937_64 rng(fresh_seed());
  const auto rounded = [](Capture c, double step_v) {
    for (auto *column : {&c.vsin_v, &c.vcos_v})
      for (double &v : *column)
        v = step_v * std::round(v / step_v);
    return c;
  };
  for (const double noise_v : {0.0, 2e-4, 2e-3}) {
    Drive drive = any_drive(rng);
    drive.noise_v = noise_v;
    for (const double step_v : {1e-4, 1e-3, 1e-2, 4e-2}) {
      EXPECT_TRUE(repeated_blocks(rounded(capture_of(of_two(), drive, rng), step_v)).empty())
          << noise_v << " " << step_v;
      Drive steady = drive; // comes round to the same rows
      steady.turns_back = false;
      steady.slow_rpm = steady.fast_rpm = 120.0;
      EXPECT_TRUE(repeated_blocks(rounded(capture_of(of_two(), steady, rng), step_v)).empty())
          << noise_v << " " << step_v;
    }
  }
}

/// A host stamps rows late, and some of them much later than the next ones.
TEST(Stamps, of_delivery_are_no_loss_of_samples) {
  std::mt19937_64 rng(fresh_seed());
  Drive drive = any_drive(rng);
  drive.rate_hz = 500.0; // a row is some degrees
  Capture c = capture_of(of_two(), drive, rng);
  if (rng() % 2 == 0)
    c.reference_deg.clear();
  const Capture as_read = c;
  std::exponential_distribution<> late(1.0);
  const double usual = between(rng, 0.1, 0.3) / drive.rate_hz;
  for (double &t : c.time_s)
    t += usual * late(rng) + (rng() % 50 == 0 ? 20.0 * usual * late(rng) : 0.0);
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(tells(d, "the time stamps scatter by"));
  EXPECT_FALSE(found(d, "sample-loss"));
  const Finding *k = found(d, "amplitude-mismatch");
  ASSERT_TRUE(k);
  EXPECT_NEAR(k->values[0], 0.01, 5.0 * k->std_errors[0]);
  EXPECT_FALSE(tells(diagnose(as_read, {}), "the time stamps scatter by"));
}

/// Where the readings are taken when the stamps say they are right, however uneven.
TEST(Stamps, of_uneven_readings_stand) {
  std::mt19937_64 rng(fresh_seed());
  const Model model = of_two();
  const double rate_hz = 500.0, speed = between(rng, 5.0, 20.0);
  ShaftMotion shaft;
  std::vector<double> time;
  for (std::size_t i = 0; i < 6000; ++i) {
    time.push_back((static_cast<double>(i) + between(rng, 0.0, 0.6)) / rate_hz);
    shaft.alpha.push_back(speed * time.back());
    shaft.omega.push_back(speed);
    shaft.direction.push_back(1);
  }
  Capture c = pair_of(model, shaft, rate_hz, 5e-4, rng);
  c.time_s = time;
  EXPECT_FALSE(tells(diagnose(c, {}), "the time stamps scatter by"));
}

} // namespace
} // namespace ada::test

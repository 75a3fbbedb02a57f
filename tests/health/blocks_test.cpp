// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A recording that is checked block by block gets the sentences of the one that is checked whole.

#include <string>

#include <gtest/gtest.h>

#include "recording/capture_file.h"
#include "support/health.h"
#include "support/seed.h"
#include "support/temp_folder.h"

namespace ada::test {
namespace {

constexpr double kRate = 10000;
constexpr std::size_t kSamples = 6 * 16384 + 30; ///< the last block of SigMF is a short one

Capture long_turn(Sampler &sampler) {
  Capture c = sampler.capture(kRate, static_cast<double>(kSamples) / kRate, constant_speed(3.7));
  c.reference_deg.clear();
  c.meta.sample_rate_hz = kRate;
  c.meta.adc_bits = 16;
  c.meta.adc_reference_v = 5.0;
  c.meta.noise_rms_v = SensorPair().noise_rms_v;
  return c;
}

void expect_same(const Health &blocks, const Health &whole) {
  EXPECT_EQ(blocks.against, whole.against);
  ASSERT_EQ(blocks.checks.size(), whole.checks.size());
  for (std::size_t i = 0; i < whole.checks.size(); ++i) {
    const HealthCheck &a = blocks.checks[i], &b = whole.checks[i];
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.state, b.state) << a.explanation << " / " << b.explanation;
    EXPECT_EQ(a.explanation, b.explanation);
    EXPECT_EQ(a.times_s, b.times_s);
  }
}

class HealthInBlocks : public testing::TestWithParam<const char *> {
protected:
  /// Checks it in blocks and whole; returns what is said of its spikes.
  std::string check(const Capture &capture) {
    const std::string path = folder_ / (std::string("c") + GetParam());
    write_capture(capture, path);
    const auto recording = open_recording(path);
    EXPECT_GT(recording->blocks(), 2u);
    const Health health = check_health(RecordingToFit(*recording), nullptr);
    expect_same(health, check_health(*recording->whole(), nullptr));
    return find(health, "spikes").explanation;
  }

  TempFolder folder_;
  Sampler sampler_{SensorPair(), fresh_seed()};
};

TEST_P(HealthInBlocks, a_sound_sensor_is_sound) {
  EXPECT_EQ(check(long_turn(sampler_)), "no sample stands out");
}

TEST_P(HealthInBlocks, spikes_are_seen_at_both_ends_of_a_block_and_of_the_recording) {
  Capture c = long_turn(sampler_);
  for (const std::size_t i : {std::size_t{0}, std::size_t{1}, std::size_t{3}, std::size_t{16383},
                              std::size_t{2 * 16384}, kSamples - 20, kSamples - 2, kSamples - 1}) {
    c.vsin_v[i] = 2.5 + 1.2 * (c.vsin_v[i] - 2.5);
    c.vcos_v[i] = 2.5 + 1.2 * (c.vcos_v[i] - 2.5);
  }
  EXPECT_EQ(check(c).find("samples that stand out: 8 in the pair"), 0u);
}

TEST_P(HealthInBlocks, spikes_that_are_rare_in_all_may_crowd_one_block) {
  Capture c = long_turn(sampler_);
  const auto begin = static_cast<std::size_t>(sampler_.uniform(20, kSamples - 3000.0));
  for (std::size_t i = 0; i < 300; ++i) // more than one in sixty of a block, 0.3 % of all
    c.vcos_v[begin + 9 * i] += i % 2 ? 0.4 : -0.4;
  EXPECT_EQ(check(c).find("samples that stand out: 300 in the pair"), 0u);
}

TEST_P(HealthInBlocks, a_row_of_wild_samples_may_lie_across_blocks) {
  Capture c = long_turn(sampler_);
  for (std::size_t i = 16384 - 11; i < 16384 + 19; ++i)
    c.vsin_v[i] = c.vcos_v[i] = 2.5;
  EXPECT_NE(check(c).find(", 30 of them in a row from 1.6373 s on"), std::string::npos) << check(c);
}

TEST_P(HealthInBlocks, a_row_of_wild_readings_of_the_reference_may_lie_across_blocks) {
  Capture c = long_turn(sampler_);
  for (const double t : c.time_s)
    c.reference_deg.push_back(360 * 3.7 * t);
  for (std::size_t i = 16384 - 11; i < 16384 + 19; ++i)
    c.reference_deg[i] = 0.5 * c.reference_deg[i] + 77;
  EXPECT_EQ(check(c).find("samples that stand out: 30 in the reference (at 1.6373 s,"), 0u)
      << check(c);
}

TEST_P(HealthInBlocks, what_is_not_rare_is_structure) {
  Capture c = long_turn(sampler_);
  for (std::size_t i = 20; i < kSamples; i += 20)
    c.vsin_v[i] += 0.04;
  EXPECT_EQ(check(c), "no sample stands out");
}

TEST_P(HealthInBlocks, what_is_far_off_is_told_however_often) {
  Capture c = long_turn(sampler_);
  for (std::size_t i = 20; i < kSamples; i += 40)
    c.vsin_v[i] = c.vcos_v[i] = 2.5;
  EXPECT_EQ(check(c).find("2458 samples lie off the circle by more than 5 % of its radius, the "
                          "first at 0.002 s"),
            0u)
      << check(c);
}

TEST_P(HealthInBlocks, faults_in_a_row_go_on_from_block_to_block) {
  Capture c = long_turn(sampler_);
  for (std::size_t i = 16384 - 500; i < 2 * 16384 + 700; ++i)
    c.vsin_v[i] = 5.0;
  check(c);
}

INSTANTIATE_TEST_SUITE_P(Forms, HealthInBlocks, testing::Values(".csv", ".sigmf-meta"),
                         [](const auto &form) {
                           return std::string(form.index == 0 ? "text" : "sigmf");
                         });

} // namespace
} // namespace ada::test

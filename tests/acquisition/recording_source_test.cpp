// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <gtest/gtest.h>

#include <cmath>

#include "acquisition/recording_source.h"
#include "base/error.h"

using namespace ada;
using namespace std::chrono_literals;

namespace {

std::shared_ptr<Capture> capture(std::size_t n) {
  auto c = std::make_shared<Capture>();
  for (std::size_t i = 0; i < n; ++i) {
    c->time_s.push_back(double(i) * 1e-3);
    c->vsin_v.push_back(double(i));
    c->vcos_v.push_back(-double(i));
    c->vtemp_v.push_back(1.5);
  }
  c->meta.sample_rate_hz = 1000.0;
  c->meta.supply_v = 3.3;
  c->meta.serial = "S1";
  c->meta.gain_control = true;
  return c;
}

TEST(RecordingSource, PlaysEveryFrameThenEnds) {
  const auto source = make_recording_source(capture(1000));
  EXPECT_EQ(source->info().serial, "S1");
  EXPECT_EQ(source->info().supply_v, 3.3);
  EXPECT_EQ(source->info().gain_control, true);
  EXPECT_TRUE(source->info().has_vtemp);
  EXPECT_FALSE(source->info().has_vdd);
  source->start();
  std::vector<Frame> block(300);
  std::size_t got = 0;
  for (;;) {
    const ReadResult r = source->read(block, 0ms);
    if (r.outcome == ReadOutcome::end)
      break;
    ASSERT_EQ(r.outcome, ReadOutcome::frames);
    for (std::size_t i = 0; i < r.count; ++i, ++got) {
      ASSERT_EQ(block[i].vsin_v, double(got));
      ASSERT_EQ(block[i].vtemp_v, 1.5);
      ASSERT_TRUE(std::isnan(block[i].vdd_v));
    }
  }
  EXPECT_EQ(got, 1000u);
  EXPECT_EQ(source->statistics().frames, 1000u);
  source->start(); // from the beginning
  ASSERT_EQ(source->read(block, 0ms).count, 300u);
  EXPECT_EQ(block[0].vsin_v, 0.0);
}

TEST(RecordingSource, GapsOfTheRecordingAreCounted) {
  auto c = capture(100);
  for (std::size_t i = 40; i < 100; ++i)
    c->time_s[i] += 7e-3; // 7 frames are missing before frame 40
  c->gaps = {40};
  const auto source = make_recording_source(c);
  source->start();
  Frame block[33];
  while (source->read(block, 0ms).outcome == ReadOutcome::frames) {
  }
  EXPECT_EQ(source->statistics().gaps, 1u);
  EXPECT_EQ(source->statistics().lost, 7u);
}

TEST(RecordingSource, CancelHoldsUntilStart) {
  const auto source = make_recording_source(capture(10));
  Frame frame;
  EXPECT_THROW(source->read({&frame, 1}, 0ms), Error);
  source->start();
  source->cancel();
  EXPECT_EQ(source->read({&frame, 1}, 0ms).outcome, ReadOutcome::cancelled);
  source->start();
  EXPECT_EQ(source->read({&frame, 1}, 0ms).outcome, ReadOutcome::frames);
}

} // namespace

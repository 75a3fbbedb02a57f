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

TEST(RecordingSource, AReplayKeepsTheTimesAndTheirPace) {
  auto c = capture(400); // 0.4 s
  const auto source = make_recording_source(c, 2.0);
  const auto began = std::chrono::steady_clock::now(); // not later than the source's own
  source->start();
  std::vector<Frame> block(400);
  std::size_t got = 0;
  for (;;) {
    const ReadResult r = source->read(block, 5s);
    if (r.outcome == ReadOutcome::end)
      break;
    ASSERT_EQ(r.outcome, ReadOutcome::frames);
    const std::chrono::duration<double> since = std::chrono::steady_clock::now() - began;
    got += r.count;
    ASSERT_EQ(block[r.count - 1].time_s, c->time_s[got - 1]);
    ASSERT_GE(2.0 * since.count(), c->time_s[got - 1]); // no frame before its time
  }
  EXPECT_EQ(got, 400u);
}

TEST(RecordingSource, AReplayWaitsNoLongerThanItMay) {
  auto c = capture(2);
  c->time_s[1] = 1e6;
  const auto source = make_recording_source(c, 1.0);
  source->start();
  Frame frame;
  EXPECT_EQ(source->read({&frame, 1}, 0ms).outcome, ReadOutcome::frames);
  EXPECT_EQ(source->read({&frame, 1}, 0ms).outcome, ReadOutcome::timeout);
  EXPECT_EQ(source->read({&frame, 1}, 10ms).outcome, ReadOutcome::timeout);
  for (const double wrong : {0.0, -1.0, 2e6, std::nan("")})
    EXPECT_THROW(check_speed(wrong), Error);
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

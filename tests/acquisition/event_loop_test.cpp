// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The descriptor that a source gives to an event loop: a program that only reads when it is
// readable, and never waits in a read, gets everything and hears of every end.

#include <gtest/gtest.h>

#include <thread>

#include <poll.h>

#include "acquisition/iio_source.h"
#include "acquisition/recording_source.h"
#include "base/error.h"
#include "served.h"
#include "simulation/simulation.h"
#include "test_bed.h"

using namespace ada;
using namespace ada::test;
using namespace std::chrono_literals;

namespace {

constexpr std::chrono::milliseconds kLong{10000};

bool readable(int fd, std::chrono::milliseconds timeout) {
  pollfd p = {fd, POLLIN, 0};
  return poll(&p, 1, static_cast<int>(timeout.count())) > 0 && (p.revents & POLLIN);
}

/// As an event loop: waits for the descriptor, reads once without waiting. Ends with an outcome that is
/// neither frames nor a time-out, or after `most` frames, or when nothing comes for long.
struct Loop {
  std::vector<Frame> frames;
  ReadOutcome last = ReadOutcome::timeout;
  std::size_t for_nothing = 0; ///< wake-ups

  void run(Source &source, std::size_t most, std::size_t block_frames) {
    std::vector<Frame> block(block_frames);
    while (frames.size() < most && readable(source.poll_fd(), kLong)) {
      const ReadResult r = source.read(block, 0ms);
      last = r.outcome;
      if (r.outcome == ReadOutcome::timeout) {
        ++for_nothing;
        continue;
      }
      if (r.outcome != ReadOutcome::frames)
        return;
      frames.insert(frames.end(), block.begin(), block.begin() + static_cast<std::ptrdiff_t>(r.count));
    }
  }
};

std::shared_ptr<Capture> capture(std::size_t n) {
  auto c = std::make_shared<Capture>();
  for (std::size_t i = 0; i < n; ++i) {
    c->time_s.push_back(static_cast<double>(i) * 1e-3);
    c->vsin_v.push_back(static_cast<double>(i));
    c->vcos_v.push_back(1.0);
  }
  c->meta.sample_rate_hz = 1000.0;
  return c;
}

TEST(EventLoop, ARecordingAndAReplayAreReadToTheirEnd) {
  for (const double speed : {0.0, 3.0}) {
    const auto source = make_recording_source(capture(300), speed);
    const int fd = source->poll_fd();
    EXPECT_FALSE(readable(fd, 0ms)) << "before the start";
    source->start();
    Loop loop;
    loop.run(*source, 1000, 64);
    ASSERT_EQ(loop.frames.size(), 300u) << speed;
    EXPECT_EQ(loop.last, ReadOutcome::end);
    EXPECT_TRUE(readable(fd, 0ms)) << "the end stays to be seen";
    source->stop();
    EXPECT_FALSE(readable(fd, 0ms)) << "after the stop";
    EXPECT_EQ(source->poll_fd(), fd);
    source->start();
    EXPECT_TRUE(readable(fd, kLong)) << "again";
  }
}

TEST(EventLoop, AReplayIsQuietUntilItsNextFrameIsDue) {
  auto c = capture(2);
  c->time_s[1] = 1e6;
  const auto source = make_recording_source(c, 1.0);
  source->start();
  const int fd = source->poll_fd();
  ASSERT_TRUE(readable(fd, kLong));
  Frame block[8];
  EXPECT_EQ(source->read(block, 0ms).count, 1u);
  EXPECT_FALSE(readable(fd, 50ms));
  source->cancel();
  EXPECT_TRUE(readable(fd, kLong));
  EXPECT_EQ(source->read(block, 0ms).outcome, ReadOutcome::cancelled);
}

TEST(EventLoop, TheSimulatedSensorByTheClock) {
  SimulationOptions o;
  o.sample_rate_hz = 2000.0;
  o.duration_s = 0.2;
  const auto source = Simulation(std::nullopt, o, 1).source(true);
  source->start();
  Loop loop;
  loop.run(*source, 1000, 16);
  EXPECT_EQ(loop.frames.size(), 400u);
  EXPECT_EQ(loop.last, ReadOutcome::end);
}

TEST(EventLoop, ANetworkDeviceWhateverTheSizeOfTheReads) {
  const ScanFormat u16;
  const Served served(served_pair(u16, u16, 2000.0));
  IioSourceOptions o;
  o.uri = served.uri();
  o.buffer_frames = 50;
  const auto source = open_iio_source(o);
  const int fd = source->poll_fd(); // before the start: the stream comes later
  EXPECT_FALSE(readable(fd, 0ms));
  source->start();
  Loop loop;
  loop.run(*source, 1000, 7); // frames stay in hand between the reads
  ASSERT_GE(loop.frames.size(), 1000u);
  for (std::size_t i = 0; i < 1000; ++i)
    ASSERT_DOUBLE_EQ(loop.frames[i].vsin_v, 1e-3 * static_cast<double>(i + 1)) << i;
  // At most a wake-up for nothing a buffer and a drained ring each: no busy waiting.
  EXPECT_LE(loop.for_nothing, 2 * loop.frames.size() / 50 + 2);
}

TEST(EventLoop, ALostServerIsHeardOfAndItsReturnNeedsNoOtherDescriptor) {
  const ScanFormat u16;
  auto served = std::make_unique<Served>(served_pair(u16, u16, 1000.0));
  const int port = served->port();
  IioSourceOptions o;
  o.uri = served->uri();
  const auto source = open_iio_source(o);
  source->start();
  const int fd = source->poll_fd(); // after the start
  Loop loop;
  loop.run(*source, 100, 64);
  ASSERT_GE(loop.frames.size(), 100u);
  served->die();
  EXPECT_THROW(loop.run(*source, 1u << 20, 64), Error);
  EXPECT_TRUE(readable(fd, 0ms)) << "the loss stays to be seen";
  served = std::make_unique<Served>(served_pair(u16, u16, 1000.0), IiodServer::FaultHook(), port);
  source->start();
  Loop again;
  again.run(*source, 100, 64);
  EXPECT_GE(again.frames.size(), 100u);
  EXPECT_EQ(source->poll_fd(), fd);
}

TEST(EventLoop, ALocalDeviceAndItsRemoval) {
  if (!TestBed::available())
    GTEST_SKIP() << "umockdev's preload library is not in LD_PRELOAD";
  TestBed bed;
  bed.add_device(labelled_adc());
  const auto source = open_iio_source({});
  bed.connect();
  source->start();
  bed.feed(labelled_frames(500, 1, 0, 1'000'000));
  Loop loop;
  loop.run(*source, 500, 33);
  ASSERT_EQ(loop.frames.size(), 500u);
  EXPECT_DOUBLE_EQ(loop.frames[499].vsin_v, 500 * 1e-4);
  bed.remove_device();
  EXPECT_THROW(loop.run(*source, 501, 33), Error);
  EXPECT_TRUE(readable(source->poll_fd(), 0ms));
}

} // namespace

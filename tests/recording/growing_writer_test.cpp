// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/growing_writer.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <random>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "recording/captures.h"
#include "recording/identity.h"
#include "recording/sigmf_pair.h"
#include "recording/sigmf_reader.h"
#include "support/seed.h"
#include "support/temp_folder.h"

namespace ada::test {
namespace {

class GrowingWriterTest : public testing::Test {
protected:
  std::unique_ptr<CaptureWriter> open(bool resume = false) {
    return open_growing_writer(meta_path_, capture_.meta, ChannelSet::of(capture_), resume);
  }
  void write(CaptureWriter &writer, std::size_t first, std::size_t count) const {
    for (std::size_t i = first; i < first + count; ++i) {
      const Frame frame = frame_at(capture_, i);
      writer.write({&frame, 1});
    }
  }

  TempFolder folder_;
  std::string meta_path_ = folder_ / "c.sigmf-meta", data_path_ = folder_ / "c.sigmf-data";
  std::mt19937_64 rng_{fresh_seed()};
  Capture capture_ = counted_capture(rng_, 3000, 16, 5.0, 10000);
};

TEST_F(GrowingWriterTest, CanBeReadWhileItGrowsAndAfterwards) {
  const auto writer = open();
  EXPECT_TRUE(folder_.names().empty());
  for (std::size_t i = 0; i < 3000; i += 1000) {
    write(*writer, i, 1000);
    EXPECT_EQ(read_capture(meta_path_).size(), i + 1000);
  }
  writer->finish();
  EXPECT_EQ(read_capture(meta_path_).identity, capture_identity(capture_));
  EXPECT_EQ(folder_.names().size(), 2u);
}

TEST_F(GrowingWriterTest, WithoutFinishEverythingStays) {
  write(*open(), 0, 1234);
  const Capture kept = read_capture(meta_path_);
  EXPECT_EQ(kept.size(), 1234u);
  EXPECT_EQ(kept.vsin_v.back(), capture_.vsin_v[1233]);
}

TEST_F(GrowingWriterTest, WhatACrashLeavesAtTheEndDoesNotCount) {
  write(*open(), 0, 1000);
  const std::string whole = read_file(data_path_);
  const std::size_t frame = whole.size() / 1000;
  for (const std::size_t lost : {std::size_t{1}, frame - 1, frame, 5 * frame + 3}) {
    write_file(data_path_, whole.substr(0, whole.size() - lost));
    EXPECT_EQ(read_capture(meta_path_).size(), (whole.size() - lost) / frame) << lost;
  }
  write_file(data_path_, whole + std::string(10 * frame + 1, '\0')); // room that was never filled
  EXPECT_EQ(read_capture(meta_path_).size(), 1000u);
}

TEST_F(GrowingWriterTest, GoesOnWhereItEnded) {
  for (const bool finished : {true, false}) {
    std::filesystem::remove(meta_path_);
    std::filesystem::remove(data_path_);
    {
      const auto writer = open();
      write(*writer, 0, 1000);
      if (finished)
        writer->finish();
      else // part of a frame, as a crash may leave it
        write_file(data_path_, read_file(data_path_) + "abc");
    }
    const auto writer = open(true);
    write(*writer, 0, 500);
    writer->finish();
    const Capture both = read_capture(meta_path_);
    ASSERT_EQ(both.size(), 1500u);
    EXPECT_EQ(both.vsin_v[1000], capture_.vsin_v[0]);
    EXPECT_GT(both.time_s[1000], both.time_s[999]);
    EXPECT_NEAR(both.time_s[1499] - both.time_s[1000], capture_.time_s[499] - capture_.time_s[0],
                1e-9);
    EXPECT_NE(std::find(both.gaps.begin(), both.gaps.end(), 1000u), both.gaps.end());
  }
}

TEST_F(GrowingWriterTest, ResumingWithoutAFrameChangesNothing) {
  {
    const auto writer = open();
    write(*writer, 0, 1000);
    writer->finish();
  }
  const std::string meta = read_file(meta_path_), data = read_file(data_path_);
  open(true).reset();
  EXPECT_EQ(read_file(meta_path_), meta);
  EXPECT_EQ(read_file(data_path_), data);
}

TEST_F(GrowingWriterTest, RefusesToMixWhatDiffers) {
  {
    const auto writer = open();
    write(*writer, 0, 1000);
    writer->finish();
  }
  ada4571_status status = ADA4571_OK;
  capture_.meta.supply_v = 3.3;
  EXPECT_NE(failure([&] { open(true); }, &status), "");
  EXPECT_EQ(status, ADA4571_ERROR_UNUSABLE_DATA);
  capture_.meta.supply_v = 5.0;
  capture_ = converter_channels_only(std::move(capture_));
  EXPECT_NE(failure([&] { open(true); }, &status), "");
  EXPECT_EQ(status, ADA4571_ERROR_UNUSABLE_DATA);
}

TEST_F(GrowingWriterTest, HasOneWriterAtATime) {
  const auto writer = open();
  write(*writer, 0, 10);
  ada4571_status status = ADA4571_OK;
  EXPECT_NE(failure([&] { open(true); }, &status), "");
  EXPECT_EQ(status, ADA4571_ERROR_BUSY);
  EXPECT_NE(failure([&] { write_capture(capture_, meta_path_); }, &status), "");
  EXPECT_EQ(status, ADA4571_ERROR_BUSY);
  writer->finish();
  EXPECT_EQ(read_capture(meta_path_).size(), 10u);
}

TEST_F(GrowingWriterTest, AnOldRecordingStaysUntilTheNewOneIsComplete) {
  write_capture(capture_, meta_path_);
  const std::string before = read_capture(meta_path_).identity;
  const auto writer = open();
  write(*writer, 0, 100);
  EXPECT_EQ(read_capture(meta_path_).identity, before);
  writer->finish();
  EXPECT_EQ(read_capture(meta_path_).size(), 100u);
  EXPECT_EQ(folder_.names().size(), 2u);
}

/// Two recordings of one name: whoever reads finds one of them whole, whenever he looks.
TEST_F(GrowingWriterTest, APairIsReplacedAsAUnit) {
  const Capture other = counted_capture(rng_, 2000, 16, 5.0, 10000);
  const std::string one = capture_identity(capture_), two = capture_identity(other);
  write_capture(capture_, meta_path_);
  constexpr int kRounds = 40;
  const auto replace = [&](const Capture &with) {
    for (int i = 0; i < kRounds; ++i)
      write_capture(with, meta_path_);
  };
  std::jthread first(replace, capture_), second(replace, other); // joined whatever is thrown below
  int seen = 0;
  for (int i = 0; i < kRounds; ++i) {
    const std::string found = read_capture(meta_path_).identity;
    EXPECT_TRUE(found == one || found == two) << found;
    ++seen;
  }
  first.join();
  second.join();
  EXPECT_EQ(seen, kRounds);
  EXPECT_EQ(folder_.names().size(), 2u);
}

/// The moments in which a program may be killed while it replaces a pair.
TEST_F(GrowingWriterTest, EveryStageOfAReplacementCanBeRead) {
  const Capture newer = counted_capture(rng_, 2000, 16, 5.0, 10000);
  write_capture(newer, folder_ / "n.sigmf-meta");
  SigmfMeta meta = read_sigmf_meta(folder_ / "n.sigmf-meta");
  meta.dataset = "c.123.sigmf-data";
  const std::string data = read_file(folder_ / "n.sigmf-data");
  write_capture(capture_, meta_path_);
  write_file(folder_ / meta.dataset, data); // its data beside the old pair
  EXPECT_EQ(read_capture(meta_path_).identity, capture_identity(capture_));
  write_sigmf_meta(meta, meta_path_); // the meta file of the new one
  EXPECT_EQ(read_capture(meta_path_).identity, capture_identity(newer));
  std::filesystem::rename(folder_ / meta.dataset, data_path_); // its data in place
  EXPECT_EQ(read_capture(meta_path_).identity, capture_identity(newer));
}

} // namespace
} // namespace ada::test

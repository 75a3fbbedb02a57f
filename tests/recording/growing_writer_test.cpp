// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/growing_writer.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <random>
#include <string>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "base/descriptor.h"
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

/// The disk's space that a file takes, beyond what it holds.
std::uint64_t taken_beyond(const std::string &path) {
  struct stat info {};
  EXPECT_EQ(::stat(path.c_str(), &info), 0);
  constexpr std::uint64_t kUnit = 512; // of st_blocks
  const std::uint64_t taken = static_cast<std::uint64_t>(info.st_blocks) * kUnit;
  const auto size = static_cast<std::uint64_t>(info.st_size);
  return taken > size ? taken - size : 0;
}

TEST_F(GrowingWriterTest, SpaceOfTheDiskTakenAheadIsFreeAgainAtTheEnd) {
  constexpr std::uint64_t kRounding = 65536; // of a file system to whole blocks
  {
    const std::string other = folder_ / "other";
    const Descriptor file(::open(other.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
    if (::fallocate(file.get(), FALLOC_FL_KEEP_SIZE, 0, 1 << 20) != 0)
      GTEST_SKIP() << "this file system takes no space ahead, or has none";
    std::filesystem::remove(other);
  }
  for (const bool finished : {true, false}) {
    auto writer = open();
    write(*writer, 0, 3000);
    EXPECT_GT(taken_beyond(data_path_), kRounding);
    if (finished)
      writer->finish();
    writer.reset();
    EXPECT_LE(taken_beyond(data_path_), kRounding);
    EXPECT_EQ(read_capture(meta_path_).size(), 3000u);
    std::filesystem::remove(meta_path_);
    std::filesystem::remove(data_path_);
  }
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

TEST_F(GrowingWriterTest, SaysWhichNumberDiffersAndBothOfThem) {
  write(*open(), 0, 10);
  struct Other {
    void (*change)(CaptureMetadata &);
    const char *said;
  };
  for (const Other &other :
       {Other{[](CaptureMetadata &m) { m.sample_rate_hz = 2500; },
              "its sample rate is 10000 Hz, now it would be 2500 Hz"},
        Other{[](CaptureMetadata &m) { m.sample_rate_hz.reset(); },
              "its sample rate is 10000 Hz, now it would be unknown"},
        Other{[](CaptureMetadata &m) { m.supply_v = 3.3; },
              "its supply is 5 V, now it would be 3.3 V"},
        Other{[](CaptureMetadata &m) { m.periods_per_turn = 7; }, ", now it would be 7"}}) {
    CaptureMetadata meta = capture_.meta;
    other.change(meta);
    const std::string why =
        failure([&] { open_growing_writer(meta_path_, meta, ChannelSet::of(capture_), true); });
    EXPECT_NE(why.find(other.said), std::string::npos) << why;
  }
}

/// Beside an old recording each grows under a name of its own, and the last one would win.
TEST_F(GrowingWriterTest, HasOneWriterAtATimeThatReplacesAnOldRecording) {
  write_capture(capture_, meta_path_);
  const auto writer = open();
  for (const bool begun : {false, true}) {
    for (const bool resume : {false, true}) {
      ada4571_status status = ADA4571_OK;
      EXPECT_NE(failure([&] { open(resume); }, &status), "");
      EXPECT_EQ(status, ADA4571_ERROR_BUSY);
    }
    ada4571_status status = ADA4571_OK;
    EXPECT_NE(failure([&] { write_capture(capture_, meta_path_); }, &status), "");
    EXPECT_EQ(status, ADA4571_ERROR_BUSY);
    if (!begun)
      write(*writer, 0, 10);
  }
  writer->finish();
  EXPECT_EQ(read_capture(meta_path_).size(), 10u);
  EXPECT_EQ(folder_.names().size(), 2u);
}

TEST_F(GrowingWriterTest, SaysWhereTheRecordingIsThatCannotTakeItsPlace) {
  write_capture(capture_, meta_path_);
  const auto writer = open();
  write(*writer, 0, 10);
  std::filesystem::remove(data_path_);
  std::filesystem::create_directory(data_path_); // which no rename replaces
  const std::string why = failure([&] { writer->finish(); });
  const auto at = why.find("; what was recorded is in ");
  ASSERT_NE(at, std::string::npos) << why;
  EXPECT_EQ(read_capture(why.substr(why.find(folder_ / "", at))).size(), 10u) << why;
}

/// A link to what is not there yet is followed, and the other file would stay behind.
TEST_F(GrowingWriterTest, LinksDoNotTearAPairApart) {
  std::filesystem::create_directory(folder_ / "far");
  for (const std::string &name : {meta_path_, data_path_}) {
    const std::string target = "far/" + std::filesystem::path(name).filename().string();
    std::filesystem::create_symlink(target, name);
    ada4571_status status = ADA4571_OK;
    for (const bool resume : {false, true}) {
      const std::string why = failure([&] { open(resume); }, &status);
      EXPECT_NE(why.find("far/c.sigmf-"), std::string::npos) << why;
      EXPECT_EQ(status, ADA4571_ERROR_INVALID_ARGUMENT);
    }
    EXPECT_NE(failure([&] { write_capture(capture_, meta_path_); }, &status), "");
    EXPECT_EQ(status, ADA4571_ERROR_INVALID_ARGUMENT);
    std::filesystem::remove(name);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "far"));
  // Both of them lead to a pair again.
  std::filesystem::create_symlink("far/d.sigmf-meta", meta_path_);
  std::filesystem::create_symlink("far/d.sigmf-data", data_path_);
  write_capture(capture_, meta_path_);
  EXPECT_EQ(read_capture(folder_ / "far/d.sigmf-meta").identity, capture_identity(capture_));
  const auto writer = open();
  write(*writer, 0, 10);
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

/// Frames of a converter with a word of every kind, and what they are in volts.
class RawRecording : public GrowingWriterTest {
protected:
  static RawForm form() {
    RawForm out;
    const ScanFormat words[] = {{12, 16, 4, 1, true, true},
                                {16, 16, 0, 1, false, false},
                                {24, 32, 8, 1, true, false},
                                {64, 64, 0, 1, true, std::endian::native == std::endian::big}};
    const FrameLayout layout = compute_layout(words);
    double Frame::*const targets[] = {&Frame::vsin_v, &Frame::vcos_v, &Frame::vdd_v};
    for (std::size_t c = 0; c < 3; ++c)
      out.channels.push_back({targets[c],
                              words[c],
                              {c == 0 ? 2048.5 : 0.0, 1e-4 / (3.0 + static_cast<double>(c))},
                              layout.offsets[c]});
    out.timestamp_byte = layout.offsets[3];
    out.frame_bytes = layout.frame_bytes;
    return out;
  }

  /// `times`: the timestamps, from kOrigin on.
  RawFrames frames(const std::vector<std::int64_t> &times) {
    bytes_.assign(times.size() * form_.frame_bytes, std::byte{});
    for (std::byte &b : bytes_)
      b = static_cast<std::byte>(rng_());
    for (std::size_t i = 0; i < times.size(); ++i) {
      const std::int64_t word = kOrigin + times[i];
      std::memcpy(bytes_.data() + i * form_.frame_bytes + form_.timestamp_byte, &word, sizeof word);
    }
    expect_volts();
    return {&form_, bytes_, times.size(), kOrigin, {}, 101'000};
  }

  void expect_volts() {
    for (std::size_t c = 0; c < 3; ++c) {
      const RawChannel &channel = form_.channels[c];
      std::vector<double> volts(bytes_.size() / form_.frame_bytes);
      ElementDecoder(channel.format, channel.scale, "x")
          .volts(bytes_.data() + channel.byte, form_.frame_bytes, volts.size(), volts.data(), 1);
      expected_[c].insert(expected_[c].end(), volts.begin(), volts.end());
    }
  }

  static std::vector<std::int64_t> even(std::size_t count, std::int64_t first = 0) {
    std::vector<std::int64_t> out(count);
    for (std::size_t i = 0; i < count; ++i)
      out[i] = first + 100'000 * static_cast<std::int64_t>(i);
    return out;
  }

  std::unique_ptr<CaptureWriter> open_raw(bool resume = false) {
    return open_growing_raw_writer(meta_path_, capture_.meta, form_, resume);
  }

  void expect_read_back() const {
    const Capture back = read_capture(meta_path_);
    EXPECT_EQ(back.vsin_v, expected_[0]);
    EXPECT_EQ(back.vcos_v, expected_[1]);
    EXPECT_EQ(back.vdd_v, expected_[2]);
  }

  static constexpr std::int64_t kOrigin = 1'700'000'000'123'456'789;
  RawForm form_ = form();
  std::vector<std::byte> bytes_;
  std::vector<double> expected_[3];
};

TEST_F(RawRecording, IsReadBackAsTheVoltsOfItsWordsWhileItGrowsAndAfterwards) {
  const auto writer = open_raw();
  ASSERT_TRUE(writer->takes_raw());
  for (std::size_t block = 0; block < 3; ++block) {
    writer->write_raw(frames(even(700, static_cast<std::int64_t>(block) * 70'000'000)), 0);
    if (block == 0) { // as the device gave them
      EXPECT_EQ(read_file(data_path_),
                std::string(reinterpret_cast<const char *>(bytes_.data()), bytes_.size()));
    }
    expect_read_back();
  }
  writer->finish();
  expect_read_back();
  const Capture back = read_capture(meta_path_);
  for (std::size_t i = 0; i < back.size(); ++i)
    ASSERT_NEAR(back.time_s[i], 1e-4 * static_cast<double>(i), 1e-10);
  EXPECT_TRUE(back.gaps.empty());
}

TEST_F(RawRecording, TimesThatTheTimestampsDoNotTellTakeTheirPlace) {
  const auto writer = open_raw();
  writer->write_raw(frames(even(100)), 0);
  std::vector<std::int64_t> times = even(100, 10'000'000);
  for (std::size_t i = 50; i < times.size(); ++i)
    times[i] += 400'000;                                       // a gap
  RawFrames odd = frames(std::vector<std::int64_t>(100, -77)); // the timestamps stand still
  odd.times_ns = times;
  writer->write_raw(odd, 0);
  writer->write_raw(frames(even(100, 0)), 40'000'000); // a device that came back
  writer->finish();
  expect_read_back();
  const Capture back = read_capture(meta_path_);
  EXPECT_NEAR(back.time_s[149], 0.0149, 1e-10);
  EXPECT_NEAR(back.time_s[150], 0.0154, 1e-10);
  EXPECT_NEAR(back.time_s[200], 0.04, 1e-10);
  EXPECT_EQ(back.gaps, (std::vector<std::size_t>{150, 200}));
}

TEST_F(RawRecording, GoesOnWhereItEnded) {
  open_raw()->write_raw(frames(even(500)), 0);
  write_file(data_path_, read_file(data_path_) + "abc"); // part of a frame, as a crash leaves it
  const auto writer = open_raw(true);
  writer->write_raw(frames(even(300, 5'000'000'000)), 0);
  writer->finish();
  expect_read_back();
  const Capture back = read_capture(meta_path_);
  ASSERT_EQ(back.size(), 800u);
  EXPECT_GT(back.time_s[500], back.time_s[499]);
  EXPECT_NEAR(back.time_s[799] - back.time_s[500], 0.0299, 1e-9);
  EXPECT_NE(std::find(back.gaps.begin(), back.gaps.end(), 500u), back.gaps.end());
}

TEST_F(RawRecording, IsNotMixedWithAnotherForm) {
  ada4571_status status = ADA4571_OK;
  {
    const auto writer = open_raw();
    writer->write_raw(frames(even(500)), 0);
    const Frame frame = frame_at(capture_, 0);
    EXPECT_NE(failure([&] { writer->write({&frame, 1}); }), "");
    RawForm other = form_;
    other.channels[1].scale.scale_v *= 2.0;
    RawFrames scaled = frames(even(10, 50'000'000));
    scaled.form = &other;
    EXPECT_NE(failure([&] { writer->write_raw(scaled, 0); }, &status), "");
    EXPECT_EQ(status, ADA4571_ERROR_UNUSABLE_DATA);
  }
  EXPECT_NE(failure([&] { open(true); }, &status), "");
  EXPECT_EQ(status, ADA4571_ERROR_UNUSABLE_DATA);
  form_.channels[1].scale.scale_v *= 2.0;
  EXPECT_NE(failure([&] { open_raw(true); }, &status), "");
  EXPECT_EQ(status, ADA4571_ERROR_UNUSABLE_DATA);
  form_.channels[1].scale.scale_v = 1e9; // beyond what a capture may hold
  EXPECT_NE(failure([&] { open_raw(false); }, &status), "");
  EXPECT_EQ(status, ADA4571_ERROR_UNSUPPORTED);
}

TEST_F(RawRecording, OneOfDoublesGoesOnWithFrames) {
  write(*open(), 0, 100);
  ada4571_status status = ADA4571_OK;
  EXPECT_NE(failure([&] { open_raw(true); }, &status), "");
  EXPECT_EQ(status, ADA4571_ERROR_UNSUPPORTED);
  EXPECT_EQ(read_capture(meta_path_).size(), 100u);
}

} // namespace
} // namespace ada::test

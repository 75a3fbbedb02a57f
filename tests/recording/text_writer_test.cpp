// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/text_writer.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "recording/captures.h"
#include "recording/identity.h"
#include "recording/text_reader.h"
#include "support/seed.h"
#include "support/temp_folder.h"

namespace ada::test {
namespace {

std::string written(const Capture &capture) {
  const TempFolder folder;
  write_capture(capture, folder / "c.csv");
  return read_file(folder / "c.csv");
}

TEST(TextWriter, WritesTheFormAsItIsDescribed) {
  Capture c;
  c.meta.gain_control = false;
  c.meta.noise_rms_v = 0.0005;
  c.meta.serial = "S 1";
  c.meta.other = {{"bench", "3"}};
  c.time_s = {-0.5, 0, 0.0001, 1.0 / 3};
  c.vsin_v = {-1.25, 0.0000004, 3.617706, 1};
  c.vcos_v = {2.5, -0.0000004, 1.552887, 100};
  c.reference_deg = {0, 212.4879, 359.99999, -1};
  EXPECT_EQ(written(c), "# ada4571-capture/1\n"
                        "# supply_v = 5\n"
                        "# periods_per_turn = 2\n"
                        "# gain_control = off\n"
                        "# noise_rms_v = 0.0005\n"
                        "# serial = S 1\n"
                        "# bench = 3\n"
                        "time_s,vsin_v,vcos_v,reference_deg\n"
                        "-0.500000,-1.250000,2.500000,0.0000\n"
                        "0.000000,0.000000,0.000000,212.4879\n"
                        "0.000100,3.617706,1.552887,360.0000\n"
                        "0.333333333,1.000000,100.000000,-1.0000\n");
}

/// Bits and reference of converters that are in use, and beyond.
class TextRoundTrip : public testing::TestWithParam<std::pair<int, double>> {};

TEST_P(TextRoundTrip, KeepsEveryCodeOfTheConverter) {
  const auto [bits, reference_v] = GetParam();
  std::mt19937_64 rng(fresh_seed());
  const double rate = std::uniform_real_distribution<double>(1, 1e6)(rng);
  const Capture before = counted_capture(rng, 5000, bits, reference_v, rate);
  const TempFolder folder;
  write_capture(before, folder / "c.csv");
  const Capture after = read_text_capture(folder / "c.csv");

  ASSERT_EQ(after.size(), before.size());
  const double step = reference_v / std::exp2(bits);
  for (std::size_t i = 0; i < before.size(); ++i) {
    ASSERT_EQ(std::llround(after.vsin_v[i] / step), std::llround(before.vsin_v[i] / step)) << i;
    ASSERT_EQ(std::llround(after.vcos_v[i] / step), std::llround(before.vcos_v[i] / step)) << i;
    ASSERT_EQ(std::llround(after.vtemp_v[i] / step), std::llround(before.vtemp_v[i] / step)) << i;
    ASSERT_NEAR(after.time_s[i], before.time_s[i], 0.501e-9) << i;
    ASSERT_NEAR(after.reference_deg[i], before.reference_deg[i], 0.501e-4) << i;
  }
  EXPECT_EQ(after.identity, capture_identity(before));
  // What was read once is written the same again.
  EXPECT_EQ(written(after), read_file(folder / "c.csv"));
}

INSTANTIATE_TEST_SUITE_P(Converters, TextRoundTrip,
                         testing::Values(std::pair(8, 5.0), std::pair(12, 2.5), std::pair(14, 3.3),
                                         std::pair(16, 5.0), std::pair(16, 2.048),
                                         std::pair(18, 4.096), std::pair(20, 5.0),
                                         std::pair(24, 2.5)));

TEST(TextWriter, TakesTheTimesOfARaggedClockToTheNanosecond) {
  std::mt19937_64 rng(fresh_seed());
  std::uniform_int_distribution<std::int64_t> step(0, 2'000'000);
  Capture c;
  std::int64_t now = 0;
  for (int i = 0; i < 2000; ++i) {
    c.time_s.push_back(static_cast<double>(now += step(rng)) / 1e9);
    c.vsin_v.push_back(1);
    c.vcos_v.push_back(2);
  }
  const TempFolder folder;
  write_capture(c, folder / "c.csv");
  EXPECT_EQ(read_text_capture(folder / "c.csv").time_s, c.time_s);
}

class TextWriterCalls : public testing::Test {
protected:
  std::unique_ptr<CaptureWriter> open(ChannelSet channels = {}) {
    return open_capture_writer(folder_ / "c.csv", {}, channels);
  }
  static void write(CaptureWriter &writer, Frame frame) { writer.write({&frame, 1}); }
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

  TempFolder folder_;
};

TEST_F(TextWriterCalls, NothingRemainsWithoutFinish) {
  {
    const auto writer = open();
    for (int i = 0; i < 100000; ++i)
      write(*writer, {i * 1e-3, 1, 2, kNan, kNan, kNan});
  }
  EXPECT_TRUE(folder_.names().empty());
}

TEST_F(TextWriterCalls, RefusesAnEmptyRecording) {
  ada4571_status status = ADA4571_OK;
  EXPECT_NE(failure([&] { open()->finish(); }, &status), "");
  EXPECT_EQ(status, ADA4571_ERROR_STATE);
  EXPECT_TRUE(folder_.names().empty());
}

TEST_F(TextWriterCalls, RefusesWhatCouldNotBeReadAgain) {
  const auto message = [&](ChannelSet channels, Frame frame) {
    return failure([&] {
      const auto writer = open(channels);
      write(*writer, {1, 1, 2, 1, 5, 0});
      write(*writer, frame);
    });
  };
  EXPECT_EQ(message({}, {2, kNan, 2, 1, 5, 0}), "frame 1: vsin_v is not a number");
  EXPECT_EQ(message({}, {2, 1, INFINITY, 1, 5, 0}), "frame 1: vcos_v is out of range");
  EXPECT_EQ(message({.vtemp = true}, {2, 1, 2, kNan, 5, 0}), "frame 1: vtemp_v is not a number");
  EXPECT_EQ(message({}, {2, 1, 2, kNan, 5, 0}), "");
  EXPECT_EQ(message({}, {0.5, 1, 2, 1, 5, 0}), "frame 1: time_s goes back from 1 to 0.5");
  EXPECT_EQ(message({}, {1, 1, 2, 1, 5, 0}), "");
}

TEST_F(TextWriterCalls, RefusesMetadataThatWouldBreakTheForm) {
  const auto message = [&](const char *key, const char *value) {
    return failure([&] { open()->metadata(key, value); });
  };
  EXPECT_EQ(message("bench", "3"), "");
  EXPECT_EQ(message("bench", "3\n0,1,2"), "the value of 'bench' is not one plain line of text");
  EXPECT_EQ(message("a=b", "3"), "the key 'a=b' holds a character that a key cannot have");
  EXPECT_EQ(message("#", "3"), "the key '#' holds a character that a key cannot have");
  EXPECT_EQ(message("", "3"), "a key is empty");
  EXPECT_EQ(message("supply_v", "3"),
            "the key 'supply_v' belongs to the recording's info: set it there");
  CaptureMetadata meta;
  meta.serial = "S\n1";
  EXPECT_EQ(failure([&] { open_capture_writer(folder_ / "c.csv", meta, {}); }),
            "the value of 'serial' is not one plain line of text");
  meta = {};
  meta.sample_rate_hz = -1;
  EXPECT_EQ(failure([&] { open_capture_writer(folder_ / "c.csv", meta, {}); }),
            "sample_rate_hz must be a number from 0.000001 to 1000000000, not '-1'");
}

TEST_F(TextWriterCalls, RefusesMetadataTwiceOrTooLate) {
  const auto writer = open();
  writer->metadata("bench", "3");
  EXPECT_EQ(failure([&] { writer->metadata("bench", "4"); }), "the key 'bench' is given twice");
  write(*writer, {0, 1, 2, kNan, kNan, kNan});
  ada4571_status status = ADA4571_OK;
  EXPECT_NE(failure([&] { writer->metadata("other", "4"); }, &status), "");
  EXPECT_EQ(status, ADA4571_ERROR_STATE);
}

TEST_F(TextWriterCalls, RefusesAnExtensionThatNamesNoForm) {
  ada4571_status status = ADA4571_OK;
  EXPECT_EQ(failure([&] { open_capture_writer("c.txt", {}, {}); }, &status),
            "c.txt: the name of a capture must end in .csv or .sigmf-meta");
  EXPECT_EQ(status, ADA4571_ERROR_INVALID_ARGUMENT);
}

TEST(Identity, FollowsContentAndNotDescription) {
  std::mt19937_64 rng(fresh_seed());
  const Capture first = counted_capture(rng, 1000, 16, 5.0, 1000);
  Capture other = first;
  other.meta.serial = "S1";
  other.gaps = {5};
  EXPECT_EQ(capture_identity(other), capture_identity(first));
  const std::size_t i = std::uniform_int_distribution<std::size_t>(0, 999)(rng);
  other.vcos_v[i] += 5.0 / 65536;
  EXPECT_NE(capture_identity(other), capture_identity(first));
  other = first;
  std::swap(other.vsin_v, other.vcos_v);
  EXPECT_NE(capture_identity(other), capture_identity(first));
  other = first;
  other.vdd_v.clear();
  EXPECT_NE(capture_identity(other), capture_identity(first));
}

} // namespace
} // namespace ada::test

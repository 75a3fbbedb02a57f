// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/sigmf_writer.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "recording/captures.h"
#include "recording/identity.h"
#include "recording/sigmf_reader.h"
#include "support/seed.h"
#include "support/temp_folder.h"

namespace ada::test {
namespace {

class SigmfWriterTest : public testing::Test {
protected:
  /// Writes, reads the meta file as plain JSON, reads the recording back.
  Capture through(const Capture &capture) {
    write_capture(capture, meta_path_);
    json_ = nlohmann::json::parse(read_file(meta_path_));
    return read_capture(meta_path_);
  }
  const nlohmann::json &global() const { return json_["global"]; }

  static void expect_same(const Capture &after, const Capture &before) {
    EXPECT_EQ(after.time_s, before.time_s);
    EXPECT_EQ(after.vsin_v, before.vsin_v);
    EXPECT_EQ(after.vcos_v, before.vcos_v);
    EXPECT_EQ(after.vtemp_v, before.vtemp_v);
    EXPECT_EQ(after.vdd_v, before.vdd_v);
    EXPECT_EQ(after.reference_deg, before.reference_deg);
    EXPECT_EQ(after.identity, capture_identity(before));
  }

  TempFolder folder_;
  std::string meta_path_ = folder_ / "c.sigmf-meta", data_path_ = folder_ / "c.sigmf-data";
  /// Two nanoseconds later, and still the double nearest to whole nanoseconds.
  static double a_little_later(double time_s) { return (std::nearbyint(time_s * 1e9) + 2.0) / 1e9; }

  nlohmann::json json_;
  std::mt19937_64 rng_{fresh_seed()};
};

TEST_F(SigmfWriterTest, WritesConverterCodesAsPlainInterleavedSamples) {
  const Capture before = converter_channels_only(counted_capture(rng_, 3000, 16, 5.0, 10000));
  const Capture after = through(before);
  expect_same(after, before);
  EXPECT_EQ(global()["core:datatype"], "ru16_le");
  EXPECT_EQ(global()["core:num_channels"], 3);
  EXPECT_EQ(global()["core:sample_rate"], 10000.0);
  EXPECT_EQ(global()["core:extensions"][0]["name"], "ada4571");
  EXPECT_EQ(global()["core:extensions"][0]["optional"], true);
  EXPECT_TRUE(json_["annotations"].is_array());

  // What is on the disk, decoded without the library: codes, sine first.
  const std::string data = read_file(data_path_);
  ASSERT_EQ(data.size(), 3000u * 3 * 2);
  for (std::size_t i = 0; i < 3000; ++i) {
    const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(data[at]); };
    const unsigned code = byte(6 * i) | byte(6 * i + 1) << 8;
    ASSERT_EQ(code * 5.0 / 65536, before.vsin_v[i]) << i;
  }
}

TEST_F(SigmfWriterTest, PutsOtherChannelsIntoADeclaredFrame) {
  const Capture before = counted_capture(rng_, 1000, 12, 2.5, 2000);
  expect_same(through(before), before);
  EXPECT_EQ(global()["core:datatype"], "ru8");
  EXPECT_EQ(global()["core:num_channels"], global()["ada4571:frame_bytes"]);
  EXPECT_EQ(global()["core:extensions"][0]["optional"], false);
  EXPECT_EQ(read_file(data_path_).size(),
            1000 * global()["ada4571:frame_bytes"].get<std::size_t>());
}

TEST_F(SigmfWriterTest, WritesDoublesWhereTheConverterIsUnknown) {
  Capture before = counted_capture(rng_, 1000, 16, 5.0, 2000);
  before.meta.adc_bits.reset();
  std::normal_distribution<double> noise(0, 1e-3);
  for (double &v : before.vsin_v)
    v += noise(rng_);
  expect_same(through(before), before);
  EXPECT_EQ(global()["core:datatype"], "rf64_le");
  EXPECT_EQ(global()["core:num_channels"], 5);
}

TEST_F(SigmfWriterTest, RecodesWhenASampleIsNoCode) {
  for (const double odd : {1.0 + 1e-5, -0.001, 5.0}) {
    Capture before = converter_channels_only(counted_capture(rng_, 9000, 16, 5.0, 10000));
    before.vcos_v[std::uniform_int_distribution<std::size_t>(0, 8999)(rng_)] = odd;
    expect_same(through(before), before);
    EXPECT_EQ(global()["core:datatype"], "rf64_le");
  }
}

TEST_F(SigmfWriterTest, RecodesWithATimeChannelWhenTheClockIsRagged) {
  Capture before = converter_channels_only(counted_capture(rng_, 9000, 16, 5.0, 10000));
  const auto from = std::uniform_int_distribution<std::size_t>(0, 8999)(rng_);
  before.time_s[from] = a_little_later(before.time_s[from]);
  expect_same(through(before), before);
  if (from > 0) { // the first sample only says where time begins
    EXPECT_EQ(global()["ada4571:channels"].back()["name"], "time_s");
    EXPECT_EQ(global()["ada4571:channels"].back()["type"], "le:s64/64>>0");
  }
}

TEST_F(SigmfWriterTest, RecodesBothInOneCapture) {
  Capture before = counted_capture(rng_, 9000, 16, 5.0, 10000);
  before.time_s[4000] = a_little_later(before.time_s[4000]);
  before.vsin_v[8000] += 1e-4;
  expect_same(through(before), before);
  EXPECT_EQ(global()["core:datatype"], "rf64_le");
  EXPECT_EQ(global()["core:num_channels"], 6);
}

TEST_F(SigmfWriterTest, KeepsTimesWhereNoRateIsKnown) {
  Capture before = converter_channels_only(counted_capture(rng_, 2000, 16, 5.0, 10000));
  before.meta.sample_rate_hz.reset();
  std::uniform_int_distribution<std::int64_t> step(0, 5'000'000);
  std::int64_t now = 12345;
  for (double &t : before.time_s)
    t = static_cast<double>(now += step(rng_)) / 1e9;
  expect_same(through(before), before);
  EXPECT_FALSE(global().contains("core:sample_rate"));
}

TEST_F(SigmfWriterTest, BeginsASegmentAtEachGap) {
  Capture before = converter_channels_only(counted_capture(rng_, 3000, 16, 5.0, 10000));
  for (std::size_t i = 1000; i < 3000; ++i)
    before.time_s[i] = static_cast<double>(i + 500) / 10000; // 500 samples are missing
  for (std::size_t i = 2500; i < 3000; ++i)
    before.time_s[i] = static_cast<double>(i + 501) / 10000; // and one more
  const Capture after = through(before);
  EXPECT_EQ(after.gaps, (std::vector<std::size_t>{1000, 2500}));
  EXPECT_EQ(after.identity, capture_identity(before));
  ASSERT_EQ(json_["captures"].size(), 3u);
  EXPECT_EQ(json_["captures"][1]["core:sample_start"], 1000);
  EXPECT_EQ(json_["captures"][1]["core:global_index"], 1500);
  EXPECT_EQ(json_["captures"][1]["ada4571:time_s"], 0.15);
  EXPECT_EQ(json_["captures"][2]["core:global_index"], 3001);
  EXPECT_EQ(global()["core:datatype"], "ru16_le");
}

TEST_F(SigmfWriterTest, KeepsGapsThatOnlyTheSourceKnew) {
  Capture before = converter_channels_only(counted_capture(rng_, 3000, 16, 5.0, 10000));
  before.gaps = {1, 1023, 1024, 1025, 2048, 2999};
  EXPECT_EQ(through(before).gaps, before.gaps);
}

TEST_F(SigmfWriterTest, TakesAClockWithGapsEverywhereAsIrregular) {
  Capture before = converter_channels_only(counted_capture(rng_, 20000, 16, 5.0, 10000));
  for (std::size_t i = 0; i < before.size(); ++i)
    before.time_s[i] = static_cast<double>(i) / 1000; // ten times slower than stated
  const Capture after = through(before);
  expect_same(after, before);
  EXPECT_EQ(global()["ada4571:channels"].back()["name"], "time_s");
}

TEST_F(SigmfWriterTest, CarriesAllMetadata) {
  Capture before = counted_capture(rng_, 10, 16, 5.0, 0.25); // below what core:sample_rate allows
  before.meta.gain_control = true;
  before.meta.noise_rms_v = 0.0005;
  before.meta.supply_v = 3.3;
  before.meta.periods_per_turn = 1;
  before.meta.serial = "007"; // a text, though it looks like a number
  before.meta.origin = "bench \"3\"";
  before.meta.other = {{"operator", "Ada"}, {"core:datatype", "42"}};
  const CaptureMetadata after = through(before).meta;
  EXPECT_EQ(after.gain_control, before.meta.gain_control);
  EXPECT_EQ(after.noise_rms_v, before.meta.noise_rms_v);
  EXPECT_EQ(after.supply_v, before.meta.supply_v);
  EXPECT_EQ(after.periods_per_turn, before.meta.periods_per_turn);
  EXPECT_EQ(after.sample_rate_hz, before.meta.sample_rate_hz);
  EXPECT_EQ(after.adc_bits, before.meta.adc_bits);
  EXPECT_EQ(after.adc_reference_v, before.meta.adc_reference_v);
  EXPECT_EQ(after.serial, before.meta.serial);
  EXPECT_EQ(after.origin, before.meta.origin);
  EXPECT_EQ(after.other, before.meta.other);
}

TEST_F(SigmfWriterTest, TextThroughSigmfIsTheSameText) {
  for (const bool all : {false, true}) {
    Capture before = counted_capture(rng_, 5000, 16, 5.0, 30000);
    if (!all)
      before = converter_channels_only(std::move(before));
    before.meta.other = {{"operator", "Ada"}};
    write_capture(before, folder_ / "a.csv");
    const Capture text = read_capture(folder_ / "a.csv");
    const Capture binary = through(text);
    EXPECT_EQ(binary.identity, text.identity);
    write_capture(binary, folder_ / "b.csv");
    EXPECT_EQ(read_file(folder_ / "b.csv"), read_file(folder_ / "a.csv"));
  }
}

TEST_F(SigmfWriterTest, EitherNameOfThePairWillDo) {
  const Capture before = counted_capture(rng_, 10, 16, 5.0, 100);
  write_capture(before, data_path_);
  EXPECT_EQ(read_capture(data_path_).identity, read_capture(meta_path_).identity);
}

TEST_F(SigmfWriterTest, NothingRemainsWithoutFinish) {
  Capture before = counted_capture(rng_, 9000, 16, 5.0, 10000);
  before.time_s[5000] += 2e-9; // recoded once
  {
    const auto writer = open_capture_writer(meta_path_, before.meta, ChannelSet::of(before));
    for (std::size_t i = 0; i < before.size(); ++i) {
      const Frame frame = frame_at(before, i);
      writer->write({&frame, 1});
    }
    EXPECT_FALSE(std::filesystem::exists(meta_path_));
    EXPECT_FALSE(std::filesystem::exists(data_path_));
  }
  EXPECT_TRUE(folder_.names().empty());
}

TEST_F(SigmfWriterTest, LeavesTwoFilesAndNoTemporary) {
  through(counted_capture(rng_, 10, 16, 5.0, 100));
  EXPECT_EQ(folder_.names().size(), 2u);
}

} // namespace
} // namespace ada::test

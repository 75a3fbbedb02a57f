// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// SigMF as others write it: by hand, beside what iio_readdev has recorded.

#include "recording/sigmf_reader.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "recording/captures.h"
#include "support/temp_folder.h"

namespace ada::test {
namespace {

/// Little-endian, whatever the order of this machine's own numbers.
template <class T> void append(std::string &out, T value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  if constexpr (std::endian::native == std::endian::big)
    std::reverse(std::begin(bytes), std::end(bytes));
  out.append(bytes, sizeof value);
}

std::string replaced(std::string text, const std::string &from, const std::string &to) {
  const auto at = text.find(from);
  if (at == text.npos)
    throw std::runtime_error("test: no " + from);
  return text.replace(at, from.size(), to);
}

class SigmfReaderTest : public testing::Test {
protected:
  Capture read(const std::string &meta, const std::string &data) {
    write_file(meta_path_, meta);
    write_file(data_path_, data);
    return read_capture(meta_path_);
  }
  /// The failure without the folder.
  std::string refusal(const std::string &meta, const std::string &data) {
    ada4571_status status = ADA4571_OK;
    const std::string message = failure([&] { read(meta, data); }, &status);
    EXPECT_EQ(status, ADA4571_ERROR_FORMAT) << message;
    return replaced(message, folder_ / "", "");
  }

  TempFolder folder_;
  std::string meta_path_ = folder_ / "c.sigmf-meta", data_path_ = folder_ / "c.sigmf-data";
};

/// The least that a user must write for two 16-bit channels.
const std::string kSmall = R"({
 "global": {
  "core:datatype": "ri16_le", "core:num_channels": 2, "core:sample_rate": 1000,
  "core:version": "1.2.0",
  "core:extensions": [{"name": "ada4571", "version": "1.0.0", "optional": true}],
  "ada4571:channels": [{"name": "vsin_v", "scale": 0.5, "unit": "mV"},
                       {"name": "vcos_v", "scale": 0.001, "offset": 100}]
 },
 "captures": [],
 "annotations": []
}
)";

std::string two_frames() {
  std::string data;
  for (const std::int16_t word : std::initializer_list<std::int16_t>{1000, -100, 2000, 400})
    append(data, word);
  return data;
}

TEST_F(SigmfReaderTest, ReadsTheLeastThatAUserWrites) {
  const Capture c = read(kSmall, two_frames());
  EXPECT_EQ(c.vsin_v, (std::vector<double>{1000 * 0.5e-3, 2000 * 0.5e-3}));
  EXPECT_EQ(c.vcos_v, (std::vector<double>{0.0, 0.5}));
  EXPECT_EQ(c.time_s, (std::vector<double>{0, 0.001}));
  EXPECT_EQ(c.meta.sample_rate_hz, 1000);
  EXPECT_EQ(c.meta.supply_v, 5.0);
}

TEST_F(SigmfReaderTest, ReadsWhatIioReaddevWritesWithATimestamp) {
  // Two 12-bit channels, left-aligned and big-endian, and the timestamp of today's clock, which
  // IIO aligns to eight bytes.
  const std::string meta = R"({"global": {
    "core:datatype": "ru8", "core:num_channels": 16, "core:version": "1.2.0",
    "core:extensions": [{"name": "ada4571", "version": "1.0.0", "optional": false}],
    "ada4571:frame_bytes": 16,
    "ada4571:supply_v": 3.3, "ada4571:periods_per_turn": 1, "ada4571:gain_control": "off",
    "ada4571:metadata": {"bench": "3"},
    "ada4571:channels": [
      {"name": "vsin_v", "type": "be:u12/16>>4", "scale": 0.8, "unit": "mV"},
      {"name": "vcos_v", "type": "be:s12/16>>4", "scale": 0.001, "offset": 2048},
      {"name": "timestamp_flags", "type": "le:u8/8>>0"},
      {"name": "time_s", "type": "le:s64/64>>0", "unit": "ns"}]}, "captures": [], "annotations": []})";
  std::string data;
  constexpr std::int64_t kNow = 1'790'000'000'123'456'789;
  for (int i = 0; i < 3; ++i) {
    append(data, __builtin_bswap16(static_cast<std::uint16_t>((1000 + i) << 4 | 0xf)));
    append(data, __builtin_bswap16(static_cast<std::uint16_t>((-48 + i) << 4)));
    data += std::string(4, '\xff'); // flags and padding
    append(data, kNow + i * std::int64_t{100'003});
  }
  const Capture c = read(meta, data);
  EXPECT_EQ(c.vsin_v, (std::vector<double>{1000 * 0.8e-3, 1001 * 0.8e-3, 1002 * 0.8e-3}));
  EXPECT_EQ(c.vcos_v, (std::vector<double>{2000 * 0.001, 2001 * 0.001, 2002 * 0.001}));
  EXPECT_EQ(c.time_s, (std::vector<double>{0, 100'003e-9, 200'006e-9}));
  EXPECT_EQ(c.ignored_columns, (std::vector<std::string>{"timestamp_flags"}));
  EXPECT_EQ(c.meta.supply_v, 3.3);
  EXPECT_EQ(c.meta.periods_per_turn, 1);
  EXPECT_EQ(c.meta.gain_control, false);
  EXPECT_EQ(c.meta.other, (std::vector<std::pair<std::string, std::string>>{{"bench", "3"}}));
}

TEST_F(SigmfReaderTest, TakesTimeFromTheSegments) {
  const std::string meta = replaced(kSmall, R"("captures": [])",
                                    R"("captures": [{"core:sample_start": 0, "ada4571:time_s": 7},
                               {"core:sample_start": 1, "core:global_index": 8000}])");
  const Capture c = read(meta, two_frames());
  EXPECT_EQ(c.time_s, (std::vector<double>{7, 15}));
  EXPECT_EQ(c.gaps, (std::vector<std::size_t>{1}));
}

TEST_F(SigmfReaderTest, ReadsFloatsOfBothSizesAndOrders) {
  const auto no_unit = [&](const std::string &datatype) {
    std::string text = replaced(kSmall, "ri16_le", datatype);
    text = replaced(text, R"(, "scale": 0.5, "unit": "mV")", "");
    return replaced(text, R"(, "scale": 0.001, "offset": 100)", "");
  };
  std::string floats, doubles, big;
  for (const double v : {1.25, 2.5}) {
    append(floats, static_cast<float>(v));
    append(doubles, v);
    std::uint32_t word;
    const auto single = static_cast<float>(v);
    std::memcpy(&word, &single, sizeof word);
    append(big, __builtin_bswap32(word));
  }
  for (const auto &[datatype, data] :
       {std::pair("rf32_le", floats), std::pair("rf64_le", doubles), std::pair("rf32_be", big)}) {
    const Capture c = read(no_unit(datatype), data);
    EXPECT_EQ(c.vsin_v, (std::vector<double>{1.25})) << datatype;
    EXPECT_EQ(c.vcos_v, (std::vector<double>{2.5})) << datatype;
  }
}

TEST_F(SigmfReaderTest, FindsADataFileOfAnotherName) {
  write_file(meta_path_,
             replaced(kSmall, R"("core:version")", R"("core:dataset": "raw.bin", "core:version")"));
  write_file(folder_ / "raw.bin", two_frames());
  EXPECT_EQ(read_capture(meta_path_).size(), 2u);
}

TEST_F(SigmfReaderTest, RefusesDataThatDoesNotFit) {
  EXPECT_EQ(refusal(kSmall, ""), "c.sigmf-data: there is no sample");
  EXPECT_EQ(refusal(kSmall, two_frames() + "x"),
            "c.sigmf-data: the file ends within a frame: 9 bytes are no whole number of frames of "
            "4 bytes");
  EXPECT_EQ(refusal(replaced(kSmall, R"("captures": [])",
                             R"("captures": [{"core:sample_start": 0}, {"core:sample_start": 2}])"),
                    two_frames()),
            "c.sigmf-data: a captures segment begins at sample 2, but there are 2");
  EXPECT_EQ(refusal(replaced(kSmall, R"("core:version")",
                             R"("ada4571:data_crc32": "00000000", "core:version")"),
                    two_frames()),
            "c.sigmf-data: the data does not fit the checksum in the meta file");
  EXPECT_EQ(
      refusal(replaced(kSmall, R"("core:sample_rate": 1000,)", ""), two_frames()),
      "c.sigmf-data: there is neither a channel time_s nor core:sample_rate in the meta file");
  EXPECT_EQ(refusal(replaced(kSmall, R"("captures": [])",
                             R"("captures": [{"core:sample_start": 0, "ada4571:time_s": 7},
                                {"core:sample_start": 1, "ada4571:time_s": 6.5}])"),
                    two_frames()),
            "c.sigmf-data: sample 1: time_s goes back from 7 to 6.5");
}

TEST_F(SigmfReaderTest, RefusesSamplesThatAreNoNumbers) {
  std::string text = replaced(kSmall, "ri16_le", "rf32_le");
  std::string data;
  append(data, 1.0f);
  append(data, std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(refusal(text, data), "c.sigmf-data: sample 0: vcos_v is not a number");
  data.clear();
  append(data, std::numeric_limits<float>::infinity());
  append(data, 1.0f);
  EXPECT_EQ(refusal(text, data), "c.sigmf-data: sample 0: vsin_v is out of range");
}

TEST_F(SigmfReaderTest, RefusesTimestampsBeyondAllRange) {
  const std::string meta = R"({"global": {
    "core:datatype": "ru8", "core:num_channels": 16, "core:version": "1.2.0",
    "core:extensions": [{"name": "ada4571", "version": "1.0.0", "optional": false}],
    "ada4571:frame_bytes": 16, "ada4571:channels": [
      {"name": "vsin_v", "type": "le:s16/16>>0", "scale": 1},
      {"name": "vcos_v", "type": "le:s16/16>>0", "scale": 1},
      {"name": "time_s", "type": "le:s64/64>>0"}]}})";
  std::string data(8, '\0');
  append(data, std::numeric_limits<std::int64_t>::min());
  data += std::string(8, '\0');
  append(data, std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(refusal(meta, data), "c.sigmf-data: sample 1: time_s is out of range");
}

struct MalformedMeta {
  const char *name, *from, *to, *message; ///< a change of kSmall and what it leads to
};

class SigmfMetaRefuses : public SigmfReaderTest,
                         public testing::WithParamInterface<MalformedMeta> {};

TEST_P(SigmfMetaRefuses, WithThePlace) {
  EXPECT_EQ(refusal(replaced(kSmall, GetParam().from, GetParam().to), two_frames()),
            std::string("c.sigmf-meta:") + GetParam().message);
}

const MalformedMeta kMalformedMeta[] = {
    {"NoJson", "\"captures\": [],", "\"captures\": [", // the bracket is never closed
     "10:15: this is no JSON: syntax error while parsing array - unexpected ':'; expected ']'"},
    {"Overflow", "0.5", "1e999", "6:52: number overflow parsing '1e999'"},
    {"NoGlobal", "\"global\"", "\"globe\"",
     "1:1: the object \"global\" is missing: this is no SigMF meta file"},
    {"NoDatatype", "core:datatype", "core:type", "2:12: core:datatype is missing"},
    {"Complex", "ri16_le", "ci16_le",
     "3:20: the datatype 'ci16_le' is none of the real ones of SigMF (ri16_le, ru16_be, rf32_le, "
     "ru8, ...)"},
    {"NoByteOrder", "ri16_le", "ri16",
     "3:20: the datatype 'ri16' is none of the real ones of SigMF (ri16_le, ru16_be, rf32_le, ru8, "
     "...)"},
    {"ChannelCount", "\"core:num_channels\": 2", "\"core:num_channels\": 3",
     "3:52: core:num_channels is 3, but ada4571:channels lists 2"},
    {"ChannelCountNegative", "\"core:num_channels\": 2", "\"core:num_channels\": -2",
     "3:52: core:num_channels must be a whole number from 0 to 4611686018427387904"},
    {"Rate", "1000", "\"fast\"",
     "3:75: sample_rate_hz must be a number from 0.000001 to 1000000000, not 'fast'"},
    {"Undeclared", "\"ada4571\", \"version\"", "\"other\", \"version\"",
     "5:22: core:extensions does not declare the extension ada4571, which names the channels"},
    {"NewerExtension", "1.0.0", "2.0.0",
     "5:23: only version 1 of the ada4571 extension is known here"},
    {"OtherExtension", "[{\"name\": \"ada4571\"",
     "[{\"name\": \"antenna\", \"optional\": false}, {\"name\": \"ada4571\"",
     "5:23: the extension 'antenna' is needed, and is not known here"},
    {"MissingChannel", "vcos_v", "voltage1", "6:23: the channel vcos_v is missing"},
    {"ChannelTwice", "vcos_v", "vsin_v", "7:24: the channel 'vsin_v' is there twice"},
    {"KeyTwice", "\"scale\": 0.5, ", "\"scale\": 0.5, \"scale\": 0.6, ",
     "6:57: the key \"scale\" is there twice"},
    {"NoScale", "\"scale\": 0.5, ", "", "6:24: the channel vsin_v has no scale"},
    {"ZeroScale", "0.5", "0", "6:52: the scale of vsin_v is zero"},
    {"ScaleText", "0.5", "\"0.5\"",
     "6:52: scale must be a number from -1000000000000 to 1000000000000"},
    {"Unit", "\"mV\"", "\"uV\"", "6:65: the unit of vsin_v must be V or mV"},
    {"Type", "\"scale\": 0.5", "\"type\": \"le:s16/32>>0\", \"scale\": 0.5",
     "6:51: the type le:s16/32>>0 does not fit core:datatype"},
    {"UnknownKey", "\"core:version\"", "\"ada4571:supply\": 5, \"core:version\"",
     "4:21: the key 'ada4571:supply' of the ada4571 extension is not known"},
    {"Supply", "\"core:version\"", "\"ada4571:supply_v\": -5, \"core:version\"",
     "4:23: supply_v must be a number from 0.000001 to 100, not '-5'"},
    {"HeaderBytes", "\"captures\": []",
     "\"captures\": [{\"core:sample_start\": 0, \"core:header_bytes\": 4}]",
     "9:61: core:header_bytes is not supported"},
    {"SegmentOrder", "\"captures\": []", "\"captures\": [{\"core:sample_start\": 1}]",
     "9:37: core:sample_start must be 0 in the first segment and grow from each to the next"},
    {"DatasetFolder", "\"core:version\"", "\"core:dataset\": \"../x\", \"core:version\"",
     "4:19: core:dataset must be a file name without a folder"},
    {"FrameBytes", "\"core:version\"", "\"ada4571:frame_bytes\": 4, \"core:version\"",
     "6:24: the channel 'vsin_v' has no type"},
};

INSTANTIATE_TEST_SUITE_P(MalformedMeta, SigmfMetaRefuses, testing::ValuesIn(kMalformedMeta),
                         [](const auto &test) { return test.param.name; });

TEST_F(SigmfReaderTest, SaysHowLongAFrameOfIioWouldBe) {
  const std::string meta = R"({"global": {
    "core:datatype": "ru8", "core:num_channels": 12, "core:version": "1.2.0",
    "core:extensions": [{"name": "ada4571", "version": "1.0.0", "optional": false}],
    "ada4571:frame_bytes": 12, "ada4571:channels": [
      {"name": "vsin_v", "type": "le:s16/16>>0", "scale": 1},
      {"name": "vcos_v", "type": "le:s16/16>>0", "scale": 1},
      {"name": "time_s", "type": "le:s64/64>>0"}]}})";
  EXPECT_EQ(
      refusal(meta, std::string(12, '\0')),
      "c.sigmf-meta:4:28: the channel 'time_s' does not fit into a frame of 12 bytes; laid out "
      "as IIO does, a frame has 16");
}

TEST_F(SigmfReaderTest, TellsAMissingFileByItsName) {
  ada4571_status status = ADA4571_OK;
  EXPECT_EQ(failure([&] { read_capture(meta_path_); }, &status),
            meta_path_ + ": cannot open: No such file or directory");
  write_file(meta_path_, kSmall);
  EXPECT_EQ(failure([&] { read_capture(meta_path_); }, &status),
            data_path_ + ": cannot open: No such file or directory");
  EXPECT_EQ(status, ADA4571_ERROR_NOT_FOUND);
}

} // namespace
} // namespace ada::test

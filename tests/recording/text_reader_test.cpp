// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/text_reader.h"

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "recording/captures.h"
#include "support/seed.h"
#include "support/temp_folder.h"

namespace ada::test {
namespace {

const std::string kHead = "# ada4571-capture/1\n";

Capture read(const std::string &content) {
  const TempFolder folder;
  write_file(folder / "c.csv", content);
  return read_text_capture(folder / "c.csv");
}

TEST(TextReader, ReadsTheExampleOfTheFormat) {
  const Capture c = read("# ada4571-capture/1\n"
                         "# supply_v = 5.0\n"
                         "# periods_per_turn = 2\n"
                         "# gain_control = on\n"
                         "# noise_rms_v = 0.0005\n"
                         "time_s,vsin_v,vcos_v,vtemp_v,vdd_v,reference_deg\n"
                         "0.000000,3.617706,1.552887,1.580811,5.00012,212.4879\n");
  EXPECT_EQ(c.meta.supply_v, 5.0);
  EXPECT_EQ(c.meta.periods_per_turn, 2);
  EXPECT_EQ(c.meta.gain_control, true);
  EXPECT_EQ(c.meta.noise_rms_v, 0.0005);
  ASSERT_EQ(c.size(), 1u);
  EXPECT_EQ(c.time_s[0], 0.0);
  EXPECT_EQ(c.vsin_v[0], 3.617706);
  EXPECT_EQ(c.vcos_v[0], 1.552887);
  EXPECT_EQ(c.vtemp_v[0], 1.580811);
  EXPECT_EQ(c.vdd_v[0], 5.00012);
  EXPECT_EQ(c.reference_deg[0], 212.4879);
}

// However a program prints a number, it is the double next to it, in every bit.
TEST(TextReader, ReadsEveryNumberAsStrtodDoes) {
  std::mt19937_64 rng(fresh_seed());
  const auto up_to = [&rng](int most) { return std::uniform_int_distribution<int>(0, most)(rng); };
  const auto drawn = [&](int most) {
    std::string digits;
    for (int n = up_to(most); n > 0; --n)
      digits += static_cast<char>('0' + up_to(9));
    return digits;
  };
  std::vector<std::string> numbers = {"0",
                                      "-0",
                                      "-0.0",
                                      "0.000000000000000000",
                                      "5.",
                                      ".5",
                                      "-.5",
                                      "1e-3",
                                      "+2",
                                      "00012.5",
                                      "999999.99999999999",
                                      "1.7976931348623157e-308",
                                      "4e-324",
                                      "123456789012345e-10"};
  while (numbers.size() < 3000) {
    std::string text = up_to(2) == 0 ? "-" : "";
    text += up_to(5) == 0 ? "000000000000" + drawn(5) : "1" + drawn(4);
    text += up_to(5) == 0 ? "" : "." + drawn(up_to(1) == 0 ? 9 : 20);
    text += up_to(9) == 0 ? "e-" + std::to_string(up_to(20)) : "";
    numbers.push_back(text);
  }
  std::string rows = kHead + "vsin_v,time_s,vcos_v\n"; // before a comma, and at the end of the line
  for (std::size_t k = 0; k < numbers.size(); ++k)
    rows += numbers[k] + "," + std::to_string(k) + "," + numbers[k] + "\n";
  const Capture c = read(rows);
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const double expected = std::strtod(numbers[k].c_str(), nullptr);
    for (const double got : {c.vsin_v[k], c.vcos_v[k]})
      EXPECT_EQ(std::bit_cast<std::uint64_t>(got), std::bit_cast<std::uint64_t>(expected))
          << numbers[k];
  }
}

TEST(TextReader, TakesDefaultsWhereNothingIsSaid) {
  const Capture c = read(kHead + "time_s,vsin_v,vcos_v\n0,1,2\n");
  EXPECT_EQ(c.meta.supply_v, 5.0);
  EXPECT_EQ(c.meta.periods_per_turn, 2);
  EXPECT_FALSE(c.meta.gain_control || c.meta.noise_rms_v || c.meta.sample_rate_hz ||
               c.meta.adc_bits || c.meta.adc_reference_v);
  EXPECT_FALSE(c.has_vtemp() || c.has_vdd() || c.has_reference());
}

TEST(TextReader, TakesColumnsInAnyOrderAndIgnoresUnknownOnesByName) {
  const Capture c = read(kHead + "note,vcos_v,time_s,rpm,vsin_v\nany text,2,0,60,1\n\"x,4,1,,3\n");
  EXPECT_EQ(c.vsin_v, (std::vector<double>{1, 3}));
  EXPECT_EQ(c.vcos_v, (std::vector<double>{2, 4}));
  EXPECT_EQ(c.time_s, (std::vector<double>{0, 1}));
  EXPECT_EQ(c.ignored_columns, (std::vector<std::string>{"note", "rpm"}));
}

TEST(TextReader, KeepsUnknownMetadataInOrder) {
  const Capture c = read(kHead + "# operator = Ada = L\n# serial = S1\n# bench=3\n#\n"
                                 "time_s,vsin_v,vcos_v\n0,1,2\n");
  EXPECT_EQ(c.meta.serial, "S1");
  const std::vector<std::pair<std::string, std::string>> expected{{"operator", "Ada = L"},
                                                                  {"bench", "3"}};
  EXPECT_EQ(c.meta.other, expected);
}

TEST(TextReader, ToleratesCrLfByteOrderMarkBlanksAndAMissingLastLineEnd) {
  const Capture c = read("\xEF\xBB\xBF# ada4571-capture/1\r\n# serial = S1\r\n"
                         " time_s , vsin_v\t,vcos_v\r\n 0 , +1,\t2 \r\n1,3,4");
  EXPECT_EQ(c.meta.serial, "S1");
  EXPECT_EQ(c.vsin_v, (std::vector<double>{1, 3}));
  EXPECT_EQ(c.vcos_v, (std::vector<double>{2, 4}));
}

TEST(TextReader, ToleratesEmptyLinesAtTheEndOnly) {
  EXPECT_EQ(read(kHead + "time_s,vsin_v,vcos_v\n0,1,2\n\n  \n").size(), 1u);
}

TEST(TextReader, TakesEqualTimesAsBurstsOfARealClock) {
  EXPECT_EQ(read(kHead + "time_s,vsin_v,vcos_v\n0,1,2\n0,1,2\n0,1,2\n").size(), 3u);
}

TEST(TextReader, FindsGapsWhereTheRateIsKnown) {
  const std::string rows = "time_s,vsin_v,vcos_v\n0,1,2\n0.1,1,2\n0.2,1,2\n0.4,1,2\n0.5,1,2\n";
  EXPECT_EQ(read(kHead + "# sample_rate_hz = 10\n" + rows).gaps, (std::vector<std::size_t>{3}));
  EXPECT_TRUE(read(kHead + rows).gaps.empty());
}

TEST(TextReader, ReadsAPipeLikeAFile) {
  std::string content = kHead + "time_s,vsin_v,vcos_v\n";
  for (int i = 0; i < 50000; ++i)
    content += std::to_string(i) + ",1.25,2.5\n";
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  std::thread writer([&] {
    for (std::size_t at = 0; at < content.size();) {
      const ssize_t n =
          ::write(ends[1], content.data() + at, std::min<std::size_t>(999, content.size() - at));
      if (n <= 0)
        break;
      at += static_cast<std::size_t>(n);
    }
    ::close(ends[1]);
  });
  const Capture c = read_text_capture(ends[0], "pipe");
  writer.join();
  ::close(ends[0]);
  ASSERT_EQ(c.size(), 50000u);
  EXPECT_EQ(c.time_s.back(), 49999);
  EXPECT_EQ(c.vcos_v.back(), 2.5);
}

struct Malformed {
  const char *name, *content, *message; ///< the message after the file's name
};

class TextReaderRefuses : public testing::TestWithParam<Malformed> {};

TEST_P(TextReaderRefuses, WithThePlace) {
  ada4571_status status = ADA4571_OK;
  const TempFolder folder;
  const std::string path = folder / "c.csv";
  write_file(path, GetParam().content);
  EXPECT_EQ(failure([&] { read_text_capture(path); }, &status), path + GetParam().message);
  EXPECT_EQ(status, ADA4571_ERROR_FORMAT);
}

#define HEAD "# ada4571-capture/1\n"
#define COLUMNS HEAD "time_s,vsin_v,vcos_v\n"

const Malformed kMalformed[] = {
    {"Empty", "", ":1:1: the file is empty"},
    {"OtherFile", "time_s,vsin_v\n",
     ":1:1: this is no capture: the first line must be '# ada4571-capture/1', not 'time_s,vsin_v'"},
    {"Binary",
     "\x7f"
     "ELF\x01",
     ":1:1: this is no capture: the first line must be '# ada4571-capture/1', not '?ELF?'"},
    {"NewerVersion", "# ada4571-capture/2\n",
     ":1:19: format version '2' is not known here, only version 1 is"},
    {"NoHeader", HEAD "# serial = 1\n",
     ":2:1: the file ends before the header line with the column names"},
    {"NoEquals", HEAD "# supply_v 3.3\n", ":2:1: expected '# key = value', not '# supply_v 3.3'"},
    {"KeyTwice", HEAD "# a = 1\n# a = 1\n", ":3:3: the key 'a' is given twice"},
    {"KnownKeyTwice", HEAD "# supply_v = 5\n# supply_v = 3\n",
     ":3:3: the key 'supply_v' is given twice"},
    {"EmptyKey", HEAD "# = 1\n", ":2:5: a key is empty"},
    {"Supply", HEAD "#  supply_v = 5 V\n",
     ":2:15: supply_v must be a number from 0.000001 to 100, not '5 V'"},
    {"SupplyZero", HEAD "# supply_v = 0\n",
     ":2:14: supply_v must be a number from 0.000001 to 100, not '0'"},
    {"RateDenormal", HEAD "# sample_rate_hz = 1e-320\n",
     ":2:20: sample_rate_hz must be a number from 0.000001 to 1000000000, not '1e-320'"},
    {"SupplyDenormal", HEAD "# supply_v = 1e-320\n",
     ":2:14: supply_v must be a number from 0.000001 to 100, not '1e-320'"},
    {"Latin1", HEAD "# serial = Pr\xfc" "f\n", ":2:12: the line of 'serial' is not in UTF-8: 'Pr?f'"},
    {"Latin1OfAnUnknownKey", HEAD "# bench = Pr\xfc" "f\n",
     ":2:11: the line of 'bench' is not in UTF-8: 'Pr?f'"},
    {"Periods", HEAD "# periods_per_turn = 1.5\n",
     ":2:22: periods_per_turn must be a whole number from 1 to 65536, not '1.5'"},
    {"GainControl", HEAD "# gain_control = yes\n",
     ":2:18: gain_control must be on or off, not 'yes'"},
    {"Rate", HEAD "# sample_rate_hz = inf\n",
     ":2:20: sample_rate_hz must be a number from 0.000001 to 1000000000, not 'inf'"},
    {"MissingColumn", HEAD "time_s,vsin_v\n0,1\n",
     ":2:1: the column vcos_v is missing from the header 'time_s,vsin_v'"},
    {"ColumnTwice", HEAD "time_s,vsin_v,vcos_v,vsin_v\n",
     ":2:22: the column 'vsin_v' is there twice"},
    {"UnknownColumnTwice", HEAD "x,x,time_s,vsin_v,vcos_v\n",
     ":2:3: the column 'x' is there twice"},
    {"NamelessColumn", HEAD "time_s,vsin_v,vcos_v,\n", ":2:22: a column has no name"},
    {"EmptyHeader", HEAD "\n0,1,2\n", ":2:1: a column has no name"},
    {"NoRows", COLUMNS, ":2:1: there is no row after the header line"},
    {"OnlyBlankRows", COLUMNS "\n\n", ":4:1: there is no row after the header line"},
    {"ShortRow", COLUMNS "0,1,2\n1,2\n", ":4:4: the row has 2 cells, the header 3"},
    {"LongRow", COLUMNS "0,1,2,3\n", ":3:8: the row has 4 cells, the header 3"},
    {"CutRow", COLUMNS "0,1,2\n0.1,2.", ":4:7: the row has 2 cells, the header 3"},
    {"EmptyCell", COLUMNS "0,,2\n", ":3:3: vsin_v is missing"},
    {"BlankCell", COLUMNS "0,1,  \n", ":3:7: vcos_v is missing"},
    {"Word", COLUMNS "0,one,2\n", ":3:3: vsin_v is not a number: 'one'"},
    {"Trailing", COLUMNS "0,1.5V,2\n", ":3:3: vsin_v is not a number: '1.5V'"},
    {"TwoSigns", COLUMNS "0,+-1,2\n", ":3:3: vsin_v is not a number: '+-1'"},
    {"DecimalComma", COLUMNS "0,1;5,2\n", ":3:3: vsin_v is not a number: '1;5'"},
    {"NotANumber", COLUMNS "0,1,nan\n", ":3:5: vcos_v is not a number: 'nan'"},
    {"Infinite", COLUMNS "-inf,1,2\n", ":3:1: time_s is out of range: '-inf'"},
    {"Overflow", COLUMNS "0,1e999,2\n", ":3:3: vsin_v is out of range: '1e999'"},
    {"Milliseconds", COLUMNS "1760000000000,1,2\n",
     ":3:1: time_s is out of range, it looks like milliseconds since 1970: give seconds, from any "
     "origin: '1760000000000'"},
    {"Microseconds", COLUMNS "1760000000000000,1,2\n",
     ":3:1: time_s is out of range, it looks like microseconds since 1970: give seconds, from any "
     "origin: '1760000000000000'"},
    {"Nanoseconds", COLUMNS "1.76e18,1,2\n",
     ":3:1: time_s is out of range, it looks like nanoseconds since 1970: give seconds, from any "
     "origin: '1.76e18'"},
    {"HugeVolts", COLUMNS "0,1e7,2\n", ":3:3: vsin_v is out of range: '1e7'"},
    {"Control", COLUMNS "0,1\x01,2\n", ":3:3: vsin_v is not a number: '1?'"},
    {"TimeGoesBack", HEAD "vsin_v,vcos_v,time_s\n1,2,3\n1,2,2.5\n",
     ":4:5: time_s goes back from 3 to 2.5"},
    {"LateMetadata", COLUMNS "0,1,2\n# serial = 1\n",
     ":4:1: metadata must stand before the header line"},
    {"EmptyLineInside", COLUMNS "0,1,2\n\n1,1,2\n", ":5:1: rows go on after the empty line 4"},
};

INSTANTIATE_TEST_SUITE_P(Malformed, TextReaderRefuses, testing::ValuesIn(kMalformed),
                         [](const auto &test) { return test.param.name; });

// What is read without looking for the end of a row first, as it stands before many more, is
// refused as anywhere else.
TEST(TextReader, RefusesARowAmongManyWithItsPlace) {
  const struct {
    const char *header, *row, *message;
  } cases[] = {
      {"time_s,vsin_v,vcos_v", "0.5,1.25", ":503:9: the row has 2 cells, the header 3"},
      {"time_s,vsin_v,vcos_v", "0.5,1.25,2.5,7", ":503:15: the row has 4 cells, the header 3"},
      {"time_s,vsin_v,vcos_v", "0.4,1.25,2.5", ":503:1: time_s goes back from 0.5 to 0.4"},
      {"time_s,vsin_v,vcos_v", "0.5,1.25x,2.5", ":503:5: vsin_v is not a number: '1.25x'"},
      {"time_s,vsin_v,vcos_v", "0.5,,2.5", ":503:5: vsin_v is missing"},
      {"time_s,vsin_v,vcos_v", "#0.5,1.25,2.5",
       ":503:1: metadata must stand before the header line"},
      {"time_s,vsin_v,vcos_v", "", ":504:1: rows go on after the empty line 503"},
      // Columns that are passed over end with their row, too.
      {"time_s,a,b,vsin_v,vcos_v", "0.5,1,1.25,2.5", ":503:15: the row has 4 cells, the header 5"},
      {"time_s,vsin_v,vcos_v,a", "0.5,1.25,2.5", ":503:13: the row has 3 cells, the header 4"},
      {"a,time_s,vsin_v,vcos_v", "#1,0.5,1.25,2.5",
       ":503:1: metadata must stand before the header line"},
  };
  for (const auto &c : cases) {
    const std::string header = c.header;
    const auto row_of = [&](const char *time) {
      std::string row = header;
      for (const auto &[name, value] :
           {std::pair("time_s", time), std::pair("vsin_v", "1.25"), std::pair("vcos_v", "2.5")})
        row.replace(row.find(name), 6, value);
      return row + "\n";
    };
    std::string content = kHead + header + "\n";
    for (int i = 0; i < 500; ++i)
      content += row_of("0.5");
    content += std::string(c.row) + "\n";
    for (int i = 0; i < 500; ++i)
      content += row_of("0.5");
    const TempFolder folder;
    const std::string path = folder / "c.csv";
    write_file(path, content);
    EXPECT_EQ(failure([&] { read_text_capture(path); }), path + c.message) << c.row;
  }
}

TEST(TextReader, RefusesALineWithoutEndInBoundedMemory) {
  EXPECT_EQ(failure([] { read_text_capture("/dev/zero"); }),
            "/dev/zero:1:1: the line is longer than 65536 bytes");
}

TEST(TextReader, RefusesEndlessMetadata) {
  std::string content = kHead;
  for (int i = 0; content.size() < (2u << 20); ++i)
    content += "# key" + std::to_string(i) + " = some text\n";
  EXPECT_NE(failure([&] { read(content); }).find("the metadata is longer than 1048576 bytes"),
            std::string::npos);
}

TEST(TextReader, TellsAMissingFileFromABadOne) {
  ada4571_status status = ADA4571_OK;
  EXPECT_EQ(failure([] { read_text_capture("/nowhere/c.csv"); }, &status),
            "/nowhere/c.csv: cannot open: No such file or directory");
  EXPECT_EQ(status, ADA4571_ERROR_NOT_FOUND);
}

} // namespace
} // namespace ada::test

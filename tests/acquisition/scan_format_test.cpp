// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <random>

#include "acquisition/scan_format.h"
#include "base/error.h"
#include "support/seed.h"

using namespace ada;

namespace {

/// The value of an element by its definition, bit after bit: slow, and nothing in common with the
/// decoder. Exact until it becomes a double: sums of powers of two, modulo 2^64.
double value_by_definition(const std::byte *p, const ScanFormat &f) {
  std::uint64_t value = 0;
  for (unsigned bit = 0; bit < f.bits; ++bit) {
    const unsigned place = bit + f.shift;
    const unsigned byte = f.big_endian ? f.word_bytes() - 1 - place / 8 : place / 8;
    if ((std::to_integer<unsigned>(p[byte]) >> (place % 8)) & 1u) {
      const std::uint64_t weight = std::uint64_t{1} << bit;
      value += f.is_signed && bit + 1 == f.bits ? 0 - weight : weight;
    }
  }
  return f.is_signed ? static_cast<double>(static_cast<std::int64_t>(value))
                     : static_cast<double>(value);
}

/// The byte order of this machine's own numbers.
constexpr bool kNative = std::endian::native == std::endian::big;

std::vector<ScanFormat> every_format() {
  std::vector<ScanFormat> formats;
  for (const unsigned storage : {8u, 16u, 32u, 64u})
    for (unsigned bits = 1; bits <= storage; ++bits)
      for (unsigned shift = 0; shift + bits <= storage; ++shift)
        for (const bool is_signed : {false, true})
          for (const bool big_endian : {false, true})
            formats.push_back({bits, storage, shift, 1, is_signed, big_endian});
  return formats;
}

TEST(ScanFormat, EveryWidthShiftSignAndByteOrderDecodesToItsDefinition) {
  std::mt19937_64 random(test::fresh_seed());
  std::size_t tried = 0;
  for (const ScanFormat &f : every_format()) {
    const ElementDecoder decoder(f, {0.0, 1.0}, "c");
    // Random words, and the ends of the range.
    for (int k = 0; k < 6; ++k) {
      std::uint64_t word = random();
      if (k == 0)
        word = 0;
      if (k == 1)
        word = ~std::uint64_t{0};
      std::byte bytes[8];
      std::memcpy(bytes, &word, 8);
      double volts = 0;
      decoder.volts(bytes, 8, 1, &volts, 1);
      ASSERT_EQ(volts, value_by_definition(bytes, f)) << to_string(f);
      ++tried;
    }
  }
  EXPECT_GT(tried, 60000u);
}

TEST(ScanFormat, RawGivesTheIntegerItself) {
  const std::byte bytes[] = {std::byte{0xff}, std::byte{0xff}, std::byte{0x12}, std::byte{0x30}};
  EXPECT_EQ(ElementDecoder({16, 16, 0, 1, true, false}, {}, "c").raw(bytes), -1);
  EXPECT_EQ(ElementDecoder({16, 16, 0, 1, false, false}, {}, "c").raw(bytes), 65535);
  EXPECT_EQ(ElementDecoder({12, 16, 4, 1, false, true}, {}, "c").raw(bytes + 2), 0x123);
}

TEST(ScanFormat, VoltsAreRawPlusOffsetTimesScale) {
  const std::int16_t raw = -1000;
  std::byte bytes[2];
  std::memcpy(bytes, &raw, 2);
  const ElementDecoder decoder({16, 16, 0, 1, true, kNative}, {32768.0, 0.25e-3}, "c");
  double volts = 0;
  decoder.volts(bytes, 2, 1, &volts, 1);
  EXPECT_EQ(volts, 31768.0 * 0.25e-3);
}

TEST(ScanFormat, ARepeatedElementGivesTheMeanOfItsWords) {
  const std::uint16_t words[] = {10, 20, 30, 60};
  std::byte bytes[8];
  std::memcpy(bytes, words, 8);
  const ElementDecoder decoder({16, 16, 0, 4, false, kNative}, {0.0, 1.0}, "c");
  double volts = 0;
  decoder.volts(bytes, 8, 1, &volts, 1);
  EXPECT_EQ(volts, 30.0);
}

TEST(ScanFormat, ABlockIsDecodedWithItsStrides) {
  std::vector<std::byte> bytes(10 * 12);
  for (std::uint16_t i = 0; i < 10; ++i)
    std::memcpy(bytes.data() + 12 * i + 4, &i, 2);
  std::vector<double> out(30, -1.0);
  const ElementDecoder decoder({16, 16, 0, 1, false, kNative}, {0.0, 1.0}, "c");
  decoder.volts(bytes.data() + 4, 12, 10, out.data(), 3);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(out[3 * i], static_cast<double>(i));
    EXPECT_EQ(out[3 * i + 1], -1.0); // what lies between is not touched
  }
}

TEST(ScanFormat, TextIsReadAsTheKernelWritesIt) {
  EXPECT_EQ(parse_scan_format("le:s12/16>>4\n"), (ScanFormat{12, 16, 4, 1, true, false}));
  EXPECT_EQ(parse_scan_format("be:u24/32>>8"), (ScanFormat{24, 32, 8, 1, false, true}));
  EXPECT_EQ(parse_scan_format("le:s16/16X4>>0"), (ScanFormat{16, 16, 0, 4, true, false}));
  EXPECT_EQ(parse_scan_format("le:S64/64>>0"), (ScanFormat{64, 64, 0, 1, true, false}));
  EXPECT_EQ(parse_scan_format("le:U8/8"), (ScanFormat{8, 8, 0, 1, false, false}));
}

TEST(ScanFormat, TextAndFormatAreEachOthersInverse) {
  for (const ScanFormat &f : every_format())
    ASSERT_EQ(parse_scan_format(to_string(f)), f);
}

TEST(ScanFormat, WrongTextIsRefusedWithTheText) {
  for (const char *text : {"", "le", "xe:s12/16>>4", "le:x12/16>>4", "le:s/16>>4", "le:s12",
                           "le:s12/", "le:s12/16>>", "le:s12/16>>4x", "le:s12/16X>>4",
                           "le:s-1/16>>0", "le:s99999999999/16>>0", "le:s12/16>>4 4"}) {
    try {
      parse_scan_format(text);
      FAIL() << text;
    } catch (const Error &e) {
      EXPECT_EQ(e.status(), ADA4571_ERROR_FORMAT);
      EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
    }
  }
}

TEST(ScanFormat, FormatsThatNoDriverCanMeanAreRefusedWithTheChannel) {
  for (const ScanFormat f :
       {ScanFormat{12, 24, 0, 1, false, false}, ScanFormat{12, 0, 0, 1, false, false},
        ScanFormat{0, 16, 0, 1, false, false}, ScanFormat{17, 16, 0, 1, false, false},
        ScanFormat{12, 16, 5, 1, false, false}, ScanFormat{12, 16, 4000000000u, 1, false, false},
        ScanFormat{16, 16, 0, 0, false, false}, ScanFormat{16, 16, 0, 3, false, false},
        ScanFormat{16, 16, 0, 128, false, false}, ScanFormat{65, 128, 0, 1, false, false}}) {
    try {
      ElementDecoder(f, {}, "voltage7");
      FAIL() << to_string(f);
    } catch (const Error &e) {
      EXPECT_EQ(e.status(), ADA4571_ERROR_UNSUPPORTED);
      EXPECT_NE(std::string(e.what()).find("voltage7"), std::string::npos);
    }
  }
}

/// iio_compute_scan_bytes() of the kernel, as it is written there.
std::size_t kernel_frame_bytes(const std::vector<ScanFormat> &elements) {
  std::size_t bytes = 0, largest = 0;
  for (const ScanFormat &f : elements) {
    const std::size_t length = f.storage / 8 * f.repeat;
    bytes = (bytes + length - 1) & ~(length - 1);
    bytes += length;
    largest = std::max(largest, length);
  }
  return largest ? (bytes + largest - 1) & ~(largest - 1) : 0;
}

TEST(FrameLayout, AgreesWithTheKernelForRandomScans) {
  std::mt19937_64 random(test::fresh_seed());
  for (int k = 0; k < 5000; ++k) {
    std::vector<ScanFormat> scan(1 + test::below(random, 8));
    for (ScanFormat &f : scan) {
      f.storage = 8u << (random() % 4);
      f.repeat = 1u << (random() % 3);
      f.bits = f.storage;
    }
    const FrameLayout layout = compute_layout(scan);
    ASSERT_EQ(layout.frame_bytes, kernel_frame_bytes(scan));
    std::size_t end = 0;
    for (std::size_t i = 0; i < scan.size(); ++i) {
      ASSERT_EQ(layout.offsets[i] % scan[i].element_bytes(), 0u);
      ASSERT_GE(layout.offsets[i], end);
      ASSERT_LT(layout.offsets[i], end + scan[i].element_bytes());
      end = layout.offsets[i] + scan[i].element_bytes();
    }
  }
}

TEST(FrameLayout, AnElementSmallerThanTheLargestPadsTheFrame) {
  // The scan that libiio 0.24 takes for 6 bytes.
  const FrameLayout layout = compute_layout(
      std::vector<ScanFormat>{{32, 32, 0, 1, false, false}, {16, 16, 0, 1, false, false}});
  EXPECT_EQ(layout.frame_bytes, 8u);
  EXPECT_EQ(layout.offsets, (std::vector<std::size_t>{0, 4}));
}

} // namespace

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// numpy's own files are imported by tests/cli/import.sh; here is what numpy would not write.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "imported.h"

using namespace ada;
using namespace ada::test;

namespace {

std::string npy(const std::string &header, const std::string &data, char version = 1) {
  std::string out = "\x93NUMPY";
  out += version;
  out += '\0';
  out += static_cast<char>(header.size() & 0xff);
  out += static_cast<char>(header.size() >> 8);
  if (version > 1)
    out += std::string(2, '\0');
  return out + header + data;
}

/// Little-endian, whatever the order of this machine's own numbers.
std::string doubles(const std::vector<double> &values) {
  std::string out(values.size() * sizeof(double), '\0');
  std::memcpy(out.data(), values.data(), out.size());
  if constexpr (std::endian::native == std::endian::big)
    for (auto number = out.begin(); number != out.end(); number += sizeof(double))
      std::reverse(number, number + sizeof(double));
  return out;
}

const std::vector<double> kTable = {0, 1.5, 2.5, 0.1, 1.75, 2.25, 0.2, 2, 2};
const std::string kHeader = "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 3), }\n";

ImportOptions numbered() {
  ImportOptions options = pair("2", "3");
  options.columns[0].column = "1";
  return options;
}

TEST(NumpyImport, ATableInEitherOrderOfMemory) {
  for (const char version : {'\1', '\2', '\3'}) {
    const Imported got = import_text(npy(kHeader, doubles(kTable), version), numbered());
    ASSERT_EQ(got.frames.size(), 3u) << got.error;
    EXPECT_EQ(got.frames[2].time_s, 0.2);
    EXPECT_EQ(got.frames[1].vsin_v, 1.75);
    EXPECT_NEAR(got.meta.sample_rate_hz.value_or(0), 10.0, 1e-12);
  }
  ImportOptions untimed = numbered();
  untimed.columns[0].column = "";
  const Imported without = import_text(npy(kHeader, doubles(kTable), '\1'), untimed);
  EXPECT_NE(without.error.find("--rate"), without.error.npos) << without.error;
  EXPECT_TRUE(without.frames.empty());
  const Imported fortran =
      import_text(npy("{'descr': '<f8', 'fortran_order': True, 'shape': (3, 3), }\n",
                      doubles({0, 0.1, 0.2, 1.5, 1.75, 2, 2.5, 2.25, 2})),
                  numbered());
  ASSERT_EQ(fortran.frames.size(), 3u) << fortran.error;
  EXPECT_EQ(fortran.frames[1].vcos_v, 2.25);
}

TEST(NumpyImport, RecordsWithNamesAndIntegersInBigEndian) {
  const std::string header = "{'descr': [('sin_mV', '>i2'), ('cos_mV', '|u1')], 'fortran_order': "
                             "False, 'shape': (2,), }\n";
  ImportOptions options;
  options.sample_rate_hz = 100.0;
  const Imported got =
      import_text(npy(header, std::string("\xff\x9c\x05\x00\x64\x07", 6)), options);
  ASSERT_EQ(got.frames.size(), 2u) << got.error;
  EXPECT_DOUBLE_EQ(got.frames[0].vsin_v, -0.1);
  EXPECT_DOUBLE_EQ(got.frames[1].vcos_v, 0.007);
}

TEST(NumpyImport, WhatIsCutShortOrHostileIsRefused) {
  const std::string good = npy(kHeader, doubles(kTable));
  for (std::size_t n = 0; n < good.size(); ++n)
    EXPECT_NE(import_text(good.substr(0, n), numbered()).status, ADA4571_OK) << n;
  const auto status = [&](const std::string &header) {
    return import_text(npy(header, doubles(kTable)), numbered()).status;
  };
  EXPECT_EQ(status("{'descr': '|O', 'fortran_order': False, 'shape': (3, 3), }\n"),
            ADA4571_ERROR_FORMAT);
  EXPECT_EQ(
      status("{'descr': '<f8', 'fortran_order': False, 'shape': (4294967296, 4294967296), }\n"),
      ADA4571_ERROR_FORMAT);
  EXPECT_EQ(status("{'descr': '<f8', 'fortran_order': False, 'shape': (3, 3, 1), }\n"),
            ADA4571_ERROR_FORMAT);
  EXPECT_EQ(status("{'descr': '<f8', 'fortran_order': False}\n"), ADA4571_ERROR_FORMAT);
  auto nan = kTable;
  nan[4] = NAN;
  const Imported got = import_text(npy(kHeader, doubles(nan)), numbered());
  EXPECT_EQ(got.error, "file: sample 1, vsin_v: not a finite number");
}

} // namespace

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Columns by vectors against the same formulas number by number, on every instruction set: equal to
// the last bit, and nothing read or written beyond the end.

#include "base/columns_of_numbers.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "conversion/vector_kernels.h"
#include "recording/fixed_point.h"
#include "support/seed.h"

namespace ada::test {
namespace {

class ColumnsOfNumbers : public testing::TestWithParam<std::string> {
protected:
  void SetUp() override { use_vector_target(GetParam()); }
  void TearDown() override { use_vector_target(""); }
  std::mt19937_64 rng_{fresh_seed()};
};

constexpr double kUntouched = 12345.0;

TEST_P(ColumnsOfNumbers, WordsAreThoseOfTheFormula) {
  if (!has_vectors_for(4))
    GTEST_SKIP() << "one by one on this machine";
  for (const std::size_t stride : {std::size_t{4}, std::size_t{8}})
    for (const std::size_t count : {0u, 1u, 2u, 7u, 8u, 9u, 100u})
      for (const bool is_signed : {false, true}) {
        const unsigned bits = std::uniform_int_distribution<unsigned>(1, 16)(rng_);
        const unsigned shift = std::uniform_int_distribution<unsigned>(0, 16 - bits)(rng_);
        const Word16 word{is_signed, 16 - bits - shift, 16 - bits};
        // Not a byte more than the words need: a sanitizer sees what goes beyond.
        std::vector<std::uint8_t> bytes(count == 0 ? 0 : (count - 1) * stride + 2);
        for (std::uint8_t &b : bytes)
          b = static_cast<std::uint8_t>(rng_());
        std::vector<double> out(count + 1, kUntouched);
        scaled_words16(bytes.data(), stride, count, word, -2.5, 0.3, out.data());
        for (std::size_t i = 0; i < count; ++i) {
          std::uint16_t raw;
          std::memcpy(&raw, &bytes[i * stride], sizeof raw);
          const auto high = static_cast<std::uint16_t>(raw << word.left);
          const double number =
              is_signed ? static_cast<std::int16_t>(high) >> word.right : high >> word.right;
          ASSERT_EQ(out[i], (number - 2.5) * 0.3)
              << i << " of " << count << ", " << bits << " bits";
        }
        EXPECT_EQ(out[count], kUntouched);
      }
}

TEST_P(ColumnsOfNumbers, TimesAreThoseOfTheFormula) {
  for (const std::size_t count : {0u, 1u, 7u, 8u, 100u}) {
    std::vector<double> out(count + 1, kUntouched);
    const std::uint64_t first = rng_() >> 24;
    regular_times(0.7, first, 12345.678, count, out.data());
    for (std::size_t i = 0; i < count; ++i)
      ASSERT_EQ(out[i], 0.7 + static_cast<double>(first + i) / 12345.678);
    EXPECT_EQ(out[count], kUntouched);
  }
}

TEST_P(ColumnsOfNumbers, StepsAreThoseOfFixedPoint) {
  std::vector<double> in = {0.0,      -0.0,      0.5e-6,       -0.5e-6, 1.5e-6,
                            2.5e-6,   -2.5e-6,   0.4999e-6,    8e9,     -8e9,
                            INFINITY, -INFINITY, std::nan(""), 1e-300,  3.0000005};
  std::uniform_real_distribution<double> volts(-6, 6);
  while (in.size() < 1003)
    in.push_back(volts(rng_));
  for (const double scale : {1e4, 1e6, 1e9})
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, in.size()}) {
      std::vector<std::int64_t> out(count + 1, 7);
      decimal_steps(in.data(), scale, count, out.data());
      for (std::size_t i = 0; i < count; ++i)
        ASSERT_EQ(out[i], std::isfinite(in[i]) ? to_steps(in[i], scale)
                                               : std::numeric_limits<std::int64_t>::min())
            << in[i] << " by " << scale;
      EXPECT_EQ(out[count], 7);
    }
}

INSTANTIATE_TEST_SUITE_P(Every, ColumnsOfNumbers, testing::ValuesIn(vector_targets()),
                         [](const auto &target) { return target.param; });

} // namespace
} // namespace ada::test

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "model/residual.h"
#include "support/seed.h"

namespace ada::test {
namespace {

// A joint visits a few stretches of the turn: the step is counted over wide gaps of rounded values.
TEST(ReferenceGrid, is_found_in_parts_of_a_turn_with_few_decimals) {
  std::mt19937_64 rng(fresh_seed());
  const auto within = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(rng);
  };
  for (int draw = 0; draw < 200; ++draw) {
    const double counts = std::floor(std::pow(2.0, within(7.0, 14.0)));
    const double step = 360.0 / counts, decimal = std::pow(10.0, std::floor(within(-5.0, -2.0)));
    if (decimal > 0.01 * step) // more of it hides the steps
      continue;
    std::vector<double> reference;
    for (int stretch = 0; stretch < 3; ++stretch) {
      const double from = within(0.0, 330.0), width = within(5.0, 30.0);
      for (int i = 0; i < 400; ++i) {
        const double true_deg = from + width * std::pow(std::sin(0.01 * i), 2);
        reference.push_back(std::round(std::round(true_deg / step) * step / decimal) * decimal);
      }
    }
    EXPECT_NEAR(reference_grid_rad(reference) * kDegPerRad, step, 1e-3 * step)
        << counts << " counts in steps of " << decimal << " deg";
  }
}

// A count that ties at the last decimal goes up or down by what went before it.
TEST(ReferenceGrid, is_found_where_counts_are_written_in_two_ways) {
  std::mt19937_64 rng(fresh_seed());
  std::uniform_real_distribution<> unit(0.0, 1.0);
  for (const double counts : {1024.0, 2048.0, 4096.0}) {
    const double step = 360.0 / counts, decimal = counts < 3000.0 ? 0.01 : 0.001;
    std::vector<double> reference;
    for (int i = 0; i < 6000; ++i) {
      const double at = std::floor(unit(rng) * counts) * step / decimal;
      const double up = std::floor(at + 0.5), down = std::ceil(at - 0.5);
      const bool ties = std::abs(at - std::floor(at) - 0.5) < 0.05;
      reference.push_back((ties && unit(rng) < 0.5 ? std::ceil(at - 0.55)
                           : ties                  ? up
                                                   : down) *
                          decimal);
    }
    EXPECT_NEAR(reference_grid_rad(reference) * kDegPerRad, step, 1e-3 * step) << counts;
  }
}

// Steps that are written without rounding: of any number of the last decimal.
TEST(ReferenceGrid, is_found_where_the_step_is_a_few_decimals) {
  std::mt19937_64 rng(fresh_seed());
  for (const double decimal : {0.1, 0.01, 0.001})
    for (int of_step = 1; of_step <= 12; ++of_step) {
      const double step = of_step * decimal;
      std::vector<double> reference;
      for (int i = 0; i < 3000; ++i)
        reference.push_back(static_cast<double>(rng() % 300) * step);
      EXPECT_NEAR(reference_grid_rad(reference) * kDegPerRad, step, 1e-3 * step) << decimal;
    }
}

TEST(ReferenceGrid, what_counts_nothing_has_none) {
  std::mt19937_64 rng(fresh_seed());
  std::vector<double> reference;
  for (int i = 0; i < 2000; ++i)
    reference.push_back(std::uniform_real_distribution<>(0.0, 360.0)(rng));
  EXPECT_EQ(reference_grid_rad(reference), 0.0);
}

} // namespace
} // namespace ada::test

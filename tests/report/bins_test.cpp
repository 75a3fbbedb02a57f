// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/bins.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace ada {
namespace {

TEST(Bins, MeanAndSpreadOfEachBin) {
  const std::vector<double> key{0.1, 0.2, 0.3, 0.4, 1.5, 1.6}, value{1, 3, 1, 3, 10, 10};
  const auto bins = bin_means(key, value, 0.0, 2.0, 2, 2);
  ASSERT_EQ(bins.size(), 2u);
  EXPECT_DOUBLE_EQ(bins[0].x, 0.25);
  EXPECT_DOUBLE_EQ(bins[0].mean, 2.0);
  EXPECT_DOUBLE_EQ(bins[0].spread, 1.0);
  EXPECT_DOUBLE_EQ(bins[0].error, 0.5);
  EXPECT_DOUBLE_EQ(bins[1].mean, 10.0);
  EXPECT_DOUBLE_EQ(bins[1].spread, 0.0);
  EXPECT_FALSE(bins[1].gap_before);
}

TEST(Bins, EmptyBinsAreGapsAndEndsCount) {
  const std::vector<double> key{0.0, 3.0}, value{1, 2};
  const auto bins = bin_means(key, value, 0.0, 3.0, 3, 1);
  ASSERT_EQ(bins.size(), 2u);
  EXPECT_FALSE(bins[0].gap_before);
  EXPECT_TRUE(bins[1].gap_before);
  EXPECT_DOUBLE_EQ(bins[1].mean, 2.0); // the upper end belongs to the last bin
}

TEST(Bins, WhatIsNoNumberIsLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> key{nan, 0.5, 0.5, -1.0, 9.0}, value{1, nan, 4, 5, 6};
  const auto bins = bin_means(key, value, 0.0, 1.0, 1, 1);
  ASSERT_EQ(bins.size(), 1u);
  EXPECT_DOUBLE_EQ(bins[0].mean, 4.0);
  EXPECT_TRUE(bin_means(key, value, 1.0, 1.0, 4, 1).empty());
}

} // namespace
} // namespace ada

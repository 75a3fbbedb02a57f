// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Axes of the pictures: their numbers must stand apart.

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "report/script.h"

namespace ada {
namespace {

double number_after(const std::string &script, const std::string &words) {
  const std::size_t at = script.find(words);
  return at == script.npos ? std::nan("") : std::stod(script.substr(at + words.size()));
}

TEST(Script, LogarithmicAxesHaveNoMoreNumbersThanAskedFor) {
  std::random_device device;
  const unsigned seed = device();
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (int k = 0; k < 1000; ++k) {
    const double from = std::pow(10.0, std::uniform_real_distribution(-6.0, 3.0)(random));
    const double to = from * std::pow(10.0, std::uniform_real_distribution(0.2, 3.5)(random));
    const int most = std::uniform_int_distribution(4, 8)(random);
    const std::string script = log_range("x", from, to, most);
    const std::size_t tics = script.find("set xtics (");
    if (tics == script.npos)
      continue; // fewer than two fit: gnuplot's own choice
    const auto commas =
        std::count(script.begin() + static_cast<std::ptrdiff_t>(tics), script.end(), ',');
    EXPECT_LE(commas + 1, most) << from << " to " << to;
  }
}

TEST(Script, LogarithmicAxesStillShowHalvesWhereThereIsRoom) {
  EXPECT_NE(log_range("x", 0.9, 60.0).find("(1,2,5,10,20,50)"), std::string::npos);
  EXPECT_NE(log_range("x", 0.009, 1.5).find("(0.01,0.03,0.1,0.3,1)"), std::string::npos);
  EXPECT_NE(log_range("x", 0.009, 1.5, 4).find("(0.01,0.1,1)"), std::string::npos);
}

TEST(Script, LongNumbersAlongAnAxisGetFewerTics) {
  const double shorter = number_after(range_with_tics("x", 0.0, 30.0, 4), "set xtics ");
  EXPECT_EQ(shorter, 10.0);
  // 1.44999, 1.45000, 1.45001 and more would touch.
  EXPECT_GT(number_after(range_with_tics("x", 1.449975, 1.450025, 6), "set xtics "), 1e-5);
  // Upright numbers have no such trouble.
  EXPECT_EQ(number_after(range_with_tics("y", 1.449975, 1.450025, 6), "set ytics "), 1e-5);
}

TEST(Script, AnUprightAxisHasTwoNumbersAtLeast) {
  std::random_device device;
  const unsigned seed = device();
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (int k = 0; k < 1000; ++k) {
    const double limit = std::pow(10.0, std::uniform_real_distribution(-6.0, 3.0)(random));
    const double step = number_after(range_with_tics("y", -limit, limit, 3), "set ytics ");
    EXPECT_LE(step, limit);
    EXPECT_GE(step, limit / 5.0);
  }
}

} // namespace
} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What the pictures of a study must show: every population, however far from the largest one.

#include <cmath>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "study/page.h"
#include "support/seed.h"

namespace ada::study {
namespace {

/// 42 captures of batch A about 0.4, 18 of batch B about 0.9, and one at 50.
Fleet two_populations() {
  std::mt19937_64 random(test::fresh_seed());
  std::normal_distribution<double> noise(0.0, 0.02);
  Fleet f;
  Column c{"quadrature-error", "delta_deg", "deg", {}, {}, {}, true};
  Factor batch{"batch"};
  for (std::size_t k = 0; k < 61; ++k) {
    c.capture.push_back(k);
    c.value.push_back(k == 60 ? 50.0 : (k < 42 ? 0.4 : 0.9) + noise(random));
    batch.word.push_back(batch.words.number_of(k < 42 || k == 60 ? "A" : "B"));
  }
  f.columns = {c};
  f.factors.push_back(std::move(batch));
  return f;
}

/// The numbers of "set xrange [0.1:0.9]".
std::pair<double, double> range_of(const std::string &script, const char *axis) {
  const std::string words = std::string("set ") + axis + "range [";
  std::istringstream at(script.substr(script.rfind(words) + words.size()));
  double low = 0.0, high = 0.0;
  char colon = 0;
  at >> low >> colon >> high;
  return {low, high};
}

TEST(StudyPictures, AHistogramShowsBothPopulationsAndNotTheOutlier) {
  const Fleet f = two_populations();
  ParameterSummary p;
  p.parameter = "delta_deg";
  const auto [low, high] =
      range_of(histogram_picture(f, p, "quadrature-error", nullptr).script, "x");
  EXPECT_LT(low, 0.4);
  EXPECT_GT(high, 0.9);
  EXPECT_LT(high, 2.0);
}

TEST(StudyPictures, ThePopulationsReachAsHighAsTheBarsAndNotFarAbove) {
  const Fleet f = two_populations();
  ParameterSummary p;
  p.parameter = "delta_deg";
  Grouping g;
  g.populations = {{0.4, 0.002, 0.7}, {0.9, 0.002, 0.3}}; // narrower than a bar
  const std::string script = histogram_picture(f, p, "quadrature-error", &g).script;
  EXPECT_LT(range_of(script, "y").second, 1.2 * static_cast<double>(f.columns[0].value.size()));
}

TEST(StudyPictures, EveryCaptureHasItsPointWithinThePicture) {
  const Fleet f = two_populations();
  Dependence d;
  d.cause = "quadrature-error";
  d.parameter = "delta_deg";
  d.on = "batch";
  d.levels = {{"A", 0.4, 43}, {"B", 0.9, 18}};
  const std::string script = dependence_picture(f, d).script;
  const auto [low, high] = range_of(script, "y");
  std::istringstream rows(script.substr(script.find("$p << EOD\n") + 10));
  std::size_t points = 0, of_b = 0;
  for (double x = 0.0, y = 0.0; rows >> x >> y; ++points) {
    EXPECT_GE(y, low);
    EXPECT_LE(y, high);
    of_b += x > 0.5 && y > 0.7 ? 1 : 0;
  }
  EXPECT_EQ(points, f.columns[0].value.size());
  EXPECT_EQ(of_b, 18u);
}

} // namespace
} // namespace ada::study

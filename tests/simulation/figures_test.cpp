// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "simulation/figures.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "ada4571.h"
#include "base/error.h"
#include "support/seed.h"
#include "support/temp_folder.h"

namespace ada {
namespace {

/// Greatest magnitude over all sensors and temperatures.
double greatest(const FigureData &figure) {
  double most = 0.0;
  for (const auto &row : figure.rows)
    for (std::size_t c = 1; c < row.size(); ++c)
      most = std::max(most, std::abs(row[c]));
  return most;
}

double greatest_at(const FigureData &figure, double temperature) {
  double most = 0.0;
  for (const auto &row : figure.rows)
    if (row[0] == temperature)
      for (std::size_t c = 1; c < row.size(); ++c)
        most = std::max(most, std::abs(row[c]));
  return most;
}

TEST(Figures, MismatchFollowsTheClosedForm) {
  const FigureData figure = make_figure("mismatch", test::fresh_seed());
  bool saw_one_percent = false;
  for (const auto &row : figure.rows) {
    // The closed form is the first order in k; the next is (k/2)^2 of it.
    EXPECT_NEAR(row[1], row[2], 2e-4 * row[2] + 1e-9) << "k = " << row[0] << " %";
    if (std::abs(row[0] - 1.0) < 1e-9) {
      saw_one_percent = true;
      EXPECT_NEAR(row[1], 0.143, 0.0005);
    }
  }
  EXPECT_TRUE(saw_one_percent);
}

// b (T - T1)(T - T2) over -40 to 150 degrees: 6000, 9100 and 13000 times b at most.
TEST(Figures, WiderCalibrationLeavesSmallerOffsets) {
  const std::uint64_t seed = test::fresh_seed();
  const double wide = greatest(make_figure("offset-0-110", seed));
  const double middle = greatest(make_figure("offset-20-80", seed));
  const double narrow = greatest(make_figure("offset-20-50", seed));
  EXPECT_LT(wide, middle);
  EXPECT_LT(middle, narrow);
}

TEST(Figures, OffsetsVanishWhereTheSensorWasCalibrated) {
  const std::uint64_t seed = test::fresh_seed();
  const FigureData dual = make_figure("offset-20-80", seed);
  // An offset is known to noise * sqrt(2/N) = 10 uV, and three of them meet here.
  EXPECT_LT(greatest_at(dual, 20.0), 100.0 / 5.0 * 6.0 * 17e-6);
  EXPECT_LT(greatest_at(dual, 80.0), 100.0 / 5.0 * 6.0 * 17e-6);
  EXPECT_GT(greatest(dual), 10.0 * greatest_at(dual, 20.0));
}

TEST(Figures, GainControlKeepsTheErrorSmallerWhenHot) {
  const std::uint64_t seed = test::fresh_seed();
  const FigureData on = make_figure("error-gc-on", seed), off = make_figure("error-gc-off", seed);
  EXPECT_LT(greatest_at(on, 150.0), greatest_at(off, 150.0));
  EXPECT_GT(greatest_at(on, -40.0), greatest_at(off, -40.0)); // colder: a greater amplitude
}

TEST(Figures, FilesNameTheirAssumptions) {
  test::TempFolder folder;
  const std::string directory = folder / "";
  for (std::size_t i = 0; const char *name = ada4571_figure_name(i); ++i) {
    ASSERT_EQ(ada4571_figure_write(name, 7, directory.c_str()), ADA4571_OK) << name;
    const std::string csv = test::read_file(folder / (std::string(name) + ".csv"));
    EXPECT_NE(csv.find("# application note: Fig."), csv.npos) << name;
    EXPECT_NE(csv.find("# assumed: "), csv.npos) << name;
    const std::string svg = test::read_file(folder / (std::string(name) + ".svg"));
    EXPECT_NE(svg.find("assumed: "), svg.npos) << name;
  }
}

TEST(Figures, UnknownNamesAndFoldersAreRefused) {
  EXPECT_EQ(ada4571_figure_write("fig-7", 1, "/tmp"), ADA4571_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(std::string(ada4571_last_error()).find("offset-20-80"), std::string::npos);
  EXPECT_EQ(ada4571_figure_write(nullptr, 1, "/tmp"), ADA4571_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(ada4571_figure_write("mismatch", 1, "/nonexistent/folder"), ADA4571_ERROR_NOT_FOUND);
  EXPECT_EQ(ada4571_figure_name(1000), nullptr);
}

} // namespace
} // namespace ada

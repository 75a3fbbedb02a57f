// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Figures of the calibration application note, reproduced by simulating sensors and calibrating
// them with the library's own code. The note prints curves without numbers: every number that it
// does not give is an assumption, and said to be one in the data and on the plot.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ada {

/// One curve or band of curves over a common abscissa.
struct FigureData {
  std::string name, title, x_label, y_label;
  std::vector<std::string> assumptions;
  std::vector<std::string> columns; ///< the abscissa first
  std::vector<std::vector<double>> rows;
};

std::span<const std::string_view> figure_names();

/// Throws Error(ADA4571_ERROR_INVALID_ARGUMENT) that lists the names when there is no such figure.
FigureData make_figure(std::string_view name, std::uint64_t seed);

/// DIRECTORY/NAME.csv, and NAME.svg where the program gnuplot is found; each whole or not at all.
void write_figure(std::string_view name, std::uint64_t seed, const std::string &directory);

} // namespace ada

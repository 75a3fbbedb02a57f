// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What all scripts for gnuplot share.
#pragma once

#include <string>

#include "base/gnuplot.h"

namespace ada {

/// Width and height in CSS pixels: one of three or four in a row, one of two, one beside words.
struct PictureSize {
  int width, height;
};
inline constexpr PictureSize kPanel{270, 190}, kHalf{480, 260}, kBeside{620, 270};

/// Terminal and frame of a picture; the name of the vertical axis stands above it, where it reads
/// without turning the head.
std::string panel(PictureSize size, const std::string &x_label, const std::string &y_label);

/// "$name << EOD ...": a block of data.
std::string block(const std::string &name, const std::string &rows);

/// Range of axis "x" or "y"; gnuplot refuses an empty one, so that is widened.
std::string range(const char *axis, double from, double to);

/// range() with about `count` round tics; fewer along "x" where their numbers are long.
std::string range_with_tics(const char *axis, double from, double to, int count);

/// A logarithmic axis: tics at 1, 2, 5 of each decade, at 1, 3 or at the decades alone, so that
/// there are no more than `most`. `from` and `to` are positive.
std::string log_range(const char *axis, double from, double to, int most = 6);

} // namespace ada

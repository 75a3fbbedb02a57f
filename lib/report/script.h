// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What all scripts for gnuplot share.
#pragma once

#include <string>

#include "base/gnuplot.h"

namespace ada {

/// Terminal and frame of a picture of this size in CSS pixels; the name of the vertical axis
/// stands above it, where it reads without turning the head.
std::string panel(int width, int height, const std::string &x_label, const std::string &y_label);

/// "$name << EOD ...": a block of data.
std::string block(const std::string &name, const std::string &rows);

/// About `count` round tics of axis "x" or "y".
std::string tics(const char *axis, double from, double to, int count);

/// Tics of a logarithmic axis x: 1, 2, 5 of each decade while that are few, else the decades.
std::string log_tics(double from, double to);

} // namespace ada

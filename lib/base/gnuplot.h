// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Plots by the program gnuplot (5.2 or newer).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ada {

/// A text as gnuplot reads it, in quotes; control characters become blanks.
std::string gnuplot_quoted(std::string_view text);

/// Draws each script, which sets its own terminal (svg) and plots once or in a multiplot, in one
/// run of gnuplot, under its default settings. One SVG document a script, from "<svg" to "</svg>".
/// Throws Error: NOT_FOUND when gnuplot is missing, IO with gnuplot's own words when it fails or
/// takes longer than `timeout_ms`.
std::vector<std::string> draw(const std::vector<std::string> &scripts, int timeout_ms = 60000);

} // namespace ada

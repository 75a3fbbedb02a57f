// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace ada {

/// The sample rate that the lines before `first_row` name as such, or by the time between samples;
/// nothing where they do not, or name two.
std::optional<double> preamble_rate(const std::vector<std::string> &lines, std::size_t first_row,
                                    char separator, char decimal);

} // namespace ada

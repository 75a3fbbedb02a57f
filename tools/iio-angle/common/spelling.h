// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What a mistyped word was meant to be.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace cli {

/// Letters to insert, delete, replace or swap with their neighbour to come from one word to the
/// other.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The known words that `word` may have been meant for, best first: those that it begins, those a
/// few letters away, those that it is a part of. Mostly none or one, never more than three.
std::vector<std::string> nearest(std::string_view word, const std::vector<std::string> &known);

/// "; did you mean 'x'?", to be put behind a sentence; where nothing comes near, "; see `HELP`", or
/// nothing without such help.
std::string did_you_mean(std::string_view word, const std::vector<std::string> &known,
                         const std::string &help = "");

} // namespace cli

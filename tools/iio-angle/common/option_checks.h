// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What the value of an option may be, for CLI11's transform(): each refuses with a sentence that
// says what was given and what would do. The names of options stand before it already.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace cli {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// A quantity above zero (quantity.h), from zero on, or within limits. The option gets it as a
/// plain number.
CLI::Validator positive(const char *unit);
CLI::Validator from_zero(const char *unit);
CLI::Validator between(double low, double high, const char *unit = "1");
/// Whole numbers, "10k" among them.
CLI::Validator whole(std::uint64_t low,
                     std::uint64_t high = std::numeric_limits<std::uint64_t>::max());
/// One of these words, as it stands. `what`: "effect", where they are too many to be listed.
CLI::Validator one_of(std::vector<std::string> words, const char *what = "");
/// The name of a file to be written with one of these endings; "-" and what is no regular file (a
/// pipe, /dev/null) do without. `what`: "a calibration", for the sentence.
CLI::Validator ends_in(std::vector<std::string> endings, const char *what);
/// The name of a capture to be written, or "-".
CLI::Validator capture_name();
/// What ends_in() says, as a sentence; empty where nothing is wrong with the name.
std::string wrong_ending(const std::string &path, const std::vector<std::string> &endings,
                         const char *what);

} // namespace cli

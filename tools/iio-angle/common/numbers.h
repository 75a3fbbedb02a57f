// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What an option's number must be, in words; CLI11 would print the largest double in full.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace cli {

/// `name` stands in the help.
template <class Good> CLI::Validator number(const char *name, const char *must, Good good) {
  return CLI::Validator(
      [=](const std::string &text) {
        double value = 0;
        return CLI::detail::lexical_cast(text, value) && good(value)
                   ? std::string()
                   : "'" + text + "' must be a number " + must;
      },
      name);
}

inline const CLI::Validator kPositive =
    number("POSITIVE", "above 0", [](double value) { return value > 0; });
inline const CLI::Validator kNonNegative =
    number("NONNEGATIVE", "from 0 on", [](double value) { return value >= 0; });

} // namespace cli

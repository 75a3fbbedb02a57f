// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// How --help shows an option: "--duration S   length, in s (default 7)".
#pragma once

#include <CLI/CLI.hpp>

namespace cli {

/// What CLI11 would write behind the option's name ("S:NONNEGATIVE=7") stands behind its
/// description, in words.
class HelpText : public CLI::Formatter {
public:
  std::string make_option_opts(const CLI::Option *option) const override;
  std::string make_option_desc(const CLI::Option *option) const override;
};

} // namespace cli

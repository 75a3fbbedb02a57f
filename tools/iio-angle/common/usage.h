// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The command line as a whole: help and version in their several forms, and one sentence for
// whatever is wrong with it.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace cli {

/// The words of the command line, `help VERB` turned into `VERB --help`; in CLI11's order, last
/// first. Throws Failure for a verb that is none.
std::vector<std::string> words_of(const CLI::App &app, int argc, char **argv);

/// The names of the verbs of a command, hidden ones left out.
std::vector<std::string> verb_names(const CLI::App &app);
/// "--output", "-o" and so on of a verb, options in groups among them.
std::vector<std::string> option_names(const CLI::App &verb);
/// The verb of that name, or nullptr; hidden ones too.
const CLI::App *find_verb(const CLI::App &app, const std::string &name);

/// What was wrong with the command line that `app` has just refused, without "iio-angle:". Names
/// the option first.
std::string usage_error(const CLI::App &app, const CLI::ParseError &error);

} // namespace cli

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What may stand next on a command line: the shells' completions ask for it, so that they know no
// verb, option or value by themselves.
//
//   iio-angle complete -- WORD... CURRENT
//
// prints a line a candidate: the word and, after a tab, what it is; the line ":files" stands for
// the names of files. It is no verb of --help: CLI11 would take the words for its own.
#pragma once

#include <CLI/CLI.hpp>

namespace cli {

/// False when the command line does not ask for that.
bool complete(const CLI::App &app, int argc, char **argv);

} // namespace cli

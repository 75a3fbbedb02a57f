// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What main.cpp needs of a verb: a function that declares its options and, when the verb is the
// one on the command line, sets the action to run.
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

namespace cli {

/// Does the verb's work and gives the exit status; throws Failure.
using Action = std::function<int()>;

void add_list(CLI::App &app, Action &action);
void add_record(CLI::App &app, Action &action);
void add_read(CLI::App &app, Action &action);
void add_watch(CLI::App &app, Action &action);
void add_calibrate(CLI::App &app, Action &action);
void add_convert(CLI::App &app, Action &action);
void add_import(CLI::App &app, Action &action);
void add_simulate(CLI::App &app, Action &action);
void add_emulate(CLI::App &app, Action &action);
void add_diagnose(CLI::App &app, Action &action);
void add_check(CLI::App &app, Action &action);
void add_pins(CLI::App &app, Action &action);
void add_catalogue(CLI::App &app, Action &action);
void add_figures(CLI::App &app, Action &action);
void add_study(CLI::App &app, Action &action);
void add_definitions(CLI::App &app, Action &action);

/// An example for the end of a verb's --help.
inline void example(CLI::App &verb, const std::string &lines) {
  verb.footer("Example:\n" + lines);
}

} // namespace cli

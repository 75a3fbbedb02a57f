// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The options that choose a device, the same for every verb that opens one.
#pragma once

#include <initializer_list>
#include <string>

#include <CLI/CLI.hpp>

#include "common/handles.h"

namespace cli {

struct SourceOptions {
  std::string stored, uri, device, sin, cos, temp, vdd, trigger;
  double rate_hz = 0;
  double supply_v = 0;      ///< 0: not said
  int periods_per_turn = 0; ///< 0: not said
  double latency_s = 0;
  std::string capture; ///< played instead of a device
  double speed = 1;

  bool replays() const { return !capture.empty(); }
};

/// -u alone, for `list`.
void add_uri_option(CLI::App &verb, SourceOptions &options);
/// `before`: what says the supply and the periods before their defaults do.
void add_source_options(CLI::App &verb, SourceOptions &options, const std::string &before = "");
/// --capture and --speed, which take the place of a device.
void add_replay_options(CLI::App &verb, std::string &capture, double &speed);
/// Throws when one of these options is there beside --capture.
void refuse_beside_capture(const CLI::App &verb, std::initializer_list<const char *> names);

Source open_source(const SourceOptions &options);
ada4571_source_info source_info(const Source &source);

} // namespace cli

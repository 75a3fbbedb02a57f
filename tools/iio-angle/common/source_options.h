// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The options that choose a device, the same for every verb that opens one.
#pragma once

#include <CLI/CLI.hpp>

#include "common/handles.h"

namespace cli {

struct SourceOptions {
  std::string stored, uri, device, sin, cos, temp, vdd, trigger;
  double rate_hz = 0;
  double supply_v = 5.0;
  int periods_per_turn = 2;
  double latency_s = 0;
};

/// -u alone, for `list`.
void add_uri_option(CLI::App &verb, SourceOptions &options);
void add_source_options(CLI::App &verb, SourceOptions &options);

Source open_source(const SourceOptions &options);
ada4571_source_info source_info(const Source &source);

} // namespace cli

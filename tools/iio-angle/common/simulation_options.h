// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The options of the simulated sensor, the same for `simulate` and `emulate`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/handles.h"

namespace cli {

struct SimulationOptions {
  std::string model, motion, temperature;
  std::vector<std::string> effects;
  std::uint64_t seed = 1;
  bool no_vtemp = false, no_vdd = false, no_reference = false;
  ada4571_simulation_options numbers = initialised(ada4571_simulation_options_init);
};

void add_simulation_options(CLI::App &verb, SimulationOptions &options);
Simulation make_simulation(const SimulationOptions &options);

} // namespace cli

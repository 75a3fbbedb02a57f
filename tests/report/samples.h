// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Small captures and their diagnoses, for the tests of the report.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/diagnose.h"
#include "model/effect_text.h"
#include "simulation/simulation.h"

namespace ada::test {

inline Capture capture_with(const std::vector<std::string> &effects, bool reference,
                            std::uint64_t seed, double duration_s = 4.0) {
  Model model;
  for (const std::string &text : effects)
    add_effect(model, parse_effect(text));
  SimulationOptions o;
  o.sample_rate_hz = 5000.0;
  o.duration_s = duration_s;
  o.motion = "steps:rpm=300/900/-900/-300";
  o.temperature = "ramp:from=0,to=80";
  o.has_reference = reference;
  return Simulation(model, o, seed).run();
}

} // namespace ada::test

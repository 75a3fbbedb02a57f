// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// Runs the physics in its order and writes the result in the text capture form.

#pragma once

#include "bridge.h"
#include "chain.h"
#include "converter.h"
#include "field.h"
#include "motion.h"
#include "record.h"
#include "sampler.h"
#include "thermal.h"
#include "unknown.h"
#include "wander.h"
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <vector>

namespace truth {

/// All that there is to know about one capture.
struct Bench {
  std::size_t samples = 70000;
  Motion motion;
  Thermal thermal;
  Field field;
  Bridge bridge;
  Chain chain;
  double delay = 0.0; // s: all of the sensor lags by this
  Supply supply;
  Sampler sampler;
  Converter converter;
  Record record;
  Wander wander;
  double gain_noise = 0.0; // rms, relative: white, of both amplitudes together
  Unknown unknown;
  std::uint64_t noise_seed = 1;

  double duration() const { return static_cast<double>(samples) / sampler.rate; }
};

struct Capture {
  std::vector<double> time, vsin, vcos, vtemp, vdd, reference; // s, V, deg
  std::vector<double> shaft;                                   // rad, exact, unwrapped
};

/// Mean of what VTEMP shows over the capture, without its noise, V.
double mean_vtemp(const Bench &bench);

Capture simulate(const Bench &bench);

/// Columns that the bench does not record are left out. With \p exact_reference the reference
/// column is always there and holds the exact angle plus the reference's zero.
void write_text(std::ostream &out, const Bench &bench, const Capture &capture,
                bool exact_reference = false);

} // namespace truth

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// What ends up in the file: columns, reference angle, lost rows, wiring mistakes.
///
/// - Reference: reads alpha + zero + e sin(alpha + phi). The zero is the angle between the
///   reference's zero and the sensor's, which is no effect.
///   Besides it may carry other periodic errors, be read at another moment than the signals, at
///   moments that scatter, and count in steps.
/// - Loss: rows vanish, and the time column is counted up as though nothing was missing.

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace truth {

struct LossEvent {
  std::size_t sample = 0; // first row lost, counted before any loss
  std::size_t count = 0;
};

/// A periodic error of the reference: it reads amplitude sin(order alpha + phase) too much.
struct ReferenceLine {
  double order = 0.0;
  double amplitude = 0.0; // rad
  double phase = 0.0;     // rad
};

struct Record {
  bool has_reference = true;
  bool has_vtemp = true;
  bool has_vdd = false;
  bool states_noise = true;
  bool gain_control = true;
  double reference_zero = 0.0;         // rad
  double reference_eccentricity = 0.0; // rad
  double reference_phase = 0.0;        // rad
  double reference_noise = 0.0003;     // deg rms
  std::vector<ReferenceLine> reference_lines;
  double reference_delay = 0.0;  // s: read so much after the signals
  double reference_jitter = 0.0; // s rms: scatter of the moment at which it is read
  double reference_step = 0.0;   // deg: it counts in steps; 0: none
  std::vector<LossEvent> losses; // ascending, not overlapping
  bool swapped = false;
  bool inverted_sine = false;
  bool inverted_cosine = false;
  std::string serial = "truth";
};

} // namespace truth

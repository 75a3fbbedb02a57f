// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// What ends up in the file: columns, reference angle, lost rows, wiring mistakes.
///
/// - Reference: reads alpha + zero + e sin(alpha + phi). The zero is the angle between the
///   reference's zero and the sensor's, which is no effect.
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
  std::vector<LossEvent> losses;       // ascending, not overlapping
  bool swapped = false;
  bool inverted_sine = false;
  bool inverted_cosine = false;
  std::string serial = "truth";
};

} // namespace truth

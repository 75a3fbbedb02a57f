// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Temperature and supply over time, from VTEMP and VDD: what is known of each sample of a capture
// beside its motion.
#pragma once

#include <vector>

#include "recording/capture.h"

namespace ada {

/// VDD over time, freed of noise of its own reading that the outputs do not follow. All zero
/// without the channel.
struct SupplyOverTime {
  std::vector<float> unit;  ///< (VDD/level - 1)/scale; empty where the supply stays at its level
  double mean_v = 0.0;      ///< of VDD
  double rms = 0.0;         ///< of VDD/mean - 1
  double scale = 0.0;       ///< rms; of a supply that does not move its distance from the level
  double mid_shift_v = 0.0; ///< of mid-supply from half the stated supply
  /// `level_v`: where a model has learnt what it knows, V; nothing: the capture's own mean.
  explicit SupplyOverTime(const Capture &capture, std::optional<double> level_v = std::nullopt);
};

/// First and second derivative over time, 1/s and 1/s^2, of a polynomial of fourth order over a
/// millisecond on either side, or over two samples where they lie further apart. 0 at the ends.
struct Derivatives {
  std::vector<float> rate, bend;
  Derivatives(const std::vector<double> &time_s, const std::vector<float> &value);
};

/// VTEMP over time as a smooth spline, freed of the supply that it follows and of what a
/// multiplexer leaves of VCOS in it. Columns are empty without the channel. A capture of fewer than
/// 400 samples keeps VTEMP as it is, and its rate is 0.
struct TemperatureOverTime {
  std::vector<double> vtemp_v;
  std::vector<float> rate; ///< V/s
  /// Slope of VTEMP on VCOS and its standard error; error 0: not measured.
  double on_vcos = 0.0, on_vcos_error = 0.0;
  TemperatureOverTime(const Capture &capture, const SupplyOverTime &supply);
};

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// Effects outside the catalogue: what a diagnosis must call unexplained.
///
/// Each acts through one of a few hooks on the physics; an empty hook does nothing.

#pragma once

#include "bridge.h"
#include "motion.h"
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace truth {

struct Unknown {
  std::string name; // empty: none
  /// Added to the field direction (rad), of time and magnet angle (rad).
  std::function<double(double t, double magnet)> angle;
  /// Factor on both amplitudes.
  std::function<double(double t)> gain;
  /// Added to a channel, V.
  std::function<double(Channel channel, double t)> offset;
  /// Electrical rad added to the quadrature error.
  std::function<double(double t)> quadrature;
  /// Replaces the signal of a channel about mid-supply, V.
  std::function<double(Channel channel, double t, double signal)> transfer;
  /// Replaces the converter's output, V.
  std::function<double(double volts)> code;
  double jitter = 0.0; // s rms, of the sample clock
};

struct UnknownNeeds {
  bool reference = false;
  bool changing_speed = false; // speed must vary within the capture
  bool accelerating = false;   // long accelerations
};

/// What the kinds need in order to be visible.
struct UnknownKind {
  std::string name;
  UnknownNeeds needs;
  std::vector<std::string> tolerated; // causes that may be named beside "unexplained"
  std::vector<std::string> instead;   // causes that may be named instead
};

const std::vector<UnknownKind> &unknown_kinds();

/// \p motion, \p rate and \p duration describe the capture; the size is several times \p noise.
Unknown make_unknown(const std::string &name, std::uint64_t seed, const Motion &motion, double rate,
                     double duration, double noise);

} // namespace truth

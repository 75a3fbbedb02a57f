// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Angles: units, wrapping, and the step from electrical to mechanical.
// Electrical angle psi = p * alpha, with p electrical periods a turn (2 for AMR).
#pragma once

#include <cmath>
#include <numbers>

namespace ada {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * std::numbers::pi;
inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;
inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// Most electrical periods a turn: sine encoders have up to some 40,000 lines.
inline constexpr int kMostPeriodsATurn = 65536;

/// Wraps x into [0, period). NaN stays NaN.
inline double wrap(double x, double period) {
  const double r = x - period * std::floor(x / period);
  return r < period ? r : 0.0; // rounding may give r == period for tiny negative x
}

/// Wraps x into [-period/2, period/2): the shortest signed difference.
inline double wrap_centred(double x, double period) {
  return wrap(x + 0.5 * period, period) - 0.5 * period;
}

} // namespace ada

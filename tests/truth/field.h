// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// From the shaft to the direction and strength of the field that the sensor sees.
///
/// - Dipole beside the axis: a magnet at the shaft's end with moment m turning in the plane,
///   seen from s beside the axis at gap z: B ~ 3 (m.r) r / r^5 - m / r^3, in-plane part. The
///   direction is that of m with its component along s scaled by g = 1 - 3 s^2/r^2, hence the
///   error a sin 2(alpha - beta) + a^2/2 sin 4(alpha - beta) + ... with a = (1-g)/(1+g),
///   which is (3/2)(s/z)^2 to first order (textbook dipole; series of atan(tan x / g)).
/// - Stray field: vector sum with b (cos gamma, sin gamma), fixed in the housing.
/// - Direction error of another order: phi += a sin(n alpha + phase).
/// - Slip: the magnet turns on the shaft at one moment, and the shaft does not know.

#pragma once

#include <cmath>
#include <vector>

namespace truth {

struct DirectionError {
  int order = 0;
  double amplitude = 0.0; // rad
  double phase = 0.0;     // rad
};

/// A field in the sensor's plane.
struct FieldVector {
  double direction; // rad, unwrapped: within half a turn of the magnet's angle
  double strength;  // relative to the magnet's alone, sensor on the axis
};

struct Field {
  double stray = 0.0;           // b
  double stray_direction = 0.0; // gamma, rad
  double off_axis = 0.0;        // a, rad: first term of the direction error
  double off_axis_direction = 0.0;
  std::vector<DirectionError> direction_errors;
  double slip_time = 0.0; // s
  double slip_step = 0.0; // rad

  double magnet_angle(double shaft_angle, double t) const {
    return shaft_angle + (slip_step != 0.0 && t >= slip_time ? slip_step : 0.0);
  }

  FieldVector at(double magnet) const {
    // With a = 3 k/(2 - 3 k), k = s^2/r^2, the misplacement that gives the wanted first term:
    const double k = 2.0 * off_axis / (3.0 * (1.0 + off_axis));
    // On the axis at the same gap the field is m/z^3; r = z/sqrt(1 - k).
    const double falloff = std::pow(1.0 - k, 1.5);
    const double along = std::cos(magnet - off_axis_direction);
    const double x = falloff * (std::cos(magnet) - 3.0 * k * along * std::cos(off_axis_direction)) +
                     stray * std::cos(stray_direction);
    const double y = falloff * (std::sin(magnet) - 3.0 * k * along * std::sin(off_axis_direction)) +
                     stray * std::sin(stray_direction);
    // The deviation from the magnet's angle, so that turns are not lost in atan2.
    double deviation = std::atan2(y * std::cos(magnet) - x * std::sin(magnet),
                                  x * std::cos(magnet) + y * std::sin(magnet));
    for (const DirectionError &error : direction_errors)
      deviation += error.amplitude * std::sin(error.order * magnet + error.phase);
    return {magnet + deviation, std::hypot(x, y)};
  }
};

} // namespace truth

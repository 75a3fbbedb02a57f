// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// From the field to the two unit signals of the sensor element.
///
/// AMR (two periods a turn): each bridge has two pairs of stripes with current directions 90
/// degrees apart, the two bridges lie 45 degrees apart. A stripe's resistance is
/// R0 + dR cos^2(theta - e), with e its direction and theta that of its magnetisation, and the
/// bridge, driven with constant current, gives the difference of its pairs:
///   c = (cos 2(theta_0 - 0) - cos 2(theta_90 - 90 deg))/2, s the same turned by 45 degrees.
/// theta is where shape anisotropy (easy axis along the stripe) and field balance
/// (Stoner and Wohlfarth, 1948):
///   sin(phi - theta) = (h/2) sin 2(theta - e),   h = Hk/H.
/// To leading order the bridge then carries a third harmonic q = 3 h^2/8 of psi = 2 phi.
///
/// One period a turn (GMR, TMR, Hall): plain sine and cosine of the field direction.
///
/// Quadrature: the bridges do not lie exactly where they should, so that
/// s = sin(psi + d/2), c = cos(psi - d/2).
///
/// Hysteresis: a play operator (backlash) in angle: the reading stays until the field is half
/// the width ahead and then trails by that, whatever the speed.

#pragma once

#include <algorithm>
#include <cmath>

namespace truth {

enum class Channel { sine, cosine };

/// Solves the torque balance of one stripe. Coherent rotation without jumps: needs h < 1.
inline double stripe_magnetisation(double field_direction, double easy_axis, double h) {
  double theta = field_direction;
  for (int i = 0; i < 30; ++i) {
    const double balance =
        std::sin(theta - field_direction) + h / 2 * std::sin(2 * (theta - easy_axis));
    const double slope = std::cos(theta - field_direction) + h * std::cos(2 * (theta - easy_axis));
    const double step = balance / slope;
    theta -= step;
    if (std::abs(step) < 1e-15)
      break;
  }
  return theta;
}

struct Bridge {
  int periods_per_turn = 2;
  double anisotropy = 0.0;       // h = Hk/H at relative field strength 1
  double quadrature = 0.0;       // d, electrical rad
  double hysteresis_width = 0.0; // mechanical rad

  double signal(Channel channel, double field_direction, double strength) const {
    constexpr double quarter = 1.57079632679489661923;
    const double half = channel == Channel::sine ? quadrature / 2 : -quadrature / 2;
    if (periods_per_turn == 1 || anisotropy == 0.0) {
      const double psi = periods_per_turn * field_direction + half;
      return channel == Channel::sine ? std::sin(psi) : std::cos(psi);
    }
    const double axis = (channel == Channel::sine ? quarter / 2 : 0.0) - half / 2;
    const double h = anisotropy / strength;
    const double first = stripe_magnetisation(field_direction, axis, h);
    const double second = stripe_magnetisation(field_direction, axis + quarter, h);
    return (std::cos(2 * (first - axis)) - std::cos(2 * (second - axis - quarter))) / 2;
  }
};

/// The memory of the hysteresis; each observer of the field carries its own.
class Play {
public:
  Play(double width, double first, double direction)
      : half_(width / 2), value_(first - std::copysign(half_, direction)) {}
  double operator()(double input) {
    value_ = std::clamp(value_, input - half_, input + half_);
    return value_;
  }

private:
  double half_;
  double value_;
};

} // namespace truth

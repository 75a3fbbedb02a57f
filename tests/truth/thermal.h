// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// Temperature of the bridge, and what the VTEMP output makes of it.
///
/// VTEMP/VDD = 0.233 + 0.00333 T (T in degrees Celsius), the straight line of the data sheet's
/// figure. The temperature sensor sits on another die than the bridge: it may follow the
/// bridge with a first-order lag, tau dV/dt = V_bridge - V.

#pragma once

#include <cmath>

namespace truth {

struct Thermal {
  double start = 25.0; // degrees Celsius
  double swing = 0.0;  // K
  double cycles = 0.0; // of start .. start+swing .. start over the capture; 0.5 is one way
  double duration = 1.0;
  double lag = 0.0; // s

  /// Runs along a cosine: at rest at both ends of each sweep, as an oven would be.
  double bridge_celsius(double t) const {
    return start + swing * (1 - std::cos(6.28318530717958647692 * cycles * t / duration)) / 2;
  }
  /// What VTEMP would read, at 1 V supply, if it knew the bridge's temperature.
  double bridge_fraction(double t) const { return 0.233 + 0.00333 * bridge_celsius(t); }
};

/// Exact response of the first-order lag to an input that is linear between calls.
class Lag {
public:
  Lag(double tau, double first) : tau_(tau), input_(first), output_(first) {}
  double operator()(double dt, double input) {
    if (tau_ <= 0.0)
      return output_ = input_ = input;
    if (dt <= 0.0) // asked twice for the same moment
      return output_;
    const double decay = std::exp(-dt / tau_);
    const double slope = (input - input_) / dt;
    // Particular solution input - slope tau, plus the decaying rest of the old state.
    output_ = input - slope * tau_ + (output_ - input_ + slope * tau_) * decay;
    input_ = input;
    return output_;
  }

private:
  double tau_;
  double input_;
  double output_;
};

} // namespace truth

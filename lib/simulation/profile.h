// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Motion and temperature of a simulation as functions of time, from their one-line texts:
//   constant:rpm=600          ramp:from=60,to=3000        steps:rpm=60/600/-600,transition=0.1
//   constant:deg_c=25         ramp:from=-20,to=100        cycle:from=0,to=80
#pragma once

#include <span>
#include <string>
#include <vector>

namespace ada {

/// A value over time, straight between its nodes, constant before and after them.
class PiecewiseLinear {
public:
  struct Node {
    double time_s, value;
  };
  explicit PiecewiseLinear(std::vector<Node> nodes);
  double value(double time_s) const;
  double slope(double time_s) const;
  /// Integral from 0 to time_s.
  double integral(double time_s) const;

private:
  std::size_t segment(double time_s) const;
  std::vector<Node> nodes_;
  std::vector<double> integral_; ///< up to each node
};

/// Speed in rad/s over time. Throws Error(INVALID_ARGUMENT) naming what is wrong in the text.
PiecewiseLinear parse_motion(const std::string &text, double duration_s);

/// One text a kind, with the values that are taken where none is given.
std::span<const char *const> motion_examples();
std::span<const char *const> temperature_examples();

/// Temperature in degrees Celsius over time.
PiecewiseLinear parse_temperature(const std::string &text, double duration_s);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// True values with what counts as right.

#pragma once

#include "conditions.h"
#include "finding.h"
#include <algorithm>
#include <cmath>
#include <string>

namespace truth {

inline constexpr double kAngleFloor = 6.0; // degrees: a tenth of the effect as a vector

inline Parameter sized(double value, const char *unit, double floor) {
  Parameter p;
  p.value = value;
  p.unit = unit;
  p.tolerance = std::max(0.1 * std::abs(value), floor);
  return p;
}

inline Parameter exact(double value, const char *unit) {
  Parameter p;
  p.value = value;
  p.unit = unit;
  p.tolerance = 1e-9;
  return p;
}

inline Parameter within(double value, const char *unit, double tolerance) {
  Parameter p;
  p.value = value;
  p.unit = unit;
  p.tolerance = tolerance;
  return p;
}

inline Parameter text(const std::string &value) {
  Parameter p;
  p.text = value;
  return p;
}

/// A phase or direction; \p zero_factor is how it changes if counted from the reference's zero.
inline Parameter direction(const Bench &bench, double radians, double period, double zero_factor) {
  Parameter p;
  p.value = radians / kDegree;
  p.unit = "deg";
  p.tolerance = kAngleFloor;
  p.period = period;
  p.has_other = zero_factor != 0.0 && bench.record.has_reference;
  p.other = p.value + zero_factor * bench.record.reference_zero / kDegree;
  return p;
}

/// Two components of one vector: each within 10 % of its length.
inline void vector_pair(Truth &truth, const char *first, double a, const char *second, double b,
                        const char *unit, double floor) {
  const double tolerance = std::max(0.1 * std::hypot(a, b), floor);
  truth.parameters[first] = within(a, unit, tolerance);
  truth.parameters[second] = within(b, unit, tolerance);
}

} // namespace truth

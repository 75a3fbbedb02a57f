// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The resolution of a capture: every column is a whole number of decimal steps. The text form
// prints these numbers and the identity of a capture is their checksum, so a capture has the same
// identity in text and in SigMF.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "recording/capture.h"

namespace ada {

inline constexpr int kTimeDecimals = 9;      ///< nanoseconds, as the kernel's timestamps
inline constexpr int kReferenceDecimals = 4; ///< 0.0001 degrees: finer than a 21-bit encoder

/// Bounds of what a file may hold; beyond them a number is not what its column says, and could
/// not be counted in decimal steps of 64 bits.
inline constexpr double kMaxTimeS = 8e9, kMaxVolts = 1e6, kMaxDegrees = 1e9;

/// Decimals of volts: 6, and more where one converter step is below 2 microvolts, so that
/// rounding never moves a sample to another code.
inline int volt_decimals(const CaptureMetadata &meta) {
  if (!meta.adc_bits || !meta.adc_reference_v)
    return 6;
  const double step = *meta.adc_reference_v / std::exp2(*meta.adc_bits);
  int decimals = 6;
  while (decimals < 9 && std::pow(10.0, -decimals) > 0.5 * step)
    ++decimals;
  return decimals;
}

inline double power_of_ten(int decimals) {
  double power = 1;
  for (; decimals > 0; --decimals)
    power *= 10;
  return power;
}

/// `value` in steps of 10^-decimals, to the nearest, halves away from zero; `scale` is
/// power_of_ten(decimals). As llround, but without a call.
inline std::int64_t to_steps(double value, double scale) {
  const double steps = value * scale;
  const auto whole = static_cast<std::int64_t>(steps);
  const double rest = steps - static_cast<double>(whole); // exact
  return whole + (rest >= 0.5) - (rest <= -0.5);
}

/// Longest text of print_steps: sign, 19 digits, point.
inline constexpr std::size_t kStepsBytes = 24;

/// Writes steps / 10^decimals; returns the end.
char *print_steps(char *out, std::int64_t steps, int decimals);

} // namespace ada

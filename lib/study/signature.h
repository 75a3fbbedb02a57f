// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The mean course of both channels over a turn of the reference, as Fourier series: small enough to
// keep of each of a million captures, and enough to try any static calibration on it. The first and
// the second half of a capture apart, so that what is learned on one is judged on the other.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "recording/capture.h"

namespace ada::study {

/// Highest order of the electrical angle that is kept.
inline constexpr int kSignatureOrders = 8;

struct Signature {
  int periods = 0; ///< electrical periods a turn; 0: there is no signature
  /// Of half 0 and 1, of VSIN and VCOS: the mean and a cosine and a sine part for each order of the
  /// turn up to kSignatureOrders * periods, volts about mid-supply.
  std::vector<double> values;

  bool empty() const { return periods == 0; }
  int orders() const { return kSignatureOrders * periods; }
  std::size_t series_size() const { return 2 * static_cast<std::size_t>(orders()) + 1; }
  std::span<const double> series(int half, int channel) const {
    return std::span(values).subspan(static_cast<std::size_t>(2 * half + channel) * series_size(),
                                     series_size());
  }
  /// Whether `values` has the length that `periods` asks for.
  bool consistent() const {
    return periods >= 0 && periods <= 4 && values.size() == (empty() ? 0 : 4 * series_size());
  }
};

/// Empty without a reference, for more than four periods a turn, and where a half does not cover
/// the turn.
Signature signature_of(const Capture &capture);

/// What is known of a sensor before it is used.
enum class Calibration {
  none,    ///< mid-supply, equal amplitudes
  offsets, ///< the application note's
  ellipse, ///< and mismatch and quadrature error
  table4,  ///< and a table of the electrical angle up to order 4
  table8,  ///< up to order 8
};
inline constexpr std::size_t kCalibrations = 5;

/// A calibration as numbers, so that several can be averaged: two offsets over the amplitude, the
/// mismatch, the quadrature error, then cosine and sine of the table's orders (rad, electrical).
using Learned = std::array<double, 4 + 2 * kSignatureOrders>;

/// What half `half` of a capture teaches; half 2: both together.
Learned learn(const Signature &signature, int half);

/// RMS angle error that is left of the capture's mean course, mechanical degrees, its best zero
/// taken. Noise is not in it: no calibration takes that away.
double angle_rms_deg(const Signature &judge, int half, const Learned &learned, Calibration use);

} // namespace ada::study

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What repeats with the angle and no cause of the catalogue explains. It is no effect: it has no
// name and counts as no explanation, but it is modelled and corrected like one.
#pragma once

#include <cstddef>
#include <vector>

#include "base/fourier.h"

namespace ada {

/// A Fourier series of each channel, relative to the baseline's amplitude A, at the end of the
/// signal chain: what comes before the sampler (delays, filters) and the sampler itself act on it.
struct PeriodicRemainder {
  static constexpr std::size_t kHighestOrder = 256;

  /// The series are in the angle of the magnet with the zero angle, x = alpha + zero; where a
  /// capture has no reference to say which part of a turn it is in, in psi = p x.
  bool electrical = false;
  /// Entry n - 1 is order n: VSIN gets A sum_n (sin_cos cos(n x) + sin_sin sin(n x)), VCOS the same
  /// of cos_cos and cos_sin. All four are of one length, from 1 to kHighestOrder.
  std::vector<double> sin_cos, sin_sin, cos_cos, cos_sin;

  std::size_t orders() const { return sin_cos.size(); }

  /// What is added to a channel, over all angles and both channels, rms relative to A.
  double rms() const;

  /// Order by order, times `factor`: first VSIN, second VCOS. Throws
  /// Error(ADA4571_ERROR_INVALID_ARGUMENT) where the lengths are not as above.
  std::vector<FourierPair> series(double factor) const;
};

} // namespace ada

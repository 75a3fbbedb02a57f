// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Spectrum of a pair of residuals over time, on an even grid.
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace ada {

struct Spectrum {
  /// Line k is at k bins, the upper half at negative frequencies; floats, for a long capture has no
  /// memory to spare and a line that matters stands out of noise.
  std::vector<std::complex<float>> line;
  double bin_hz = 0.0;
};

/// `value(i)` is the residual at time[i], ascending. Samples that are missing leave zeros: they
/// widen no line that stands clear of the others. Empty when the times span nothing.
Spectrum spectrum_over_time(std::span<const double> time, double sample_period_s,
                            const std::function<std::complex<double>(std::size_t)> &value);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Spectra of residuals over time, on an even grid.
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

/// Power of one channel: |.|^2 of each line from 0 to below half of the grid's rate, to which
/// `power` adds. Half of the memory that a pair takes.
struct PowerOverTime {
  std::vector<float> power;
  double bin_hz = 0.0;
};
void add_power_over_time(std::span<const double> time, double sample_period_s,
                         const std::function<double(std::size_t)> &value, PowerOverTime &out);

/// A line of a row of values, at one of its own frequencies.
struct RowLine {
  double periods; ///< over the whole row
  double share;   ///< of the sum of squares about the mean
};

/// Lines of `fewest_periods` or more, the strongest first, each so strong beside those that are
/// weaker as white noise has one with this chance only (R. A. Fisher, Proc. R. Soc. A 125, 1929:
/// exact for any number of normal values, which may be few). By place in the row, whatever the
/// clock says.
std::vector<RowLine> standing_lines(std::span<const double> row, double fewest_periods,
                                    double chance);

} // namespace ada

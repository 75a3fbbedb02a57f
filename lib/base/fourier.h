// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Fourier series at many angles at once, by the best vector unit of the machine.
#pragma once

#include <cstddef>
#include <span>

namespace ada {

/// Coefficients of order n of two series of one angle: a cos(n x) + b sin(n x) each.
struct FourierPair {
  double cos_first, sin_first, cos_second, sin_second;
  bool operator==(const FourierPair &) const = default;
};

/// Adds the two series to first[i] and second[i] at x[i], rad; orders[n - 1] is order n. The powers
/// of e^(jx) come from a product each, so rounding grows with the order, to about order * 2e-16 of
/// its coefficients.
void add_fourier_pair(const double *x, std::size_t n, std::span<const FourierPair> orders,
                      double *first, double *second);

} // namespace ada

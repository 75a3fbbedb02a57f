// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Periodic remainders for tests.
#pragma once

#include <cmath>
#include <random>

#include "model/remainder.h"

namespace ada::test {

/// Terms of random phase whose size falls with the square of the order; `first` is the size of
/// order 1, relative to the amplitude.
inline PeriodicRemainder drawn_remainder(std::mt19937_64 &rng, std::size_t orders, double first,
                                         bool electrical) {
  std::uniform_real_distribution<double> phase(0.0, 2.0 * std::acos(-1.0));
  PeriodicRemainder r;
  r.electrical = electrical;
  for (std::size_t n = 1; n <= orders; ++n) {
    const double size = first / static_cast<double>(n * n);
    const double sin = phase(rng), cos = phase(rng);
    r.sin_cos.push_back(size * std::cos(sin));
    r.sin_sin.push_back(size * std::sin(sin));
    r.cos_cos.push_back(size * std::cos(cos));
    r.cos_sin.push_back(size * std::sin(cos));
  }
  return r;
}

} // namespace ada::test

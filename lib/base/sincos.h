// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Sine and cosine of many numbers at once, by the best vector unit of the machine.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace ada {

/// sine[i], cosine[i] of x[i], rad; within 4e-16 for |x| up to 1e8 (beyond: as exact as the
/// argument allows, about |x| * 1e-16). Not finite gives NaN. Either output may be x itself.
void sincos_of(const double *x, std::size_t n, double *sine, double *cosine);

/// use(i, sine, cosine) of the angles phase(i), rad, of i = 0 .. n - 1 in turn.
template <class Phase, class Use> void for_each_sincos(std::size_t n, Phase phase, Use use) {
  constexpr std::size_t kBlock = 256;
  std::array<double, kBlock> x, sine, cosine;
  for (std::size_t from = 0; from < n; from += kBlock) {
    const std::size_t count = std::min(kBlock, n - from);
    for (std::size_t k = 0; k < count; ++k)
      x[k] = phase(from + k);
    sincos_of(x.data(), count, sine.data(), cosine.data());
    for (std::size_t k = 0; k < count; ++k)
      use(from + k, sine[k], cosine[k]);
  }
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "model/remainder.h"

#include <cmath>
#include <string>

#include "base/error.h"

namespace ada {

double PeriodicRemainder::rms() const {
  double sum = 0.0; // a cosine's and a sine's mean square is a half, and there are two channels
  for (const FourierPair &k : series(1.0))
    sum += k.cos_first * k.cos_first + k.sin_first * k.sin_first + k.cos_second * k.cos_second +
           k.sin_second * k.sin_second;
  return std::sqrt(0.25 * sum);
}

std::vector<FourierPair> PeriodicRemainder::series(double factor) const {
  const std::size_t n = orders();
  if (n < 1 || n > kHighestOrder || sin_sin.size() != n || cos_cos.size() != n ||
      cos_sin.size() != n)
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                "the four series of a periodic remainder must be of one length, from 1 to " +
                    std::to_string(kHighestOrder));
  std::vector<FourierPair> out(n);
  for (std::size_t i = 0; i < n; ++i)
    out[i] = {factor * sin_cos[i], factor * sin_sin[i], factor * cos_cos[i], factor * cos_sin[i]};
  return out;
}

} // namespace ada

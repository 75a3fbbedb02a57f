// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/over_supply.h"

#include <cmath>
#include <numeric>

namespace ada {

std::optional<PairOfChannels> over_supply(const Capture &capture) {
  if (!capture.has_vdd())
    return std::nullopt;
  const std::size_t n = capture.size();
  const double mean =
      std::accumulate(capture.vdd_v.begin(), capture.vdd_v.end(), 0.0) / static_cast<double>(n);
  if (!(mean > 0.0))
    return std::nullopt;
  // A supply that moves by less than that moves the outputs by a quarter of a millivolt.
  constexpr double kSteady = 1e-4;
  double squares = 0.0;
  for (const double v : capture.vdd_v)
    squares += std::pow(v / mean - 1.0, 2) / static_cast<double>(n);
  if (!(squares > kSteady * kSteady))
    return std::nullopt;
  PairOfChannels out{std::vector<double>(n), std::vector<double>(n)};
  for (std::size_t i = 0; i < n; ++i) {
    const double ratio = capture.vdd_v[i] > 0.5 * mean ? mean / capture.vdd_v[i] : 1.0;
    out.sin_v[i] = capture.vsin_v[i] * ratio;
    out.cos_v[i] = capture.vcos_v[i] * ratio;
  }
  return out;
}

} // namespace ada

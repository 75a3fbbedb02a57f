// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/bins.h"

#include <algorithm>
#include <cmath>

namespace ada {

std::vector<Bin> bin_means(std::span<const double> key, std::span<const double> value, double from,
                           double to, std::size_t bins, std::size_t fewest) {
  struct Sums {
    double n = 0.0, key = 0.0, value = 0.0, square = 0.0;
  };
  if (!(to > from) || bins == 0)
    return {};
  std::vector<Sums> sums(bins);
  const double per_unit = static_cast<double>(bins) / (to - from);
  for (std::size_t i = 0; i < key.size(); ++i) {
    const double at = (key[i] - from) * per_unit;
    if (!(at >= 0.0) || at > static_cast<double>(bins) || !std::isfinite(value[i]))
      continue;
    Sums &s = sums[std::min(bins - 1, static_cast<std::size_t>(at))];
    s.n += 1.0;
    s.key += key[i];
    s.value += value[i];
    s.square += value[i] * value[i];
  }
  std::vector<Bin> out;
  bool gap = false;
  for (const Sums &s : sums) {
    if (s.n < static_cast<double>(std::max<std::size_t>(fewest, 1))) {
      gap = true;
      continue;
    }
    const double mean = s.value / s.n;
    const double spread = std::sqrt(std::max(0.0, s.square / s.n - mean * mean));
    out.push_back({s.key / s.n, mean, spread, spread / std::sqrt(s.n), gap && !out.empty()});
    gap = false;
  }
  return out;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Some values of a column, by their places, and a column in another width.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace ada {

/// The values at these places; none of an empty column.
template <class T>
std::vector<T> pick(const std::vector<T> &from, const std::vector<std::uint32_t> &indices) {
  std::vector<T> out;
  if (from.empty())
    return out;
  out.reserve(indices.size());
  for (std::uint32_t i : indices)
    out.push_back(from[i]);
  return out;
}

/// Of what a float cannot hold its largest; what is no number stays none.
inline float as_float(double x) {
  constexpr double kMost = std::numeric_limits<float>::max();
  return static_cast<float>(x > kMost ? kMost : x < -kMost ? -kMost : x);
}

inline std::vector<float> as_floats(std::span<const double> from) {
  std::vector<float> out(from.size());
  std::transform(from.begin(), from.end(), out.begin(), as_float);
  return out;
}

inline std::vector<double> as_doubles(std::span<const float> from) {
  return {from.begin(), from.end()};
}

} // namespace ada

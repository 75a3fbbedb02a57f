// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Some values of a column, by their places.
#pragma once

#include <cstdint>
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

} // namespace ada

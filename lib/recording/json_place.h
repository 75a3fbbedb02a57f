// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ada {

struct TextPlace {
  std::size_t line = 1, column = 1;
};

/// Line and column of byte `offset`, both from 1.
TextPlace place_of_offset(std::string_view text, std::size_t offset);

/// Where the value stands that the path leads to: names of objects' keys and, for arrays, indices
/// as numbers. `json` must be well-formed. A path that leads nowhere gives the place of the last
/// part that exists.
TextPlace place_in_json(std::string_view json, const std::vector<std::string> &path);

} // namespace ada

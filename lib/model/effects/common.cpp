// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "model/effects/common.h"

namespace ada {

std::vector<std::vector<double>> one_of_each(std::size_t parameters, std::size_t index, int first,
                                             int last) {
  std::vector<std::vector<double>> out;
  for (int value = first; value <= last; ++value) {
    std::vector<double> v(parameters, 0.0);
    v[index] = value;
    out.push_back(v);
  }
  return out;
}

} // namespace ada

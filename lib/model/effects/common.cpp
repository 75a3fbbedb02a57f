// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "model/effects/common.h"

#include <cmath>

namespace ada {

void TransferError::apply(Values v, Wave &w) const {
  const bool at_offset = v[1] == 1.0;
  const double a = 1.0 / w.amplitude_v;
  const auto bend = [&](double *signal, const double *offset) {
    for (std::size_t i = 0; i < w.n; ++i) {
      const double x = a * (signal[i] - (at_offset ? offset[i] : w.at.mid_shift_v));
      signal[i] += v[0] * w.amplitude_v * (order() == 2 ? x * x : x * x * x);
    }
  };
  bend(w.s, w.offset_s);
  bend(w.c, w.offset_c);
}

std::vector<std::vector<double>> TransferError::choices(Values v) const {
  return {{v[0], v[1] == 1.0 ? std::nan("") : 1.0}};
}

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

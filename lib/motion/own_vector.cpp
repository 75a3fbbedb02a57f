// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "motion/own_vector.h"

#include <cmath>

#include "base/robust.h"

namespace ada {

OwnVector own_vector(const Capture &c) {
  const Reach sine = bulk(c.vsin_v), cosine = bulk(c.vcos_v);
  const double sin_v = 0.5 * (sine.low + sine.high), cos_v = 0.5 * (cosine.low + cosine.high);
  OwnVector out{std::vector<double>(c.size()), std::vector<double>(c.size())};
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double s = c.vsin_v[i] - sin_v, co = c.vcos_v[i] - cos_v;
    out.angle[i] = std::atan2(s, co);
    out.length[i] = std::hypot(s, co);
  }
  out.usual_length_v = quantile(out.length, 0.5);
  return out;
}

} // namespace ada

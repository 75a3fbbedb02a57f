// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "motion/own_angle.h"

#include <cmath>

#include "base/robust.h"

namespace ada {

std::vector<double> own_angle(const Capture &c) {
  const Reach sine = bulk(c.vsin_v), cosine = bulk(c.vcos_v);
  const double sin_v = 0.5 * (sine.low + sine.high), cos_v = 0.5 * (cosine.low + cosine.high);
  std::vector<double> out(c.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = std::atan2(c.vsin_v[i] - sin_v, c.vcos_v[i] - cos_v);
  return out;
}

} // namespace ada

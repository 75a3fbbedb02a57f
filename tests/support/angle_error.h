// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Angle errors against the truth, wrapped to the shortest difference.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "base/angle.h"
#include "recording/capture.h"

namespace ada::test {

/// Rms of angle minus reference over the samples [first, last), mechanical degrees. A constant
/// difference is the zero angle that no calibration without a reference can know: taken out when
/// `zero_free`.
inline double rms_error_deg(std::span<const ada4571_angle> angles, const Capture &capture,
                            bool zero_free = false, std::size_t first = 0,
                            std::size_t last = ~std::size_t{0}) {
  const double period = 360.0 / capture.meta.periods_per_turn;
  double sum = 0, square = 0, n = 0;
  for (std::size_t i = first; i < std::min(last, capture.size()); ++i) {
    const double e = wrap_centred(angles[i].angle_deg - capture.reference_deg[i], period);
    sum += e;
    square += e * e;
    n += 1;
  }
  const double mean = zero_free ? sum / n : 0.0;
  return std::sqrt(square / n - mean * mean);
}

} // namespace ada::test

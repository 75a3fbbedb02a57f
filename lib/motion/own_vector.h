// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <vector>

#include "recording/capture.h"

namespace ada {

/// A pair as it was read, about the middle of the bulk of either channel: before anything is known
/// of its ellipse.
struct OwnVector {
  std::vector<double> angle;  ///< electrical, rad in (-pi, pi]
  std::vector<double> length; ///< V
  double usual_length_v = 0.0;
};
OwnVector own_vector(const Capture &capture);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The whole record sample by sample, so that a rare or slow disturbance is seen: the largest and
// smallest residual over time, and the worst stretch of all.
#pragma once

#include <vector>

#include "diagnosis/conditions/observations.h"
#include "model/model.h"

namespace ada {

/// Least and largest residual of a stretch of time, mV.
struct Extremes {
  double sin_low, sin_high, cos_low, cos_high;
};

struct Record {
  double start_s = 0.0;       ///< of the times below
  std::vector<double> time_s; ///< middle of each stretch that holds samples
  std::vector<Extremes> extremes;
  std::size_t shown = 0; ///< samples; the rest has no known angle
  // The largest residual of the extended model and its neighbours.
  double worst_s = 0.0, worst_v = 0.0;
  bool worst_in_sin = true;
  std::vector<double> near_s, near_sin, near_cos; ///< s after worst_s, mV
};

/// What the model leaves of every sample whose angle is known, also of those that no fit has used.
Record record_of(const Scene &scene, const Model &extended);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Causes whose course is random: slow processes, known only from the data, and the shape of the
// noise. They are read off what the model of everything else leaves over.
#pragma once

#include <vector>

#include "diagnosis/anonymous/anonymous.h"
#include "diagnosis/conditions/observations.h"
#include "diagnosis/search/data_split.h"

namespace ada {

struct RandomCause {
  const Effect *effect;
  std::vector<double> values, std_errors;
  std::vector<std::string> alternatives;
  double nats = 0.0;    ///< by which it raises the log likelihood of held-out data
  double slow_v2 = 0.0; ///< what it moves slowly, V^2, mean of a channel; 0: it is white
};

/// Whether a column of the anonymous model is the course of a slow process: of both offsets, or of
/// the gain, which moves the pair along the vector. What moves across it is an angle that drifts.
bool is_course_of(const Anonymous &left, Eigen::Index column, Pattern pattern);

/// Offsets and a gain that move slowly with time, where nothing that is recorded explains them.
/// `left`: what the named model leaves over; `periods`: electrical ones in the record; `counts`:
/// whether the reference counts in coarse steps.
std::vector<RandomCause> slow_causes(const Anonymous &left, const DataSplit &split,
                                     const Model &model, double periods, bool counts);

/// Part of the power of one slow process that passes for another one: what is faster than its
/// functions. Offsets and a gain differ by a turn of the vector, which tells them apart the better
/// the more `periods` of it come to each of the `waves` half waves.
double crosstalk(double periods, double waves);

/// What else is known of the noise.
struct NoiseSeen {
  double stated_v = 0.0;     ///< by the capture or by a model; 0: not
  double step_rad = 0.0;     ///< of the reference, however small: the last count of its readings
  double lines_across = 0.0; ///< of what lies across the vector, the part that comes with the rows
  const Observations *in_order = nullptr; ///< the whole record
  bool even_clock = false;                ///< whether a spectrum of it means anything
};

/// The noise along and across the vector and over frequency.
std::vector<RandomCause> noise_causes(const Anonymous &left, const DataSplit &split,
                                      const Model &model, const NoiseSeen &seen);

/// Takes out of `slow` offsets what flicker noise among `noise` holds anyway: its spectrum goes on
/// to the `waves` half waves of a record of `span_s` by which they were seen.
void leave_to_flicker(std::vector<RandomCause> &slow, const std::vector<RandomCause> &noise,
                      int waves, double span_s);

} // namespace ada

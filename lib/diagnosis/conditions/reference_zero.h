// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Two records of one sensor whose references begin at different places of the shaft, or that have
// none. The pair tells the difference up to a period; which of the periods of a turn it is, what
// else repeats with the turn tells: a stray field, a magnet's flaw, a shaft that turns unevenly.
#pragma once

#include <vector>

#include "diagnosis/conditions/observations.h"

namespace ada {

class ReferenceZero {
public:
  explicit ReferenceZero(const Scene &record);

  /// By how much the angle of `other` must be moved to be counted as that of this record, rad.
  double move_of(const ReferenceZero &other) const;
  /// The same where the angle is the pair's own: whole periods, 0 where nothing tells them apart.
  double period_of(const ReferenceZero &other) const;
  /// The same of a record that most likely has the same reference: 0 unless the move fits better.
  double move_if_needed(const ReferenceZero &other) const;

private:
  struct Pattern;
  Pattern pattern(double moved_rad) const;
  double misfit(const Pattern &mine, const ReferenceZero &other, double moved_rad) const;
  double best_period(const Pattern &mine, const ReferenceZero &other, double moved_rad) const;

  int periods_ = 1;
  double zero_rad_ = 0.0;
  std::vector<double> alpha_, sin_, cos_; ///< of a fit with all that every pair has
};

/// In which of several joined captures a time lies, s.
std::size_t capture_at(const Capture &joined, double time_s);

/// Where one capture ends and the next begins no magnet has slipped: each has a zero angle of its
/// own, which what was not known then has bent. Moves what follows by what `found` leaves across
/// the vector, beside `noise_v`; false: nothing that matters.
bool move_zeros(Scene &scene, const Capture &joined, const Model &found, double noise_v);

} // namespace ada

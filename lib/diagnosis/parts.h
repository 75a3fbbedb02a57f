// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What fits may see and what only judges them, and how well a model describes both.
#pragma once

#include <memory>

#include "diagnosis/observations.h"
#include "diagnosis/result.h"

namespace ada {

class RecentAnonymous;

struct Parts {
  Observations train, heldout;
  bool has_reference = false;
  bool own_angle = false;         ///< that of the pair: nothing of its noise lies across the vector
  bool second_capture = false;    ///< judges, with a zero angle of its own
  bool courses_taken_out = false; ///< those of the slow processes that have a name
  /// What anonymous_of said last, which is asked of one model several times in a row; null: nothing
  /// is kept. Shared by all copies.
  std::shared_ptr<RecentAnonymous> recent;

  /// How residuals weigh along a disturbance that is not recorded, in fits and in judging.
  void weigh(Direction direction, double weight);
  Rung rung(const Model &model) const;
};

/// Mean square of the held-out residual of a model, V^2 of a channel.
double left_v2(const Parts &parts, const Model &model);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What fits may see and what only judges them, and how well a model describes both.
#pragma once

#include <memory>
#include <optional>

#include "diagnosis/conditions/observations.h"
#include "diagnosis/words/result.h"

namespace ada {

class RecentAnonymous;

struct DataSplit {
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
  SplitQuality quality(const Model &model) const;
};

/// The same parts without the covariance of what has no name: a copy only where they have one. The
/// parts must outlive it and stay as they are.
class Uncoloured {
public:
  explicit Uncoloured(const DataSplit &of) : of_(of) {
    if (!of.train.coloured)
      return;
    copy_ = of;
    copy_->train.coloured.reset();
  }
  const DataSplit &split() const { return copy_ ? *copy_ : of_; }

private:
  const DataSplit &of_;
  std::optional<DataSplit> copy_;
};

/// Mean square of the held-out residual of a model, V^2 of a channel.
double left_v2(const DataSplit &split, const Model &model);

} // namespace ada

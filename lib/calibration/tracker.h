// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Dynamic calibration: the stored calibration in force from the first sample, and its offsets (and
// amplitudes and quadrature error where wanted) moved along while the magnet turns.
//
// Every whole mechanical turn gives one measurement of what the ellipse has moved by
// (turn_window.h), counted for the middle of that turn; a trend filter (trend_filter.h) carries it
// to the present. Nothing is learnt from what cannot teach: a magnet at rest, less than a turn, a
// turn with a gap, spikes, samples with a status, a step that no believable drift explains.
// Constant memory, no allocation.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "base/frame.h"
#include "calibration/trend_filter.h"
#include "calibration/turn_window.h"
#include "conversion/ellipse.h"
#include "recording/gap_detector.h"

namespace ada {

struct TrackerOptions {
  bool track_amplitude = false;          ///< mean amplitude and mismatch
  bool track_phase = false;              ///< quadrature error
  double max_offset_rate_v_per_s = 0.02; ///< drift that is believed
};

class Tracker {
public:
  /// Throws ADA4571_ERROR_UNSUPPORTED for a model with effects beyond the ellipse, and
  /// ADA4571_ERROR_INVALID_ARGUMENT for a rate that is no positive number.
  Tracker(const Model &model, const TrackerOptions &options);

  void frames(std::span<const Frame> in, std::span<ada4571_angle> out);

  /// The calibration in force now, as a model of its own.
  Model model() const;

private:
  /// Removes isolated spikes before they reach a window: a sample is judged when both its
  /// neighbours are known.
  struct Pending {
    double time_s, sin_psi, cos_psi, distance_v;
  };

  EllipseParameters in_force(double time_s, double vtemp_v) const;
  void learn(const Pending &sample);
  void judge(const Pending &sample);
  void accept(const TurnEstimate &turn);
  void forget_neighbours() { known_ = 0; }

  Model model_;
  EllipseModel ellipse_;
  TrackerOptions options_;
  double amplitude_v_;
  std::array<TrendFilter, kEllipseSize> trend_;
  TurnWindow window_;
  GapDetector gaps_;
  std::array<Pending, 2> neighbours_{};
  int known_ = 0;                  ///< how many of them
  int unsound_ = 0;                ///< samples in a row that have a status
  double usual_unexplained_v_ = 0; ///< of the turns that were believed
  double scatter_v_;               ///< running typical size of second differences
  double vtemp_v_, time_s_;
  bool begun_ = false;
};

} // namespace ada

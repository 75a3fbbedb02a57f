// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Collects distances from the calibrated ellipse over whole mechanical turns and gives what the
// ellipse has moved by. Distances are averaged in bins of the angle first, so that every angle
// counts alike at any speed, and one mechanical turn has all bins: a constant stray field adds
// mechanical orders 1 and 3, which cancel over whole turns and over nothing less.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "calibration/ellipse_fit.h"

namespace ada {

/// What the ellipse has moved by during one window.
struct TurnEstimate {
  double time_s = 0; ///< centre of the window
  double duration_s = 0;
  std::array<double, kEllipseSize> change{}; ///< by EllipseIndex; amplitude and centres in volts
  std::array<double, kEllipseSize> error{};  ///< standard errors
  /// Drift of the centres while the turn lasted, V/s, beyond that of the ellipse it was compared
  /// with; errors are infinite where the bins hold several turns, whose times are mixed.
  double rate_sin = 0, rate_cos = 0, rate_sin_error = 0, rate_cos_error = 0;
  double unexplained_rms_v = 0; ///< of the bins, what no ellipse explains
};

class TurnWindow {
public:
  explicit TurnWindow(int periods_per_turn);

  /// One sound sample: unit vector of psi, distance from the ellipse (volts, outward). An estimate
  /// comes back when whole turns are complete and their angles covered.
  std::optional<TurnEstimate> add(double time_s, double sin_psi, double cos_psi, double distance_v,
                                  double amplitude_v);
  /// Begins anew, because turns can no longer be counted or the reference has changed.
  void reset();
  /// Whether the magnet has not moved on to another bin for longer than a turning one would.
  bool stands_still() const { return still_; }

private:
  struct Bin {
    double n = 0, distance = 0, square = 0, sin = 0, cos = 0, time = 0;
  };
  static constexpr std::size_t kMaxBins = 256;

  bool covered() const;
  std::optional<TurnEstimate> solve(double amplitude_v) const;

  std::array<Bin, kMaxBins> bins_;
  std::size_t count_; ///< bins of one mechanical turn
  double turn_rad_;   ///< electrical
  bool empty_ = true, still_ = false, several_turns_ = false;
  double psi_ = 0, from_ = 0, raw_ = 0; ///< unwrapped now and at the beginning; wrapped
  double first_time_ = 0, last_time_ = 0, moved_time_ = 0;
  std::size_t bin_ = 0;
};

} // namespace ada

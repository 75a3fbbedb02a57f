// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Angles under a model with any effects: the forward model is inverted sample by sample, so that
// correction needs no formulas of its own. Effects that belong to the reference, the drive or the
// recording are left out.
#pragma once

#include <cstddef>
#include <limits>
#include <span>

#include "model/forward.h"
#include "recording/capture.h"

namespace ada {

class AngleSolver {
public:
  explicit AngleSolver(const Model &model);

  /// For each sample the angle whose modelled pair lies nearest to the measured one: Gauss-Newton
  /// in one dimension. `alpha` (rad, mechanical) holds starting values within an eighth of a period
  /// and then the solution; `radius` the measured radius over the modelled one. Conditions give
  /// speed, temperature and supply; their own alpha is not used.
  void solve(const Conditions &at, std::span<const double> vsin, std::span<const double> vcos,
             std::span<double> alpha, std::span<double> radius) const;

  /// Starting values: the baseline alone, in [0, 2 pi/p).
  void start(std::span<const double> vsin, std::span<const double> vcos,
             std::span<double> alpha) const;

  /// A whole capture: speed from both sides of each sample. With p > 1 an effect of the field knows
  /// the whole turn, which the pair does not show: which part of a turn the record begins in comes
  /// from the reference where there is one, else from the evenness of the motion.
  void capture(const Capture &capture, std::span<ada4571_angle> out) const;

  /// A live stream: speed, sense and turn are carried from block to block. The part of a turn that
  /// the first frame lies in is taken from its reference_deg, or else is the first.
  void frames(std::span<const Frame> frames, std::span<ada4571_angle> out);

private:
  void find_sense();
  double phase(double vsin, double vcos) const;

  Model model_;
  ForwardModel forward_;
  double amplitude_v_, centre_sin_v_, centre_cos_v_, zero_rad_;
  int periods_;
  double back_rad_ = 0.0;  ///< by which a shaft has turned back, and not the noise
  double supply_fraction_; ///< rms_fraction of supply-variation, 0 without
  double step_rad_;        ///< of the differences that give the slope
  int iterations_;         ///< at most
  bool backwards_ = false; ///< wiring turns the pair around
  double phase_at_zero_ = 0.0;

  struct Stream {
    bool running = false;
    signed char sense = 1;
    double time = 0.0, alpha = 0.0, omega = 0.0, vdd_mean = 0.0, vdd_count = 0.0;
    double furthest = 0.0;                                    ///< angle in the sense of rotation
    double turned = -std::numeric_limits<double>::infinity(); ///< angle where it turned back
  } stream_;
};

} // namespace ada

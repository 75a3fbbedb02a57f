// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Produces the frames of a simulation in order, a chunk at a time.
#pragma once

#include <cstddef>
#include <limits>
#include <random>

#include "model/forward.h"
#include "recording/capture.h"
#include "simulation/profile.h"
#include "simulation/simulation.h"

namespace ada {

class Generator {
public:
  explicit Generator(const Simulation &simulation);

  /// The next `count` samples, with the effects that act on the record applied to this chunk.
  Capture next(std::size_t count);

private:
  struct Columns;
  void conditions(std::size_t count, Columns &columns);
  void disturb(const Conditions &at, Capture &capture);
  double quantised(double volts) const;

  Model model_;
  SimulationOptions options_;
  ForwardModel forward_;
  PiecewiseLinear speed_, temperature_;
  Rng rng_;
  std::vector<EffectInstance> effects_;     ///< in physical order
  std::vector<std::vector<double>> memory_; ///< of each of them, from one part to the next
  std::size_t index_ = 0;
  signed char sense_ = 1;                                    ///< of the last sample
  double turned_ = -std::numeric_limits<double>::infinity(); ///< angle where it turned back, rad
  double lag_s_ = 0.0, supply_rms_ = 0.0, supply_phase_slow_, supply_phase_fast_, start_angle_;
  double vtemp_ = 0.0;
};

} // namespace ada

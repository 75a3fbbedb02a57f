// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Causes that change the noise and not the signal: spikes, and white noise above what was stated.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "diagnosis/conditions/observations.h"
#include "model/model.h"

namespace ada {

/// Isolated spikes against a model: those that the first look left out and those that only stand
/// out of the model's residual.
struct Spikes {
  bool found = false;
  double rate = 0.0, amplitude_v = 0.0; ///< fraction of samples; rms
  double rate_error = 0.0, amplitude_error_v = 0.0;
  std::vector<char> hit; ///< of the scene's usable samples
  /// Held-out log likelihood a sample with one normal distribution, and with spikes beside it.
  double before = 0.0, after = 0.0;
  /// Samples that stand out as spikes do, but several in a row, at the same places in the turn, at
  /// the same level of their channel or on the curve that the pair draws.
  struct {
    std::size_t count = 0;
    double rms_v = 0.0;              ///< of a channel
    std::optional<double> place_rad; ///< where most of them lie
    std::optional<double> level_v;   ///< of a channel, where most of them lie
    bool on_curve = false;
  } no_spikes;
  /// Too few to tell how often they come, and left out by the first look all the same.
  struct {
    std::size_t count = 0;
    double rms_v = 0.0, worst_v = 0.0; ///< of a channel; of the one that departs the most
  } few;
};

/// `heldout`: places in `scene.all` that no fit has seen; empty: all.
Spikes spikes_against(const Scene &scene, const Model &model,
                      const std::vector<std::uint32_t> &heldout, double noise_v);

/// Least rms of the residual in any direction of the pair: white noise of both channels shows in
/// all alike. Without a reference only the radius is no matter of the motion.
double rms_in_any_direction(const Observations &data, const Model &model, bool has_reference);

/// Noise where it is loudest, V rms of a channel: it may grow with the speed, and a spike stands
/// out of the noise about it.
double loudest_noise(const Observations &data, const Model &model);

} // namespace ada

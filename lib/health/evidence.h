// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What all checks look at, made once: the recording's own ellipse, a sample of it with its angles
// against the yardstick, and what was counted over all of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/recording_fit.h"
#include "health/tally.h"
#include "model/model.h"

namespace ada::health {

/// "VSIN" or "VCOS" with the sample from which it stays put while the other one moves on; "VSIN and
/// VCOS" where both keep a value that noise would not leave them.
struct StuckChannel {
  std::string name;
  std::size_t first = 0, samples = 0;
  bool frozen = false; ///< the same value from sample to sample, whether the magnet turns or not
};

struct Evidence {
  const RecordingToFit &what;
  const Capture &capture; ///< the sample, which is all of a short recording
  Model yardstick{};
  std::string yardstick_name{};
  bool states_noise = false; ///< what was fitted to the capture states no more than it shows
  std::vector<ada4571_angle> angles{}; ///< of the sample
  bool turns = false;                  ///< the pair moves
  std::optional<EllipseFit> ellipse{}; ///< of this capture, where it proves to be one
  std::string no_ellipse{};            ///< why there is none
  bool no_circle = false;              ///< the samples prove that there is none
  bool levels_only = false;            ///< and stand at a few points
  std::optional<StuckChannel> stuck{};
  double usual_step_s = 0; ///< of time
  Tally tally{};

  /// The pair through time, in which a channel may stand: the sample of a short recording, single
  /// pairs of a long one.
  const std::vector<double> &path_sin() const {
    return what.is_long ? tally.path.vsin_v : capture.vsin_v;
  }
  const std::vector<double> &path_cos() const {
    return what.is_long ? tally.path.vcos_v : capture.vcos_v;
  }
  /// Sample of the recording that stands at this place of the path.
  std::size_t path_place(std::size_t of_path) const;
};

/// The step of the converter, V, where the capture states it.
std::optional<double> stated_step(const CaptureMetadata &meta);

/// `model` as for check_health.
Evidence gather(const RecordingToFit &what, const Model *model);

} // namespace ada::health

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What all checks look at, made once: the angles against the yardstick, the capture's own ellipse,
// and the samples that stand alone.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/ellipse_fit.h"
#include "model/model.h"
#include "recording/capture.h"

namespace ada::health {

/// "VSIN" or "VCOS" with the sample from which it stays put while the other one moves on.
struct StuckChannel {
  std::string name;
  std::size_t first = 0, samples = 0;
};

struct Evidence {
  const Capture &capture;
  Model yardstick{};
  std::string yardstick_name{};
  bool states_noise = false; ///< what was fitted to the capture states no more than it shows
  std::vector<ada4571_angle> angles{};
  bool turns = false;                  ///< the pair moves
  std::optional<EllipseFit> ellipse{}; ///< of this capture, where it proves to be one
  std::string no_ellipse{};            ///< why there is none
  bool no_circle = false;              ///< the samples prove that there is none
  std::optional<StuckChannel> stuck{};
  std::vector<std::size_t> spikes{}; ///< samples of the pair that stand alone, ascending
};

/// `model` as for check_health.
Evidence gather(const Capture &capture, const Model *model);

std::optional<StuckChannel> find_stuck(const Capture &capture);

} // namespace ada::health

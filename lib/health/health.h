// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Is the sensor healthy: the faults that a capture shows without any model of the errors. Each
// check measures one number, compares it with one limit, and says what it means.
#pragma once

#include <string>
#include <vector>

#include "calibration/recording_to_fit.h"
#include "model/model.h"

namespace ada {

enum class HealthState {
  passed,
  failed,
  unknown, ///< this capture cannot show it; `explanation` says why
};

struct HealthCheck {
  std::string id; ///< "radius", "rails", ...
  HealthState state = HealthState::unknown;
  double measured = 0; ///< NaN where nothing was measured
  double limit = 0;    ///< `measured` may not exceed it; NaN where there is none
  std::string unit;
  std::string explanation;       ///< one sentence for a person
  std::vector<double> times_s{}; ///< where it was seen, the first kMostTimes of them
};

struct Health {
  std::string against;  ///< what radius and noise were compared with
  bool too_few = false; ///< samples to judge a sensor by
  std::vector<HealthCheck> checks;

  /// There was enough to judge by, and no check failed.
  bool sound() const;
};

/// `model` NULL: the ellipse that fits the capture, or where none does, a nominal ADA4571.
/// Throws ADA4571_ERROR_UNUSABLE_DATA for an empty capture, and when the model follows VTEMP and
/// the capture has none.
Health check_health(const RecordingToFit &what, const Model *model);
Health check_health(const Capture &capture, const Model *model);

/// "ada4571-check/1".
std::string health_json(const Health &health);
/// The same for a person: a line a check, and a verdict.
std::string health_text(const Health &health);

} // namespace ada

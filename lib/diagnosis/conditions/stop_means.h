// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A table that stops has an error of its own at each stop, the same in all readings there: they are
// one reading, and no more of them tell more of the sensor.
#pragma once

#include <optional>

#include "diagnosis/words/result.h"
#include "recording/capture.h"

namespace ada {

struct StopMeans {
  Capture means; ///< of the readings of each stop
  /// From stop to stop beyond the noise, and beyond what the converter rounds off, V rms of a
  /// channel.
  double errs_v = 0.0;
  double reading_noise_v = 0.0; ///< of one reading within a stop, a channel
};

/// The means of the stops of a table that do not stand where the reference says, or at which the
/// sensor errs by itself: where neighbouring stops differ by far more than parts of a stop do,
/// beside what goes smoothly with the angle. Nothing of a shaft that turns while it is read, of a
/// table that stands right, or of one that stopped too seldom to tell.
std::optional<StopMeans> means_of_stops(const Capture &capture);

/// As much of what stops err by as a model leaves that leaves so much of the readings, V rms of a
/// channel; 0: next to nothing.
double left_at_stops(const StopMeans &stops, double residual_v);

/// A result, and what each stop has for itself: it goes with the place, and no cause has its name,
/// so that it is left over. `left_v`: as much of it as the model leaves; 0: nothing.
Diagnosis with_stops(const StopMeans &stops, double left_v, Diagnosis out);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A reference whose degrees are not the shaft's: an integrated gyroscope, a gear or a belt, a motor
// with other steps a turn than were counted, a potentiometer of several turns; or one that drifts.
// No fault of a sensor that turns with the shaft grows with the way: after a turn it is where it
// was. Within one turn the way looks like an error once a turn, and what is left of it like one
// twice a turn. Or one that is read by a clock of its own, and so is late by more and more: what it
// goes away by is the speed times the time.
#pragma once

#include <optional>

#include "recording/capture.h"

namespace ada {

/// How a reference goes away from the shaft.
struct ReferenceCourse {
  int numbers = 0;                             ///< that were fitted
  double rms_rad = 0.0;                        ///< of all of it, of the shaft
  double scale = 1.0, scale_error = 0.0;       ///< degrees of the reference for each of the pair's
  double drift_deg_s = 0.0, drift_error = 0.0; ///< beside it, where the shaft turns unevenly
  /// By which it is later and later than the pair, us a second: read by a clock of its own.
  double clock_ppm = 0.0, clock_error = 0.0;
  double bend_deg = 0.0;      ///< from the most to the least of what it goes away by beside both
  bool within_a_turn = false; ///< nowhere does the record come round to where it was
};

struct FollowedReference {
  Capture mended; ///< the capture with the degrees that the pair turned by
  ReferenceCourse course;
};

/// A reference that goes away from the pair, and how: in a straight line over the way and over
/// time, over several turns in a plain curve, or by a clock of its own. That says more of it than
/// errors of any low order of the turn, and leaves little else that is slow.
std::optional<FollowedReference> followed_reference(const Capture &capture);

} // namespace ada

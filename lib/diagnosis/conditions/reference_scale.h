// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A reference whose degrees are not the shaft's: an integrated gyroscope, a gear or a belt, a motor
// with other steps a turn than were counted; or one that drifts. No fault of a sensor that turns
// with the shaft grows with the way: after a turn it is where it was. Within one turn the way looks
// like an error once a turn, and what is left of it like one twice a turn.
#pragma once

#include <optional>

#include "recording/capture.h"

namespace ada {

struct ReferenceScale {
  Capture mended;             ///< the capture with the degrees that the pair turned by
  double scale, error;        ///< degrees of the reference for each of the pair's, standard error
  double drift_deg_s;         ///< of the reference beside its scale; 0 where the shaft turns evenly
  double drift_error;         ///< standard error
  bool within_a_turn = false; ///< nowhere does the record come round to where it was
};

/// The scale of a reference where it is not one, and its drift: where the pair departs from it in a
/// straight line over the way and over time, which says more of them than errors of any low order
/// of the turn, and leaves little else that is slow.
std::optional<ReferenceScale> reference_scale(const Capture &capture);

} // namespace ada

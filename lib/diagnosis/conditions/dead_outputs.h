// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A record that begins or ends with both outputs standing at a place off the curve that the rest of
// it draws: there the sensor has no power, or is powered down. A shaft that stops stays on the
// curve.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "recording/capture.h"

namespace ada {

struct DeadOutputs {
  bool to_end = true; ///< of the record; otherwise from its start
  double at_s = 0.0;  ///< the moment at which the pair leaves its curve, or comes to it
  double sin_v = 0.0, cos_v = 0.0;
  std::size_t count = 0; ///< rows, with those on the way there
  double off_v = 0.0;    ///< from the curve, at the place itself
};

/// Takes such rows out of `usable`. At most one at either end.
std::vector<DeadOutputs> leave_out_dead_outputs(const Capture &capture, std::span<char> usable);

} // namespace ada

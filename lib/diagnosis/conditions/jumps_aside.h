// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Jumps by which the angle of the pair and that of its reference come apart, or together again.
#pragma once

#include <vector>

#include "diagnosis/conditions/observations.h"

namespace ada {

/// From `time_s` on the pair is ahead of its reference by this much more, mechanical.
struct JumpAside {
  double time_s, by_rad;
};

/// Of the angle that the pair's own ellipse tells, at all usable rows of a record with a reference.
/// A search for one jump after the other may accept none where they take each other back: each
/// alone makes the rest of the record worse. None where there are more of them than can be said
/// to be single ones, or where the pair draws no ellipse of its own.
std::vector<JumpAside> jumps_aside(const Observations &data, int periods);

} // namespace ada

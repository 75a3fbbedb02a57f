// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A range that a channel never reads although it passes there: what reads it puts two ranges
// together that do not join.
#pragma once

#include <cstddef>
#include <optional>

#include "recording/capture.h"

namespace ada {

struct LevelGap {
  bool of_cos;
  double low_v, high_v;  ///< the last readings on either side
  double jump_v;         ///< beyond the steps beside it
  std::size_t crossings; ///< how often
};

/// The gap of a capture, if each time that a channel passes it jumps by the same, far beyond its
/// steps before and after, while the other channel goes on as it did: a magnet that jumps takes
/// both channels along, and one that stands at several places leaves several gaps.
std::optional<LevelGap> level_gap(const Capture &capture);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Episodes in which the pair, or the reference, is not what it was before and is again after: a
// contact that opens, a cable that is moved, a converter or a reference that holds a value. They come
// and go, whatever the angle, and the rest of the record lies on one curve. No cause within the sensor
// does that, and no fit may follow it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "recording/capture.h"

namespace ada {

struct Episodes {
  std::size_t count = 0, samples = 0;
  double longest_s = 0.0, first_s = 0.0; ///< the latter is when the first of them begins
  double squares_v2 = 0.0;               ///< what they are off the curve by, the sum over all samples
  double worst_v = 0.0;                  ///< the farthest off the curve
  bool at_one_place = false;             ///< most come again there, turn for turn
  Episodes &operator+=(const Episodes &more);
};

/// Finds them among the samples that are usable, and takes them out of these: off the curve in
/// radius, or in angle from the reference where that begins or ends at once. None where the rest
/// does not lie on one ellipse, where they are many, reach an end of the record, or come at the
/// same angles again and again: then it is the signal that is like that, but for what no magnet
/// does.
Episodes leave_out_episodes(const Capture &capture, std::span<char> usable);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// White noise of a record before any fit, from what differs between neighbours.
#pragma once

#include "model/residual.h"

namespace ada {

/// Of a channel, rms of both, from sample to sample, by differences, in which slow signals vanish:
/// the higher their order the better, while white noise is the same in all, and of readings at rest
/// the shortest has the fewest moves in it: the least of five orders. From one sample to the next
/// but one a tone of half the sample rate vanishes, too. A median of 0 tells that half of the
/// readings repeat the one before in the steps of their converter. One channel may be the noisier,
/// or the noise may lie along the vector or across it: seen in other directions, such noise comes
/// and goes, and the median makes it less than it is.
double white_noise(const Screened &look);

} // namespace ada

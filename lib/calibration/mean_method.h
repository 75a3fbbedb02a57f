// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Offsets as the mean over whole mechanical turns, and amplitudes as the second moments.
//
// The mean of a sine is its offset only when the samples stand evenly in *angle*. A time column at
// a speed that varies does not give that (2 % of ripple at the second order shifts a plain mean by
// 2 % of the amplitude), so the mean is taken as an integral over the measured angle,
//
//   O = 1/(2 pi p m) Int v dpsi   over m whole mechanical turns,
//
// with psi itself measured about the offsets found so far, until both agree. A magnet that stands
// still adds nothing, a stretch run to and fro cancels. Whole *mechanical* turns: a constant stray
// field adds mechanical orders 1 and 3, whose means over a single electrical period are not zero.
#pragma once

#include "calibration/angle_path.h"
#include "calibration/pair_estimate.h"

namespace ada {

/// `fit` serves to leave out spikes and to count turns. Throws ADA4571_ERROR_UNUSABLE_DATA when the
/// capture holds no whole mechanical turn.
void estimate_by_mean(const Capture &capture, const EllipseFit &fit, PairEstimate &estimate);

} // namespace ada

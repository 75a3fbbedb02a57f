// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Offsets as (max + min)/2 and amplitudes as (max - min)/2 of each channel, turn by turn, then the
// mean over the turns.
//
// Biases that the method has and keeps: noise pushes an extreme outward by a few sigma, which
// cancels in the offset and adds to the amplitude (a common factor, so only the radius sees it);
// n samples a period miss a peak by up to A pi^2/(2 n^2), which cancels in the offset only when
// both peaks are missed alike. Quadrature error does not show in extremes.
#pragma once

#include "calibration/angle_path.h"
#include "calibration/pair_estimate.h"

namespace ada {

/// `fit` serves to leave out spikes and to count turns. Throws ADA4571_ERROR_UNUSABLE_DATA when the
/// capture holds less than one electrical period.
void estimate_by_extrema(const Capture &capture, const EllipseFit &fit, PairEstimate &estimate);

} // namespace ada

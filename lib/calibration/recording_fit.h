// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The fit of calibration/ellipse_fit.h to recordings of any length, in memory that does not grow
// with it. A short one is fitted as it is. Of a long one a sample spread over it is fitted first;
// from there Gauss-Newton goes on over all samples, a pass a step, until a step is small beside the
// standard errors. A pass adds up, in fine bins of psi, number, distance and its square: to first
// order the normal equations, the residual under any weights of the angles, and what the samples
// scatter by all follow from those sums, since the derivatives of a distance are functions of psi.
// Whatever the number of threads, blocks and their order are the same, and so is the result.
#pragma once

#include "calibration/recording_to_fit.h"

namespace ada {

/// Histogram of the distances of a long recording, for their median: this many cells over this many
/// sigmas of the first fit.
inline constexpr std::size_t kDistanceCells = 128;
inline constexpr double kDistanceSigmas = 4.0;

/// As fit_ellipse; but `accepted` is of the samples of `what.sample`.
EllipseFit fit_ellipse(const RecordingToFit &what, const EllipseFitOptions &options = {});

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The electrical angle of a capture, unwrapped: how far the magnet has turned.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "calibration/ellipse_fit.h"
#include "recording/capture.h"

namespace ada {

struct AnglePath {
  std::vector<std::size_t> sample; ///< samples that lie on the ellipse, in order
  std::vector<double> psi;         ///< electrical, unwrapped, rad; one a sample of the list
};

/// Places of angles that lie far from where their neighbours lead, on a circle: from the lines
/// through the two before them, the two after them, and the two about them, so that neither a
/// reversal nor a gap counts; at an end there are those on one side. Far is more than `sigmas` of
/// their usual distance from the middle of their neighbours, which is taken for `floor_rad` at
/// least, and more than `ways` times the way that the neighbours move by themselves. What is not
/// rare is no leap (base/robust.h).
std::vector<std::size_t> leaps(std::span<const double> psi, double sigmas, double floor_rad,
                               double ways);

/// The two halves of that, for angles that are measured in one place and searched in others: what
/// counts as far, rad, and the places, however many.
double leap_limit(std::span<const double> psi, double sigmas, double floor_rad);
std::vector<std::size_t> leaps_beyond(std::span<const double> psi, double limit_rad, double ways);

/// The given samples about an ellipse. Each step is taken the shortest way; across up to
/// kMissedSamples samples that the list leaves out, the shortest way from where the step before
/// them leads on to, so that a spike at a high speed does not cost a period.
AnglePath path_of(const Capture &capture, std::vector<std::size_t> samples,
                  const EllipseParameters &ellipse);

/// The same for all samples that the fit accepted, but for those that leap: on the ellipse by
/// chance, they would tear the path apart. Throws ADA4571_ERROR_UNUSABLE_DATA where the
/// magnet turns so fast that the steps from sample to sample are ambiguous (half an electrical
/// period and more).
AnglePath unwrap(const Capture &capture, const EllipseFit &fit);

} // namespace ada

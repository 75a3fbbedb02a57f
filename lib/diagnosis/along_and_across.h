// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What is left along the vector and across it.
#pragma once

#include <optional>
#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/observations.h"

namespace ada {

double mean_square(const std::vector<double> &x);

/// Residual as what a gain makes, along the vector, and what an angle does, along the figure that
/// the pair draws, V, after what the columns hold already.
void split(const Observations &data, const ResidualColumns &rest, std::vector<double> &along,
           std::vector<double> &across);

/// Takes out what lies along the circle: without a reference the motion is the pair's own,
/// smoothed, and what the smoothing leaves of it is as slow as flicker noise.
void keep_radial(const Observations &data, ResidualColumns &rest);

/// White noise along the vector and across it where the angle is the pair's own, V^2, from
/// differences from sample to sample.
struct Directions {
  double along_v2, across_v2;
  double gain_v2, gain_error_v2; ///< of the noise that lies along the vector alone
};

/// Differences of what lies along and across, in order and scaled to keep white noise as it is: the
/// motion is in those across, of which a smooth one leaves nothing, and a rough one makes more,
/// never less. Of the channels' own noise, which may be unlike, the two get cos(2 psi) of a share:
/// beside that what is left of along less across is a noise of the gain. Nothing where too few rows
/// follow each other.
std::optional<Directions> by_differences(const Observations &whole, const Model &model);

} // namespace ada

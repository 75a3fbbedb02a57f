// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What is left along the vector and across it.
#pragma once

#include <optional>
#include <vector>

#include "diagnosis/conditions/observations.h"
#include "diagnosis/search/fit.h"

namespace ada {

double mean_square(const std::vector<double> &x);

/// Residual as what a gain makes, along the vector, and what an angle does, along the figure that
/// the pair draws, V, after what the columns hold already.
void along_and_across(const Observations &data, const ResidualColumns &rest,
                      std::vector<double> &along, std::vector<double> &across);

/// Rms of what leads out of the figure, V.
double out_of_figure_rms_v(const Observations &data, const ResidualColumns &rest);

/// How many times the variance of noise that is the same in all directions is larger in these two,
/// which are oblique on an ellipse: 1 on a circle.
double stretched_by_axes(const Observations &data, const ResidualColumns &rest);

/// Takes out what lies along the circle: without a reference the motion is the pair's own,
/// smoothed, and what the smoothing leaves of it is as slow as flicker noise.
void keep_radial(const Observations &data, ResidualColumns &rest);

/// White noise where the angle is the pair's own, V^2.
struct Directions {
  double along_v2;               ///< as the angle shows it, out of which a noise of the gain stays
  double gain_v2, gain_error_v2; ///< of the noise that lies along the vector alone
};

/// Differences in order of what lies out of the figure and of the angle, scaled so that white noise
/// which is the same in all directions is as large in both as it is: the motion is in those of the
/// angle, of which a smooth one leaves nothing, and a rough one makes more, never less. Of the
/// channels' own noise, which may be unlike, and of what they have in common the two get shares
/// that go with their directions: beside those what is left of the one less the other is a noise of
/// the gain, which moves no angle. Nothing where too few rows follow each other.
std::optional<Directions> by_differences(const Observations &whole, const Model &model);

} // namespace ada

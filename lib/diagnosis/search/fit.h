// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Joint least squares of the baseline and any set of effects.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "diagnosis/conditions/observations.h"
#include "model/model.h"

namespace ada {

/// The part of VCOS that the model lets VTEMP carry over.
double vtemp_on_vcos(const Model &model);

/// All that is fitted, in one vector: A, O_sin, O_cos (V), zero (deg), then the coordinates of each
/// effect in turn.
std::vector<double> coordinates_of(const Model &model);
Model with_coordinates(const Model &model, std::span<const double> x);
/// Finite-difference step of each.
std::vector<double> coordinate_steps(const Model &model);

struct FitResult {
  Model model;
  Eigen::MatrixXd covariance; ///< of the coordinates, scaled by the residual's variance
  double rss = 0.0;           ///< whitened, V^2
  /// Part of the variance of each coordinate that what has no name gives; empty: none of it.
  Eigen::VectorXd unnamed_share;
  bool determined = false; ///< whether every coordinate is
};

/// Gauss-Newton with step halving from `start`. Residuals are taken as white with one variance,
/// which the fit itself estimates; that is what makes the covariance right.
FitResult fit(const Observations &data, const Model &start, int max_iterations = 8);

/// Where neighbouring samples err alike, fits are less certain than white noise would have it: the
/// errors are widened to what the score scatters by between stretches of the record (the sandwich
/// of White, Econometrica 48, 1980, with stretches as clusters: Liang and Zeger, Biometrika 73,
/// 1986).
void widen_by_scatter(const Observations &data, FitResult &result);

/// Writes the standard errors of a fit into its model.
void attach_errors(FitResult &result);

/// Whitened sum of squares of data minus model.
double sum_of_squares(const Observations &data, const Model &model);
/// The same without what nobody can name as a part of the noise.
double white_sum_of_squares(const Observations &data, const Model &model);

/// The model as these data see it, when they come from a second capture: the zero angle is their
/// own and no matter of the sensor; so are the offsets where `own_offsets` says that they moved.
Model as_seen_by(const Observations &data, Model model);

/// Whether both outputs follow what comes before them: a shift of the signals comes out by more
/// than half. One that stands at its stop shows nothing of the sensor's noise.
std::vector<char> where_outputs_pass(const Observations &data, const Model &model);

/// Data minus model, and the model, in volts.
struct ResidualColumns {
  std::vector<double> sin, cos, model_sin, model_cos;
  bool operator==(const ResidualColumns &) const = default;
};
ResidualColumns residual_columns(const Observations &data, const Model &model);
/// The same without the model's own columns: a long capture has no memory to spare.
ResidualColumns residuals_alone(const Observations &data, const Model &model);
/// How much an effect moves a channel with everything else unchanged, V rms: what other causes can
/// take over is still in it.
double moved_rms_v(const Observations &data, const Model &model, std::size_t effect);

/// The data with the angle of each sample moved to where the pair itself sees it, so that what is
/// left of the residual lies along the radius. Without a reference only that is no matter of the
/// motion.
Observations at_own_angle(Observations data, const Model &model);

/// Whether every parameter of the effects from `first` on lies in its range: a value that physics
/// forbids rules its cause out.
bool in_range(const Model &model, std::size_t first = 0);
bool in_range(const EffectInstance &instance);

} // namespace ada

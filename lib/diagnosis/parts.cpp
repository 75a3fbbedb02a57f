// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/parts.h"

#include <cmath>

#include "base/angle.h"
#include "conversion/angle_solver.h"
#include "diagnosis/fit.h"
#include "model/forward.h"

namespace ada {

namespace {

/// RMS error of the corrected angle on these samples against the magnet's angle: the reference,
/// with what the model knows to be wrong with the reference and the drive.
double angle_error(const Observations &data, const Model &model) {
  const AngleSolver solver(model);
  Conditions at = data.conditions();
  std::vector<double> alpha = data.alpha, radius(data.size()), magnet(data.size());
  ForwardModel(model, AlphaIs::reference).magnet_angle(at, magnet.data());
  solver.start(data.vsin, data.vcos, alpha);
  const double period = kTwoPi / model.periods_per_turn;
  for (std::size_t i = 0; i < alpha.size(); ++i)
    alpha[i] += period * std::round((magnet[i] - alpha[i]) / period);
  solver.solve(at, data.vsin, data.vcos, alpha, radius);
  double sum = 0.0;
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    const double e = wrap_centred(alpha[i] - magnet[i], period);
    sum += e * e;
  }
  return std::sqrt(sum / static_cast<double>(alpha.size())) * kDegPerRad;
}

/// `sigma` 0: the residual's own.
Quality quality(const Observations &data, const Model &model, double sigma, bool with_angle) {
  Quality q;
  const double n = static_cast<double>(data.size());
  if (n == 0.0)
    return q;
  const double rss = white_sum_of_squares(data, model);
  q.residual_rms_v = std::sqrt(rss / (2.0 * n));
  if (sigma <= 0.0)
    sigma = q.residual_rms_v;
  q.log_likelihood = std::log(data.weight_along) - std::log(kTwoPi * sigma * sigma) -
                     0.5 * rss / (n * sigma * sigma);
  if (with_angle)
    q.angle_error_rms_deg = angle_error(data, model);
  return q;
}

} // namespace

void Parts::weigh(Direction direction, double weight) {
  for (Observations *o : {&train, &heldout}) {
    o->disturbed = direction;
    o->weight_along = weight;
  }
}

Rung Parts::rung(const Model &model) const {
  Rung r;
  r.in_sample = quality(train, model, 0.0, has_reference);
  r.heldout = quality(heldout, second_capture ? as_seen_by(heldout, model) : model,
                      r.in_sample.residual_rms_v, has_reference);
  return r;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/search/data_split.h"

#include <cmath>

#include "base/angle.h"
#include "base/pick.h"
#include "conversion/angle_solver.h"
#include "diagnosis/criteria.h"
#include "diagnosis/search/fit.h"
#include "model/forward.h"

namespace ada {

namespace {

/// Takes out of the outputs what the model knows of this capture alone, such as a step at a moment
/// or a tone: no correction of other captures could.
void take_out_what_no_file_corrects(const Observations &data, const Model &model,
                                    std::vector<double> &vsin, std::vector<double> &vcos) {
  Model rest = model;
  std::erase_if(rest.effects, [&](const EffectInstance &e) {
    if (e.effect->leaves_behind(e.values, rest.baseline)) // as the correction has it
      return true;
    return !e.effect->info().correctable && e.effect->info().stage != Stage::record &&
           e.effect->info().stage != Stage::motion;
  });
  if (rest.effects.size() == model.effects.size())
    return;
  const ResidualColumns with = residual_columns(data, model), less = residual_columns(data, rest);
  for (std::size_t i = 0; i < data.size(); ++i) {
    vsin[i] -= with.model_sin[i] - less.model_sin[i];
    vcos[i] -= with.model_cos[i] - less.model_cos[i];
  }
}

/// RMS error of the corrected angle on these samples against the magnet's angle: the reference,
/// with what the model knows to be wrong with the reference and the drive.
double angle_error(const Observations &data, const Model &model) {
  const AngleSolver solver(model);
  Conditions at = data.conditions();
  std::vector<double> vsin = as_doubles(data.vsin), vcos = as_doubles(data.vcos);
  take_out_what_no_file_corrects(data, model, vsin, vcos);
  std::vector<double> alpha = data.alpha, radius(data.size()), magnet(data.size());
  ForwardModel(model, AlphaIs::reference).magnet_angle(at, magnet.data());
  solver.start(vsin, vcos, alpha);
  const double period = kTwoPi / model.periods_per_turn;
  for (std::size_t i = 0; i < alpha.size(); ++i)
    alpha[i] += period * std::round((magnet[i] - alpha[i]) / period);
  solver.solve(at, vsin, vcos, alpha, radius);
  double sum = 0.0;
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    const double e = wrap_centred(alpha[i] - magnet[i], period);
    sum += e * e;
  }
  return std::sqrt(sum / static_cast<double>(alpha.size())) * kDegPerRad;
}

/// `sigma` 0: the residual's own.
/// The noise is taken from the data that judge: one number, which they can spare. That of the
/// training data is too small for a model of many terms, and would then condemn the better one.
Quality quality_of(const Observations &data, const Model &model, bool with_angle) {
  Quality q;
  const double n = static_cast<double>(data.size());
  if (n == 0.0)
    return q;
  const double rss = white_sum_of_squares(data, model);
  q.residual_rms_v = std::sqrt(rss / (2.0 * n));
  const double variance = std::max(0.5 * rss / n, criteria::kLeastMeanSquare);
  q.log_likelihood = std::log(data.weight_along) - std::log(kTwoPi * variance) - 1.0;
  if (with_angle)
    q.angle_error_rms_deg = angle_error(data, model);
  return q;
}

} // namespace

double left_v2(const DataSplit &split, const Model &model) {
  return white_sum_of_squares(split.heldout, as_seen_by(split.heldout, model)) /
         (2.0 * static_cast<double>(split.heldout.size()));
}

void DataSplit::weigh(Direction direction, double weight) {
  for (Observations *o : {&train, &heldout}) {
    o->disturbed = direction;
    o->weight_along = weight;
  }
}

SplitQuality DataSplit::quality(const Model &model) const {
  const auto of = [&](const Observations &data, const Model &seen) {
    return own_angle ? quality_of(at_own_angle(data, seen), seen, has_reference)
                     : quality_of(data, seen, has_reference);
  };
  return {of(train, model), of(heldout, second_capture ? as_seen_by(heldout, model) : model)};
}

} // namespace ada

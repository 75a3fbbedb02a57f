// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/search/identifiability.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "diagnosis/criteria.h"
#include "diagnosis/search/admission.h"

namespace ada {

bool is_static(const Effect &effect) {
  const EffectInfo &info = effect.info();
  return info.character == Character::fixed && info.axis != "temperature" &&
         (info.stage == Stage::field || info.stage == Stage::bridge || info.stage == Stage::chain);
}

Sizes sizes_at_rest(const Scene &scene, const Observations &data, const Model &model) {
  Sizes out;
  const auto add = [&](double v, bool affine) {
    out.each.push_back(v);
    out.affine.push_back(affine);
  };
  add(std::hypot(model.baseline.offset_sin_v, model.baseline.offset_cos_v), true);
  const double n = static_cast<double>(data.size());
  for (std::size_t k = 0; k < model.effects.size(); ++k) {
    const EffectInfo &info = model.effects[k].effect->info();
    // Without a reference a ripple of the speed may be a field error, which has higher terms.
    const bool ripple = !scene.has_reference && info.stage == Stage::motion;
    if (info.evidence != Evidence::signal || info.recorded ||
        !(is_static(*model.effects[k].effect) || info.stage == Stage::converter || ripple))
      continue;
    const Model less = model.without(k);
    const double square =
        std::max(0.0, white_sum_of_squares(data, less) - white_sum_of_squares(data, model)) / n;
    add(std::sqrt(square), info.affine);
    // A converter that keeps a part of the channel before keeps a part of what that had kept, or
    // not.
    if (ripple || info.stage == Stage::converter)
      out.own_squares += square;
    // An error of the field is read at the shaft's place, one of the reference at its own: they
    // differ by n a^2 / 2 at twice the order n, a times n of what a is.
    if (const auto order = chosen(model.effects[k], "order", "per turn"); order && !ripple)
      out.own_squares += 2.0 * *order / model.periods_per_turn * square;
  }
  return out;
}

/// Of the last term that is taken and the whole.
double next_of_supply(const Observations &data, const Model &model) {
  const auto recorded = std::find_if(model.effects.begin(), model.effects.end(),
                                     [](const auto &e) { return e.effect->info().recorded; });
  if (data.supply_bend.empty() || recorded == model.effects.end())
    return 0.0;
  Model still = model;
  still.effects.erase(still.effects.begin() + (recorded - model.effects.begin()));
  Observations straight = data;
  straight.supply_bend.clear();
  const ResidualColumns all = residual_columns(data, model);
  const auto rms_from = [&](const ResidualColumns &other) {
    double sum = 0.0;
    for (std::size_t i = 0; i < data.size(); ++i)
      sum += std::pow(all.sin[i] - other.sin[i], 2) + std::pow(all.cos[i] - other.cos[i], 2);
    return std::sqrt(sum / (2.0 * static_cast<double>(data.size())));
  };
  const double whole = rms_from(residual_columns(data, still));
  const double last = rms_from(residual_columns(straight, model));
  return whole > 0.0 ? last * std::sqrt(std::min(1.0, last / whole)) : 0.0;
}

double second_order(const Scene &scene, const Observations &data, const Model &model) {
  const Sizes sizes = sizes_at_rest(scene, data, model);
  double sum = sizes.own_squares;
  for (std::size_t a = 0; a < sizes.each.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      if (!(sizes.affine[a] && sizes.affine[b]))
        sum += sizes.each[a] * sizes.each[b];
  const double amplitude = model.baseline.amplitude_v;
  return std::min(0.35 * sum / amplitude, 6e-4 * amplitude);
}

double offsets_in_transfer(const Observations &data, const Model &m) {
  Model outside = m;
  outside.baseline.offset_sin_v = outside.baseline.offset_cos_v = 0.0;
  const ResidualColumns a = residual_columns(data, m), b = residual_columns(data, outside);
  const double n = static_cast<double>(data.size());
  double variance = 0.0;
  for (const auto column : {&ResidualColumns::sin, &ResidualColumns::cos}) {
    double sum = 0.0, square = 0.0;
    for (std::size_t i = 0; i < data.size(); ++i) {
      const double d = (a.*column)[i] - (b.*column)[i];
      sum += d;
      square += d * d;
    }
    variance += square / n - sum * sum / (n * n);
  }
  return std::sqrt(std::max(0.0, 0.5 * variance));
}

namespace {

/// Whether an effect of the sensor, the motion or the reference is a function of the angle alone:
/// its products with others are not known to second order. A ripple of the shaft that falls with
/// the speed is none.
bool repeats_with_angle(const EffectInstance &e) {
  if (chosen(e, "speed_rpm").value_or(std::nan("")) > 0.0)
    return false;
  return of_the_angle(*e.effect) ||
         (e.effect->info().stage == Stage::record && !shows_beyond_angle(*e.effect));
}

} // namespace

Blur::Blur(const Scene &scene, const Observations &data, const Model &model, std::size_t effect)
    : repeats_(repeats_with_angle(model.effects[effect])), amplitude_v_(model.baseline.amplitude_v),
      offset_v_(std::hypot(model.baseline.offset_sin_v, model.baseline.offset_cos_v)),
      in_transfer_v_(offsets_in_transfer(data, model)),
      others_v_(sizes_at_rest(scene, data, model.without(effect)).sum()) {}

double Blur::left_by(const EffectInstance &rival, double part) const {
  if (!repeats_ || !repeats_with_angle(rival))
    return 0.0;
  // Which of two stages acts first is not known to second order.
  const double second = criteria::kSecondOrder * part / amplitude_v_;
  return std::min(criteria::kMostBlurred * part,
                  std::max({second * (part + offset_v_), in_transfer_v_, second * others_v_}));
}

namespace {

/// The first coordinate of each effect, and how many it has.
std::vector<std::pair<Eigen::Index, Eigen::Index>> places_of(const Model &model) {
  std::vector<std::pair<Eigen::Index, Eigen::Index>> out;
  Eigen::Index at = 4; // behind the baseline's
  for (const EffectInstance &e : model.effects) {
    const auto n = static_cast<Eigen::Index>(e.effect->to_coordinates(e.values).size());
    out.emplace_back(at, n);
    at += n;
  }
  return out;
}

} // namespace

double errors_from_none(const FitResult &fit, std::size_t effect) {
  const auto [first, n] = places_of(fit.model)[effect];
  if (n == 0)
    return 0.0;
  const EffectInstance &e = fit.model.effects[effect];
  const std::vector<double> x = e.effect->to_coordinates(e.values);
  const Eigen::Map<const Eigen::VectorXd> at(x.data(), n);
  const double squares = at.dot(fit.covariance.block(first, first, n, n).ldlt().solve(at));
  return std::sqrt(std::max(0.0, squares) / static_cast<double>(n));
}

double canonical_correlation(const FitResult &fit, std::size_t effect, std::size_t from) {
  const auto place = places_of(fit.model);
  const auto whitener = [&](std::size_t k) -> Eigen::MatrixXd {
    const auto [first, n] = place[k];
    const Eigen::MatrixXd block = fit.covariance.block(first, first, n, n);
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(block).operatorInverseSqrt();
  };
  double most = 0.0;
  const auto [first, n] = place[effect];
  if (n == 0)
    return 0.0;
  const Eigen::MatrixXd mine = whitener(effect);
  for (std::size_t k = from; k < place.size(); ++k) {
    const auto [other, m] = place[k];
    // What comes with the angle alone is the same whatever the speed, the time and the temperature:
    // how far what changes with them lies from it is seen, and counted in nats as everything else.
    const bool on_other_axes = shows_beyond_angle(*fit.model.effects[effect].effect) !=
                               shows_beyond_angle(*fit.model.effects[k].effect);
    if (k == effect || m == 0 || on_other_axes)
      continue;
    const Eigen::MatrixXd cross = mine * fit.covariance.block(first, other, n, m) * whitener(k);
    most = std::max(most, cross.jacobiSvd().singularValues()[0]);
  }
  return most;
}

} // namespace ada

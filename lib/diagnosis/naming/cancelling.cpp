// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/naming/cancelling.h"

#include <Eigen/Dense>
#include <cmath>
#include <utility>
#include <vector>

#include "base/solve.h"
#include "diagnosis/anonymous/beside_anonymous.h"
#include "diagnosis/criteria.h"
#include "diagnosis/naming/nested_models.h"
#include "diagnosis/noise/along_and_across.h"
#include "diagnosis/search/first_model.h"
#include "diagnosis/search/fit.h"
#include "diagnosis/search/identifiability.h"

namespace ada {

namespace {

/// Mean square across the vector of what takes `one` to `other`, V^2.
double turned_v2(const Observations &data, const Model &one, const Model &other) {
  ResidualColumns change = residual_columns(data, one);
  const ResidualColumns less = residual_columns(data, other);
  for (std::size_t i = 0; i < change.sin.size(); ++i) {
    change.sin[i] -= less.sin[i];
    change.cos[i] -= less.cos[i];
  }
  std::vector<double> along, across;
  along_and_across(data, change, along, across);
  return mean_square(across);
}

/// Of the sensor at rest, or an error of the reference that goes with the angle.
bool goes_with_the_angle(const EffectInstance &e) {
  return is_static(*e.effect) || e.effect->reference_ripple(e.values).order > 0.0;
}

/// Whether causes that go with the angle, beside what every pair has, turn the vector by far more
/// each for itself than together, but for what an offset or what every pair has does as well: of
/// the one there may be as much as of the other.
bool cancel_each_other(const Observations &data, const Model &model) {
  const ResidualColumns with = residual_columns(data, model);
  const auto n = static_cast<Eigen::Index>(data.size());
  const auto turned_by = [&](const Model &other) {
    std::vector<double> along, across;
    ResidualColumns change = residual_columns(data, other);
    for (std::size_t i = 0; i < data.size(); ++i) {
      change.sin[i] -= with.sin[i];
      change.cos[i] -= with.cos[i];
    }
    along_and_across(data, change, along, across);
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(across.data(), n));
  };
  std::vector<Eigen::VectorXd> ordinary, of_causes;
  constexpr double kStep = 1e-3; // of the amplitude
  for (int k = 0; k < 3; ++k) {
    Model moved = model;
    (k == 0   ? moved.baseline.offset_sin_v
     : k == 1 ? moved.baseline.offset_cos_v
              : moved.baseline.angle_zero_deg) += kStep * model.baseline.amplitude_v;
    ordinary.push_back(turned_by(moved));
  }
  const Model expected = with_expected(model);
  for (std::size_t k = 0; k < expected.effects.size(); ++k) {
    const EffectInfo &info = expected.effects[k].effect->info();
    if (info.prior_rank == 0) {
      Model moved = expected;
      moved.effects[k].values[0] += info.parameters[0].step;
      ordinary.push_back(turned_by(moved));
    } else if (goes_with_the_angle(expected.effects[k])) {
      of_causes.push_back(turned_by(model.without(k)));
    }
  }
  if (of_causes.size() < 2)
    return false;
  Eigen::MatrixXd columns(n, static_cast<Eigen::Index>(ordinary.size()));
  for (std::size_t k = 0; k < ordinary.size(); ++k)
    columns.col(static_cast<Eigen::Index>(k)) = ordinary[k];
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  Eigen::VectorXd together = Eigen::VectorXd::Zero(n);
  double each2 = 0.0;
  for (Eigen::VectorXd &cause : of_causes) {
    cause -= columns * qr.solve(cause);
    each2 += cause.squaredNorm();
    together += cause;
  }
  return each2 > criteria::kCancels * together.squaredNorm();
}

/// Sum over the causes that act at rest.
double turned_by_each_v2(const Observations &data, const Model &model) {
  double sum = 0.0;
  for (std::size_t k = 0; k < model.effects.size(); ++k)
    if (is_static(*model.effects[k].effect))
      sum += turned_v2(data, model, model.without(k));
  return sum;
}

/// Mean square across the vector, V^2, of what an effect of the model does that no offset,
/// amplitude or zero angle does as well: on a short arc those do most of it.
double turned_beside_baseline_v2(const Observations &data, const Model &model, std::size_t effect) {
  const ResidualColumns with = residual_columns(data, model);
  ResidualColumns shape = residual_columns(data, model.without(effect));
  using Columns = Eigen::Matrix<double, 2, 4>; // of a sample, VSIN and VCOS
  const auto columns = [&](std::size_t i) {
    const double s = with.model_sin[i] - data.centre_sin_v,
                 c = with.model_cos[i] - data.centre_cos_v;
    Columns out;
    out << 1.0, 0.0, s, c, 0.0, 1.0, c, -s;
    return out;
  };
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d onto = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < data.size(); ++i) {
    shape.sin[i] -= with.sin[i];
    shape.cos[i] -= with.cos[i];
    const Columns x = columns(i);
    normal += x.transpose() * x;
    onto += x.transpose() * Eigen::Vector2d(shape.sin[i], shape.cos[i]);
  }
  const Eigen::Vector4d by = solved(normal, onto);
  for (std::size_t i = 0; i < data.size(); ++i) {
    const Eigen::Vector2d baseline = columns(i) * by;
    shape.sin[i] -= baseline[0];
    shape.cos[i] -= baseline[1];
  }
  std::vector<double> along, across;
  along_and_across(data, shape, along, across);
  return mean_square(across);
}

} // namespace

std::optional<Model> name_what_the_direction_tells(const DataSplit &split, SearchResult &found,
                                                   bool bent) {
  if (!split.has_reference || found.disturbed != Direction::none)
    return std::nullopt;
  const Model with = with_expected(found.fit.model);
  const std::size_t before = found.fit.model.effects.size(), named = found.order.size();
  if (with.effects.size() == before)
    return std::nullopt;
  const std::optional<FitResult> apart = fit_by_direction(split, with, bent);
  if (!apart || !apart->determined ||
      !is_clearly_closer(split, apart->model, fit(split.train, with, kRefit).model))
    return std::nullopt;
  FitResult told = *apart;
  attach_errors(told);
  for (std::size_t k = before; k < with.effects.size(); ++k) {
    const EffectInstance &e = told.model.effects[k];
    if (std::pow(e.values[0] / e.std_errors[0], 2) < criteria::kClear)
      continue;
    found.order.push_back(found.fit.model.effects.size());
    found.contribution.push_back(moved_rms_v(split.train, told.model, k));
    found.alternatives.emplace_back();
    found.fit.model.effects.push_back(e);
    ++found.by_direction;
  }
  return found.order.size() > named ? std::optional(told.model) : std::nullopt;
}

void drop_what_cancels(const Scene &scene, const DataSplit &split, SearchResult &found) {
  if (!split.has_reference || found.disturbed != Direction::none)
    return;
  const Model &model = found.fit.model;
  SearchResult fewer = found;
  std::size_t at_rest = 0;
  double of_every_pair_v2 = 0.0, of_others_v2 = 0.0;
  for (std::size_t place = fewer.order.size(); place-- > 0;) {
    const Effect &effect = *fewer.fit.model.effects[fewer.order[place]].effect;
    if (!is_static(effect))
      continue;
    ++at_rest;
    (effect.info().prior_rank == 0 ? of_every_pair_v2 : of_others_v2) +=
        turned_beside_baseline_v2(split.train, model, found.order[place]);
    fewer.forget(place);
  }
  constexpr std::size_t kFewest = 2; // that can cancel
  if (of_others_v2 <= 0.0 || at_rest < kFewest)
    return;
  fewer.fit.model = fit(split.train, fewer.fit.model, kRefit).model;
  std::vector<double> along, across;
  along_and_across(split.train, residual_columns(split.train, fewer.fit.model), along, across);
  const double turned_v2 = mean_square(across);
  // What every pair has was there before any data, and the length of a whole turn tells it by
  // itself: a cause that happens to take it back is no conspiracy yet. On a part of a turn all that
  // is smooth is much of one shape.
  const bool whole = scene.rounds(1.0) >= 1.0;
  if (of_others_v2 + of_every_pair_v2 >
          (whole ? criteria::kCancelsWhatIsThere : criteria::kCancels) * turned_v2 ||
      of_others_v2 > criteria::kCancels * (turned_v2 + of_every_pair_v2))
    found = std::move(fewer);
}

void drop_what_turns_back(const DataSplit &split, SearchResult &found) {
  if (!split.has_reference || found.disturbed != Direction::none)
    return;
  SearchResult fewer = found;
  bool dropped = false;
  for (std::size_t place = fewer.order.size(); place-- > 0;) {
    const EffectInstance &e = fewer.fit.model.effects[fewer.order[place]];
    if (!goes_with_the_angle(e))
      continue;
    dropped = dropped || e.effect->info().prior_rank != 0;
    fewer.forget(place);
  }
  if (!dropped)
    return;
  const Model all = fit(split.train, found.fit.model, kRefit).model;
  const bool leaves = leaves_length(split.train, all);
  const bool cancel = cancel_each_other(split.train, all);
  if (!leaves && !cancel)
    return;
  const std::optional<Model> told = name_what_the_direction_tells(split, fewer, true);
  if (!told || is_clearly_closer(split, all, *told))
    return;
  Model centred = *told;
  centred.baseline.offset_sin_v = all.baseline.offset_sin_v;
  centred.baseline.offset_cos_v = all.baseline.offset_cos_v;
  const double needed_v2 =
      turned_by_each_v2(split.train, *told) + turned_v2(split.train, *told, centred);
  if (cancel || turned_by_each_v2(split.train, all) > criteria::kTurnsBack * needed_v2) {
    fewer.fit.model.baseline = told->baseline;
    found = std::move(fewer);
  }
}

} // namespace ada

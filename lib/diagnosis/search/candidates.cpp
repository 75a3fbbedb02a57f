// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/search/candidates.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/solve.h"
#include "diagnosis/anonymous/discrepancy.h"
#include "diagnosis/criteria.h"
#include "diagnosis/events/wiring.h"
#include "diagnosis/over_samples.h"
#include "diagnosis/search/fit.h"
#include "model/effect_text.h"
#include "model/forward.h"

namespace ada {

namespace {

/// A cause that is needed more often than this, each time at another order or frequency, is the
/// name of something else.
constexpr std::ptrdiff_t kMostOfOne = 3;

/// Of the guesses that a first look does not tell from the best.
constexpr std::ptrdiff_t kMostOthers = 3;

bool same_choice(const EffectInstance &a, const Effect &effect, const std::vector<double> &values) {
  if (a.effect != &effect)
    return false;
  const auto parameters = effect.info().parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (parameters[k].role == Role::chosen && a.values[k] != values[k])
      return false;
  return true;
}

/// One way in which an effect could enter, and the columns of the linear problem that stand for it.
struct Variant {
  const Effect *effect;
  std::vector<double> values;
  bool linear; ///< one column a coordinate; else one column for the whole change
  std::vector<Model> models;
  std::vector<double> steps;
};

Variant make_variant(const Model &model, const Effect &effect, std::vector<double> values) {
  Variant v{&effect, std::move(values), true, {}, {}};
  std::vector<double> x = effect.to_coordinates(v.values);
  for (double c : x)
    v.linear = v.linear && c == 0.0;
  Model extended = model;
  extended.effects.push_back({&effect, v.values, {}});
  if (!v.linear) {
    v.models.push_back(std::move(extended));
    v.steps.push_back(1.0);
    return v;
  }
  v.steps = effect.steps(v.values);
  for (std::size_t k = 0; k < x.size(); ++k) {
    x[k] = v.steps[k];
    extended.effects.back().values = effect.from_coordinates(v.values, x);
    x[k] = 0.0;
    v.models.push_back(extended);
  }
  return v;
}

/// Both channels late to the reference, or the reference late to both: no capture tells which, so a
/// model has one of the two. With both, each other's opposite, it has a second derivative of the
/// motion that no cause is.
bool is_lag(const EffectInfo &e) {
  return e.evidence == Evidence::signal && e.pattern == Pattern::turn &&
         e.character == Character::dynamic;
}

/// Whether numbers of an effect have all that others have: each end that clips, say.
bool gives_all(Values known, Values of) {
  for (std::size_t k = 0; k < of.size(); ++k)
    if (std::isfinite(of[k]) && !std::isfinite(known[k]))
      return false;
  return true;
}

std::vector<Variant> variants(const Scene &scene, const Residual &residual, const Model &model,
                              bool signatures) {
  std::vector<Variant> out;
  for (const Effect *effect : catalogue()) {
    if (effect->info().evidence != Evidence::signal || (effect->info().signature && !signatures) ||
        (scene.radius_only && needs_motion(*effect)))
      continue;
    const auto present = std::count_if(model.effects.begin(), model.effects.end(),
                                       [&](const EffectInstance &e) { return e.effect == effect; });
    if (present >= (effect->info().repeats ? kMostOfOne : 1))
      continue;
    if (effect->info().stage == Stage::record && !scene.has_reference)
      continue;
    if (is_lag(effect->info()) && std::ranges::any_of(model.effects, [](const EffectInstance &e) {
          return is_lag(e.effect->info());
        }))
      continue;
    for (auto &values : effect->guesses(residual)) {
      if (std::any_of(model.effects.begin(), model.effects.end(),
                      [&](const EffectInstance &e) { return same_choice(e, *effect, values); }) &&
          present > 0 && effect->info().parameters[0].role == Role::chosen)
        continue;
      // What the readings themselves have shown at this place is known, and its rows are left out.
      if (std::ranges::any_of(scene.screened, [&](const ScreenFinding &f) {
            return repeats({f.effect, f.values, {}}, {effect, values, {}}) &&
                   gives_all(f.values, values);
          }))
        continue;
      out.push_back(make_variant(model, *effect, std::move(values)));
    }
  }
  return out;
}

} // namespace

bool needs_motion(const Effect &effect) {
  const EffectInfo &info = effect.info();
  return info.stage == Stage::motion || info.pattern == Pattern::turn;
}

Residual residual_view(const Scene &scene, const Observations &data, const ResidualColumns &columns,
                       double noise_v, double amplitude_v) {
  Residual r;
  r.has_reference = scene.has_reference;
  r.has_supply = !data.supply.empty();
  r.both_directions = scene.both_directions;
  r.several_speeds = scene.several_speeds;
  r.own_motion = scene.radius_only;
  r.why_no_temperature = scene.why_no_temperature;
  r.fastest_omega = scene.fastest_omega;
  r.periods = scene.periods;
  r.turns = scene.turns;
  r.amplitude_v = amplitude_v;
  r.noise_v = noise_v;
  r.supply_v = scene.supply_v;
  r.centre_sin_v = data.centre_sin_v;
  r.centre_cos_v = data.centre_cos_v;
  r.sense = data.direction;
  r.sample_period_s = data.frame_period_s;
  r.stretch_s = scene.stretch_s;
  r.time = data.time;
  r.omega = data.omega;
  r.alpha = data.alpha;
  r.sin_v = columns.sin;
  r.cos_v = columns.cos;
  r.model_sin_v = columns.model_sin;
  r.model_cos_v = columns.model_cos;
  r.read_sin_v = data.vsin;
  r.read_cos_v = data.vcos;
  return r;
}

bool can_show(const Scene &scene, const Model &model, const Effect &effect) {
  const ResidualColumns none;
  return effect
      .invisible(
          residual_view(scene, scene.all, none, scene.white_noise_v, model.baseline.amplitude_v))
      .empty();
}

std::vector<Candidate> candidates(const Scene &scene, const Observations &data, const Model &model,
                                  bool signatures) {
  const ResidualColumns columns = residual_columns(data, model);
  ResidualColumns white = columns; // what a search for lines and steps may trust
  for (std::size_t i = 0; i < data.size(); ++i)
    data.whiten(i, columns.model_sin[i], columns.model_cos[i], white.sin[i], white.cos[i]);
  const Residual residual =
      residual_view(scene, data, white, scene.white_noise_v, model.baseline.amplitude_v);
  const BeforeWires before(model, residual);
  const std::vector<Variant> all = variants(scene, before.view(), model, signatures);

  // Columns: the model's own coordinates, every variant's, and the residual last.
  const std::vector<double> x0 = coordinates_of(model), h0 = coordinate_steps(model);
  ForwardFamily forward(model, AlphaIs::reference);
  std::vector<double> step;
  std::vector<double> moved = x0, leak; // of VCOS into VTEMP, per unit of each
  const double leak_now = vtemp_on_vcos(model);
  const auto add = [&](const Model &m, double h) {
    forward.add(m);
    step.push_back(h);
    leak.push_back((vtemp_on_vcos(m) - leak_now) / h);
  };
  for (std::size_t k = 0; k < x0.size(); ++k) {
    moved[k] += h0[k];
    add(with_coordinates(model, moved), h0[k]);
    moved[k] = x0[k];
  }
  for (const Variant &v : all)
    for (std::size_t k = 0; k < v.models.size(); ++k)
      add(v.models[k], v.steps[k]);
  const auto total = static_cast<Eigen::Index>(step.size());
  const Conditions conditions = data.conditions();
  const Coloured *coloured = data.coloured.get();
  const auto add_block = [&](Crosses &sums, std::size_t first, std::size_t n) {
    std::array<Observations::Whitener, kWaveBlock> whiten;
    Eigen::MatrixXd rows(total + 1, static_cast<Eigen::Index>(2 * n));
    for (std::size_t i = 0; i < n; ++i)
      whiten[i] =
          data.whitener_at(first + i, columns.model_sin[first + i], columns.model_cos[first + i]);
    const auto take = [&](std::size_t k, const double *sin, const double *cos) {
      const Eigen::Index row = k == 0 ? total : static_cast<Eigen::Index>(k - 1);
      const double inverse = k == 0 ? 1.0 : 1.0 / step[k - 1];
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t at = first + i;
        double ds = k == 0 ? columns.sin[at] : (sin[i] - columns.model_sin[at]) * inverse;
        double dc = k == 0 ? columns.cos[at] : (cos[i] - columns.model_cos[at]) * inverse;
        whiten[i](ds, dc);
        rows(row, static_cast<Eigen::Index>(2 * i)) = ds;
        rows(row, static_cast<Eigen::Index>(2 * i + 1)) = dc;
      }
    };
    forward.evaluate(conditions.slice(first, n), take);
    sums.add(rows, first, coloured);
  };
  Crosses sums = sum_over(data.size(), Crosses(total + 1, coloured), add_block);
  Eigen::MatrixXd &gram = sums.products;
  if (coloured)
    gram.triangularView<Eigen::Lower>() = gram - coloured->taken(sums.projected);
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  if (data.vtemp_on_vcos_error > 0.0) {
    // What VTEMP carries over tells effects apart that the pair cannot.
    leak.push_back(data.vtemp_on_vcos - leak_now);
    const double variance = gram(total, total) / (2.0 * static_cast<double>(data.size()));
    const Eigen::Map<const Eigen::VectorXd> row(leak.data(), total + 1);
    gram += row * row.transpose() * (variance / std::pow(data.vtemp_on_vcos_error, 2));
  }

  // Take the model's own columns out of all others.
  const Eigen::VectorXd scale = gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd unit = scale.asDiagonal() * gram * scale.asDiagonal();
  const auto own = static_cast<Eigen::Index>(x0.size());
  const Eigen::MatrixXd own_part = solved(unit.topLeftCorner(own, own), unit.topRows(own));
  const Eigen::MatrixXd rest = unit - unit.leftCols(own) * own_part;

  std::vector<Candidate> out;
  Eigen::Index at = own;
  for (const Variant &v : all) {
    const auto m = static_cast<Eigen::Index>(v.models.size());
    const Eigen::MatrixXd inner = rest.block(at, at, m, m);
    const Eigen::VectorXd right = rest.block(at, total, m, 1);
    const Eigen::Index here = at;
    at += m;
    // A column that the model already holds says nothing new.
    if (inner.diagonal().minCoeff() < 1e-9)
      continue;
    const Eigen::VectorXd y = solved(inner, right);
    const double gain = y.dot(right) * gram(total, total);
    if (!std::isfinite(gain) || gain <= 0.0)
      continue;
    const Eigen::VectorXd own_move = own_part.col(total) - own_part.middleCols(here, m) * y;
    std::vector<double> x = x0;
    const double size = 1.0 / scale[total];
    for (Eigen::Index k = 0; k < own; ++k)
      x[static_cast<std::size_t>(k)] += own_move[k] * scale[k] * size;
    std::vector<double> added = v.effect->to_coordinates(v.values);
    if (v.linear)
      for (Eigen::Index k = 0; k < m; ++k)
        added[static_cast<std::size_t>(k)] = y[k] * scale[here + k] * size;
    if (!v.linear && y[0] < 0.0)
      continue;
    const bool visible =
        v.effect->invisible(before.view()).empty() && v.effect->shows(v.values, before.view());
    Candidate candidate{v.effect, model, gain, added.size(), visible, {}};
    candidate.start.effects.push_back({v.effect, v.values, {}});
    x.insert(x.end(), added.begin(), added.end());
    candidate.start = with_coordinates(candidate.start, x);
    const auto better = std::find_if(out.begin(), out.end(),
                                     [&](const Candidate &o) { return o.effect == v.effect; });
    if (better == out.end()) {
      out.push_back(std::move(candidate));
      continue;
    }
    if (gain > better->gain) {
      std::swap(candidate.others, better->others);
      std::swap(candidate, *better);
    }
    better->others.emplace_back(candidate.gain, std::move(candidate.start));
  }
  for (Candidate &c : out) {
    std::erase_if(c.others,
                  [&](const auto &o) { return o.first < criteria::kComparable * c.gain; });
    std::stable_sort(c.others.begin(), c.others.end(),
                     [](const auto &a, const auto &b) { return a.first > b.first; });
    if (std::ssize(c.others) > kMostOthers)
      c.others.erase(c.others.begin() + kMostOthers, c.others.end());
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Candidate &a, const Candidate &b) { return a.gain > b.gain; });
  return out;
}

} // namespace ada

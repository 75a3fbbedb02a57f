// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/naming/comb.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "diagnosis/anonymous/beside_anonymous.h"
#include "diagnosis/criteria.h"
#include "diagnosis/naming/taken_back.h"
#include "diagnosis/search/admission.h"
#include "diagnosis/search/fit.h"
#include "model/effect_text.h"

namespace ada {

namespace {

/// Mean squares, V^2 of a channel, by order of the structure which repeats with the angle, or by
/// line of the spectrum, and has no name.
std::map<int, double> orders_v2(const Anonymous &left, Axis axis) {
  std::map<int, double> out;
  for (std::size_t k = 0; k < left.selection.columns.size(); ++k) {
    const Eigen::Index column = left.selection.columns[k];
    const Group &group = left.basis.groups()[static_cast<std::size_t>(column / 2)];
    if (group.axis == axis && group.order != kOfBaseline)
      out[group.order] += std::pow(left.selection.values[static_cast<Eigen::Index>(k)], 2) *
                          left.from.train(column, column) / left.from.n_train;
  }
  return out;
}

/// What one of them has, weighted by itself: of those that carry the structure, not of those that
/// happen to be in.
double comb_v2(const Anonymous &left, Axis axis) {
  double sum = 0.0, squares = 0.0;
  for (const auto &[order, v2] : orders_v2(left, axis)) {
    sum += v2;
    squares += v2 * v2;
  }
  return sum > 0.0 ? squares / sum : 0.0;
}

/// What the largest of them has.
double largest_v2(const Anonymous &left, Axis axis) {
  double out = 0.0;
  for (const auto &[order, v2] : orders_v2(left, axis))
    out = std::max(out, v2);
  return out;
}

/// Whether a cause is one order of the turn, or one line of the spectrum.
bool is_one_of(const EffectInstance &e, Axis axis) {
  if (axis == Axis::angle)
    return chosen(e, "order").has_value();
  const auto line = e.effect->one_line(e.values);
  return line && line->per == OneLine::Per::second;
}

/// Causes of the first model that turn the field's direction with the angle and were not found.
std::vector<EffectInstance> missing_directions(const Model &first, const Model &found) {
  std::vector<EffectInstance> out;
  for (const EffectInstance &e : first.effects) {
    const EffectInfo &info = e.effect->info();
    if (info.stage == Stage::field && info.axis == axis_name(Axis::angle) &&
        info.evidence == Evidence::signal && !info.remembers &&
        std::ranges::none_of(found.effects, [&](const EffectInstance &f) { return repeats(e, f); }))
      out.push_back(e);
  }
  return out;
}

} // namespace

/// One order or line of many is no cause of its own: it must stand out of what has no name.
void drop_what_is_of_a_comb(const Scene &scene, const DataSplit &all, SearchResult &found,
                            Axis axis) {
  const auto &effects = found.fit.model.effects;
  if (std::none_of(found.order.begin(), found.order.end(),
                   [&](std::size_t at) { return is_one_of(effects[at], axis); }))
    return;
  DataSplit split = all;
  split.train = thinned(split.train);
  split.train.coloured.reset();
  for (;;) {
    const Model &model = found.fit.model;
    std::size_t least_place = found.order.size();
    double least = 0.0;
    for (std::size_t place = 0; place < found.order.size(); ++place) {
      const std::size_t at = found.order[place];
      if (!is_one_of(model.effects[at], axis))
        continue;
      const double v2 = std::pow(moved_rms_v(split.heldout, model, at), 2);
      if (least_place == found.order.size() || v2 < least) {
        least = v2;
        least_place = place;
      }
    }
    if (least_place == found.order.size() ||
        least > criteria::kAboveComb * comb_v2(anonymous_of(scene, split, model), axis))
      return;
    found.forget(least_place);
    found.fit.model = fit(split.train, found.fit.model, kRefit).model;
  }
}

bool take_back_orders_that_stand_out(const Scene &scene, DataSplit split, const Model &first,
                                     SearchResult &found, std::vector<const Effect *> &unasked) {
  if (!split.has_reference)
    return false;
  const std::vector<EffectInstance> missing = missing_directions(first, found.fit.model);
  if (missing.empty())
    return false;
  split.train = thinned(split.train);
  split.train.coloured.reset();
  const Model less = fit(split.train, found.fit.model, kRefit).model;
  Model with = less;
  with.effects.insert(with.effects.end(), missing.begin(), missing.end());
  while (with.effects.size() > less.effects.size()) {
    FitResult fitted = fit(split.train, with, kRefit);
    std::size_t least = less.effects.size();
    std::vector<double> v2(with.effects.size());
    for (std::size_t k = less.effects.size(); k < with.effects.size(); ++k) {
      v2[k] = std::pow(moved_rms_v(split.heldout, fitted.model, k), 2);
      if (v2[k] < v2[least])
        least = k;
    }
    if (fitted.determined &&
        v2[least] > criteria::kAboveNext *
                        largest_v2(anonymous_of(scene, split, fitted.model), Axis::angle)) {
      take_back(split, less, std::move(fitted), found, unasked);
      return true;
    }
    with = fitted.model.without(least);
  }
  return false;
}

} // namespace ada

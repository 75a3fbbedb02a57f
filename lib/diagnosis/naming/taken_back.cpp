// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/naming/taken_back.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/anonymous/beside_anonymous.h"
#include "diagnosis/criteria.h"
#include "diagnosis/events/change_points.h"
#include "diagnosis/search/admission.h"
#include "diagnosis/search/candidates.h"
#include "diagnosis/search/fit.h"

namespace ada {

namespace {

/// What a cause says of itself that it looks like, and held-out data beside what has no name do not
/// reject in its place.
std::vector<Rival> rivals_of(const Scene &scene, const DataSplit &split, const Model &model,
                             std::size_t effect) {
  std::vector<Rival> out;
  const double nats = nats_beside_anonymous(scene, split, model);
  // What has an order to choose begins where it takes most.
  const Model less = fit(split.train, model.without(effect), kRefit).model;
  const std::vector<Candidate> list = candidates(scene, split.train, less, true);
  const auto start_of = [&](const Effect &other) {
    const auto there = std::ranges::find(list, &other, &Candidate::effect);
    return there == list.end() ? absent(other) : there->start.effects.back();
  };
  for (const Separation &from : model.effects[effect].effect->info().separations) {
    const Effect *other = find_effect(from.rival);
    if (!other || holds(model, other) || other->info().evidence != Evidence::signal ||
        has_moment(*other) || !can_show(scene, model, *other))
      continue;
    Model rival = model;
    rival.effects[effect] = start_of(*other);
    const FitResult fitted = fit(split.train, rival, kRefit);
    if (fitted.determined && in_range(fitted.model.effects[effect]) &&
        nats_beside_anonymous(scene, split, fitted.model) > nats - criteria::kRivalNats)
      out.push_back({std::string(other->info().id), fitted.model});
  }
  return out;
}

/// Those of the first model that were not found in the end.
std::vector<EffectInstance> missing_of(const Model &first, const Model &found) {
  std::vector<EffectInstance> out;
  for (const EffectInstance &e : first.effects)
    if (!holds(found, e.effect))
      out.push_back(e);
  return out;
}

/// Places of what was found that the first model had not: what every pair has aside.
std::vector<std::size_t> stand_ins(const Model &first, const SearchResult &found) {
  std::vector<std::size_t> out;
  for (std::size_t place = 0; place < found.order.size(); ++place) {
    const Effect *effect = found.fit.model.effects[found.order[place]].effect;
    if (effect->info().prior_rank != 0 && !holds(first, effect))
      out.push_back(place);
  }
  return out;
}

/// Whether a cause of a fitted model is needed beside the others: without it held-out data are less
/// likely.
bool is_needed(const DataSplit &split, const Model &with, std::size_t effect) {
  const double n = static_cast<double>(split.heldout.size());
  const Model less = fit(split.train, with.without(effect), kRefit).model;
  return n * std::log(left_v2(split, less) /
                      std::max(left_v2(split, with), criteria::kLeastMeanSquare)) >=
         criteria::kLeastNats;
}

/// The same of each from one place on.
bool each_is_needed(const DataSplit &split, const Model &with, std::size_t from) {
  for (std::size_t k = from; k < with.effects.size(); ++k)
    if (!is_needed(split, with, k))
      return false;
  return true;
}

/// Beside what was taken back, what had come in its place is needed no more.
void drop_what_stood_in(const DataSplit &split, const Model &first, SearchResult &found) {
  std::vector<std::size_t> places = stand_ins(first, found);
  for (auto place = places.rbegin(); place != places.rend(); ++place) {
    if (is_needed(split, found.fit.model, found.order[*place]))
      continue;
    found.forget(*place);
    found.fit.model = fit(split.train, found.fit.model, kRefit).model;
  }
}

/// Of two causes that do as well beside what has no name, of which the one leaves the other's rest
/// to that, the one that needs less of it: what a low pass takes of the length has no name beside a
/// delay.
bool exchange_what_stands_in(const Scene &scene, const DataSplit &split, const Model &first,
                             SearchResult &found, std::vector<const Effect *> &unasked) {
  const std::vector<EffectInstance> missing = missing_of(first, found.fit.model);
  const std::vector<std::size_t> places = stand_ins(first, found);
  if (missing.empty() || places.empty())
    return false;
  bool any = false;
  const double n = static_cast<double>(split.heldout.size());
  Model now = fit(split.train, found.fit.model, kRefit).model;
  double left = left_v2(split, now), nats = nats_beside_anonymous(scene, split, now);
  for (const EffectInstance &instead : missing) {
    Model both = now;
    both.effects.push_back(instead);
    both = fit(split.train, both, kRefit).model;
    for (std::size_t place : places) {
      const std::size_t at = found.order[place];
      if (holds(now, instead.effect) || holds(first, now.effects[at].effect) ||
          is_needed(split, both, at)) // beside the other: it stands in for nothing
        continue;
      Model other = now;
      other.effects[at] = instead;
      FitResult with = fit(split.train, other, kRefit);
      const double left_with = left_v2(split, with.model);
      if (!with.determined || !in_range(with.model.effects[at]) ||
          n * std::log(left / std::max(left_with, criteria::kLeastMeanSquare)) <
              criteria::kRivalNats)
        continue;
      const double nats_with = nats_beside_anonymous(scene, split, with.model);
      if (nats_with < nats - criteria::kRivalNats)
        continue;
      now = std::move(with.model);
      left = left_with;
      nats = nats_with;
      found.fit.model = now;
      found.alternatives[place].clear(); // those were of the other
      unasked.push_back(now.effects[at].effect);
      const Model less = fit(split.train, now.without(at), kRefit).model;
      found.contribution[place] = std::sqrt(std::max(0.0, left_v2(split, less) - left));
      any = true;
    }
  }
  return any;
}

} // namespace

void take_back(const DataSplit &split, const Model &less, FitResult fitted, SearchResult &found,
               std::vector<const Effect *> &unasked) {
  const double without_v2 = left_v2(split, less), with_v2 = left_v2(split, fitted.model);
  for (std::size_t k = less.effects.size(); k < fitted.model.effects.size(); ++k) {
    found.order.push_back(k);
    found.contribution.push_back(std::sqrt(std::max(0.0, without_v2 - with_v2)));
    found.alternatives.emplace_back();
    unasked.push_back(fitted.model.effects[k].effect);
  }
  found.fit.model = std::move(fitted.model);
}

bool take_back_what_explains_most(const Scene &scene, DataSplit split, const Model &first,
                                  SearchResult &found, std::vector<const Effect *> &unasked) {
  bool any = false;
  split.train = thinned(split.train);
  split.train.coloured.reset();
  const auto try_back = [&](const std::vector<EffectInstance> &causes) {
    const Model less = fit(split.train, found.fit.model, kRefit).model;
    Model with = less;
    with.effects.insert(with.effects.end(), causes.begin(), causes.end());
    FitResult fitted = fit(split.train, with, kRefit);
    if (!fitted.determined ||
        !takes_most(split, fitted.model, less, *causes.front().effect,
                    anonymous_of(scene, split, less)) ||
        (causes.size() > 1 && !each_is_needed(split, fitted.model, less.effects.size())))
      return;
    take_back(split, less, std::move(fitted), found, unasked);
    any = true;
  };
  any = exchange_what_stands_in(scene, split, first, found, unasked);
  for (const EffectInstance &e : missing_of(first, found.fit.model))
    try_back({e});
  if (const auto missing = missing_of(first, found.fit.model); missing.size() == 2)
    try_back(missing);
  if (any)
    drop_what_stood_in(split, first, found);
  return any;
}

void ask_for_rivals(const Scene &scene, const Scene &judge, DataSplit split, SearchResult &found,
                    const std::vector<const Effect *> &unasked) {
  if (unasked.empty())
    return;
  split.train = thinned(split.train);
  split.train.coloured.reset();
  const SearchData aside{&scene, split.train, split.heldout, &judge};
  Model model = fit(split.train, found.fit.model, kRefit).model;
  for (std::size_t place = 0; place < found.order.size(); ++place) {
    const std::size_t at = found.order[place];
    if (!found.alternatives[place].empty() ||
        std::find(unasked.begin(), unasked.end(), model.effects[at].effect) == unasked.end())
      continue;
    std::vector<Rival> rivals = rivals_of(scene, split, model, at);
    const auto better = std::ranges::max_element(
        rivals, {}, [&](const Rival &r) { return side_evidence(aside, r.model); });
    if (better != rivals.end() &&
        side_evidence(aside, better->model) > side_evidence(aside, model) + criteria::kRivalNats) {
      found.fit.model = model = better->model;
      rivals = rivals_of(scene, split, model, at);
    }
    const double side = side_evidence(aside, model);
    std::erase_if(rivals, [&](const Rival &r) {
      return side_evidence(aside, r.model) < side - criteria::kRivalNats;
    });
    found.alternatives[place] = std::move(rivals);
  }
}

} // namespace ada

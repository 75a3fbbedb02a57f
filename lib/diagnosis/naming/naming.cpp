// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/naming/naming.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "diagnosis/anonymous/beside_anonymous.h"
#include "diagnosis/criteria.h"
#include "diagnosis/events/change_points.h"
#include "diagnosis/events/step_shape.h"
#include "diagnosis/naming/by_chance.h"
#include "diagnosis/naming/cancelling.h"
#include "diagnosis/naming/comb.h"
#include "diagnosis/naming/nested_models.h"
#include "diagnosis/naming/own_law.h"
#include "diagnosis/naming/taken_back.h"
#include "diagnosis/search/admission.h"
#include "diagnosis/search/candidates.h"
#include "diagnosis/search/first_model.h"
#include "diagnosis/search/fit.h"
#include "diagnosis/search/identifiability.h"
#include "diagnosis/search/step_causes.h"

namespace ada {

namespace {

std::vector<std::string_view> names_of(const SearchResult &found) {
  std::vector<std::string_view> out;
  for (std::size_t k : found.order)
    out.push_back(found.fit.model.effects[k].effect->info().id);
  std::sort(out.begin(), out.end());
  return out;
}

/// Of causes that stand equally well beside what has no name, the one leads that leaves less of it:
/// less of the residual above the noise. The model with it; nothing where none leaves so little.
std::optional<Model> with_better_rival(const Scene &scene, const DataSplit &split,
                                       const SearchResult &found, double noise_v2) {
  const auto unnamed_v2 = [&](const Model &model) {
    return white_sum_of_squares(split.heldout, as_seen_by(split.heldout, model)) /
               (2.0 * static_cast<double>(split.heldout.size())) -
           noise_v2;
  };
  double least = criteria::kOfRival * unnamed_v2(found.fit.model);
  const Model *better = nullptr;
  for (const std::vector<Rival> &rivals : found.alternatives)
    for (const Rival &rival : rivals)
      if (const double left = unnamed_v2(rival.model);
          left < least && can_show(scene, rival.model, *find_effect(rival.id))) {
        least = left;
        better = &rival.model;
      }
  return better ? std::optional(*better) : std::nullopt;
}

/// What has no name, as the covariance of the training part: of which no more is to be named.
void colour(const Scene &scene, DataSplit &split, const Model &model) {
  split.train = thinned(split.train);
  split.train.coloured.reset();
  // By itself: beside another discrepancy the model may stand where that made up for it.
  const Anonymous left = anonymous_of(scene, split, fit(split.train, model, kRefit).model);
  if (left.any())
    split.train.coloured = std::make_shared<Coloured>(
        discrepancy_of(left.basis, left.selection, left.from, Stands::for_good), split.train);
}

/// A cause is no finding where held-out data are likelier without it, with what has no name then
/// chosen anew: it stood for something that the anonymous model holds better.
void drop_what_has_no_name(const Scene &scene, DataSplit split, SearchResult &found) {
  split.train = thinned(split.train);
  split.train.coloured.reset();
  for (;;) {
    // Both fitted alike: beside a discrepancy what follows it is not determined, and may be
    // anything.
    const Model model = fit(split.train, found.fit.model, kRefit).model;
    const double with = nats_beside_anonymous(scene, split, model);
    std::size_t worst = found.order.size();
    double most = criteria::kRivalNats;
    for (std::size_t place = 0; place < found.order.size(); ++place) {
      if (model.effects[found.order[place]].effect->info().prior_rank == 0)
        continue;
      Model less = fit(split.train, model.without(found.order[place]), kRefit).model;
      const Anonymous unnamed = anonymous_of(scene, split, less);
      if (takes_most(split, model, less, *model.effects[found.order[place]].effect, unnamed))
        continue;
      double more = nats_beside(unnamed) - with;
      // What went into the choice because the cause was not there, the images of a tone or the rest
      // of a lag that is no plain one, is offered beside the cause as well.
      if (more > most)
        more = std::min(more, nats_beside(unnamed) -
                                  nats_beside(anonymous_alike(scene, split, model, unnamed)));
      if (more > most) {
        most = more;
        worst = place;
      }
    }
    if (worst == found.order.size())
      return;
    found.forget(worst);
    found.fit.model = fit(split.train, found.fit.model, kRefit).model;
  }
}

/// Whether a cause that every pair has is not there without a signature: less than half as large.
bool brings_forth(const Model &with, const Model &without) {
  for (const EffectInstance &e : with.effects) {
    if (e.effect->info().prior_rank != 0)
      continue;
    for (const EffectInstance &f : without.effects)
      if (f.effect == e.effect) {
        const double had = std::abs(e.values.front()),
                     has = std::abs(f.values.front()); // they have one number
        if (has < criteria::kLeastOfGroup * had)
          return true;
      }
  }
  return false;
}

/// What turns the field, or the reference, with the order that a harmonic of one channel has along
/// the circle, as far as the capture can show it: order n of psi is n - 1 from the pair's own.
std::vector<EffectInstance> direction_errors_like(const Scene &scene, const Model &model,
                                                  const EffectInstance &harmonic) {
  const int periods = model.periods_per_turn;
  std::vector<EffectInstance> out;
  const auto order = chosen(harmonic, "order");
  if (!order || !chosen(harmonic, "channel"))
    return out;
  for (const Effect *effect : catalogue()) {
    const EffectInfo &info = effect->info();
    if ((info.stage != Stage::field && info.stage != Stage::record) ||
        info.evidence != Evidence::signal || info.remembers || !can_show(scene, model, *effect))
      continue;
    out.push_back({effect, {}, {}});
    for (const ParameterInfo &p : info.parameters)
      out.back().values.push_back(p.role == Role::chosen ? (*order - 1.0) * periods : 0.0);
  }
  return out;
}

/// A signature names a shape and no physics. Where mismatch or quadrature error are only there
/// beside it, as its counterpart, what they share has no name, or is an error of the field's
/// direction that all of them together stood for.
void drop_signatures_that_bring_forth(const Scene &scene, const Scene &judge, DataSplit split,
                                      SearchResult &found) {
  split.train = thinned(split.train);
  split.train.coloured.reset();
  const SearchData aside{&scene, split.train, split.heldout, &judge};
  for (std::size_t place = found.order.size(); place-- > 0;) {
    const Model &model = found.fit.model;
    const std::size_t at = found.order[place];
    const EffectInstance &signature = model.effects[at];
    if (!signature.effect->info().signature)
      continue;
    Model less = fit(split.train, model.without(at), kRefit).model;
    if (brings_forth(model, less)) {
      found.forget(place);
      found.fit.model = std::move(less);
      place = found.order.size();
      continue;
    }
    const auto worth = [&](const Model &m) {
      return nats_beside_anonymous(scene, split, m) + side_evidence(aside, m);
    };
    double least = worth(model) - criteria::kRivalNats;
    std::optional<Model> better;
    for (const EffectInstance &instead : direction_errors_like(scene, model, signature)) {
      Model other = model;
      other.effects[at] = instead;
      other = fit(split.train, other, kRefit).model;
      const double nats = worth(other);
      if (nats > least && brings_forth(model, other)) {
        least = nats + criteria::kRivalNats; // of two that do as well, what comes first physically
        better = std::move(other);
      }
    }
    if (better) {
      found.fit.model = *std::move(better);
      found.alternatives[place].clear(); // they were of the signature
    }
  }
}

/// Of causes that look alike where both could be, the one that every pair has is named, unless
/// held-out data beside what has no name are likelier with the other, and by more than what the
/// products of all causes may leave over. Beside that one the other need be there as well.
void prefer_what_every_pair_has(const Scene &scene, const Scene &judge, DataSplit split,
                                SearchResult &found) {
  split.train = thinned(split.train);
  split.train.coloured.reset();
  const SearchData aside{&scene, split.train, split.heldout, &judge};
  const auto instead_of = [&](std::size_t at, const Effect &common) {
    Model other = found.fit.model;
    if (holds(other, &common))
      return fit(split.train, other.without(at), kRefit).model;
    other.effects[at] = absent(common);
    return fit(split.train, other, kRefit).model;
  };
  // Nothing where it is not to be exchanged; otherwise whether nothing tells them apart.
  const auto alike = [&](const Model &model, const Model &other,
                         std::size_t at) -> std::optional<bool> {
    const Effect &effect = *model.effects[at].effect;
    const double aside_of_model = side_evidence(aside, model),
                 aside_of_other = side_evidence(aside, other);
    const double more_v = std::sqrt(std::max(0.0, left_v2(split, other) - left_v2(split, model)));
    if (!shows_beyond_angle(effect) && aside_of_other > aside_of_model - criteria::kRivalNats &&
        more_v < second_order(scene, split.train, model))
      return true;
    const double more = nats_beside_anonymous(scene, split, model) + aside_of_model -
                        nats_beside_anonymous(scene, split, other) - aside_of_other;
    if (other.effects.size() < model.effects.size() || more > criteria::kRivalNats ||
        takes_most(split, model, other, effect, anonymous_of(scene, split, other)))
      return std::nullopt;
    return more > -criteria::kRivalNats;
  };
  for (std::size_t place = 0; place < found.order.size(); ++place) {
    const std::size_t at = found.order[place];
    const EffectInfo &info = found.fit.model.effects[at].effect->info();
    if (info.prior_rank == 0)
      continue;
    for (const Separation &from : info.separations) {
      const Effect *common = find_effect(from.rival);
      if (!common || common->info().prior_rank != 0)
        continue;
      Model other = instead_of(at, *common);
      const Model model = fit(split.train, found.fit.model, kRefit).model;
      const std::optional<bool> untold = alike(model, other, at);
      if (!untold)
        continue;
      const Model before = std::exchange(found.fit.model, other);
      std::size_t named = place;
      if (other.effects.size() < before.effects.size()) {
        found.fit.model = before;
        found.forget(place);
        found.fit.model = std::move(other);
        named = static_cast<std::size_t>(std::find_if(found.order.begin(), found.order.end(),
                                                      [&](std::size_t k) {
                                                        return found.fit.model.effects[k].effect ==
                                                               common;
                                                      }) -
                                         found.order.begin());
        --place; // the next one has moved up
      }
      if (named < found.order.size()) // it was a rival of the one before
        std::erase_if(found.alternatives[named],
                      [&](const Rival &r) { return r.id == common->info().id; });
      if (*untold && named < found.order.size())
        found.alternatives[named].push_back({std::string(info.id), before});
      break;
    }
  }
}

} // namespace

Unnamed unnamed_beside(const Scene &scene, const DataSplit &split, const Model &model,
                       const Anonymous &left, double noise_v) {
  Model physical = model;
  const auto dropped = std::erase_if(
      physical.effects, [](const EffectInstance &e) { return e.effect->info().signature; });
  constexpr auto kAngle = static_cast<std::size_t>(Axis::angle);
  Unnamed out;
  out.angle_v2 =
      (dropped > 0 ? anonymous_of(scene, split, physical) : left).selection.share_v2[kAngle];
  const double noise = std::max(noise_v, scene.white_noise_v);
  out.elsewhere_v2 = std::max(0.0, left.selection.noise_v2 - noise * noise);
  for (std::size_t axis = 0; axis < left.selection.share_v2.size(); ++axis)
    if (axis != kAngle)
      out.elsewhere_v2 += std::max(0.0, left.selection.share_v2[axis]);
  return out;
}

namespace {

/// Whether a supply that is not recorded leaves nothing but noise across it, and held-out data are
/// likelier with it, which takes in a direction at every moment, than with whatever has no name and
/// does not go with the time: how the supply goes with the time, as a tone or slowly, is its own
/// affair.
bool is_likelier_as_supply(const Scene &scene, const DataSplit &split, const SearchResult &found,
                           double noise_v) {
  if (found.disturbed != Direction::supply)
    return false;
  const Model &model = found.fit.model;
  DataSplit weighed = split;
  weighed.weigh(found.disturbed, found.weight_along);
  const Quality with = weighed.quality(model).heldout;
  const double noise = std::max(noise_v, scene.white_noise_v);
  if (with.residual_rms_v * with.residual_rms_v > criteria::kClean * noise * noise)
    return false;
  return with.log_likelihood >
         quality_with(anonymous_of(scene, split, model, {.over_time = false}), split, model)
             .log_likelihood;
}

/// The model with what the steps in time that have no name consist of, all at once; nothing where
/// held-out data do not ask for that. Of two steps that cancel each other each alone makes a part
/// of the record worse, and so is not found by itself.
std::optional<Model> with_events(const Scene &scene, DataSplit split, const Model &model) {
  if (split.courses_taken_out) // of which the half waves leave a step where one begins steeply
    return std::nullopt;
  split.train = thinned(split.train);
  split.train.coloured.reset();
  const std::vector<EffectInstance> events =
      causes_of_steps(anonymous_of(scene, split, model), model);
  if (events.empty())
    return std::nullopt;
  Model with = model;
  with.effects.insert(with.effects.end(), events.begin(), events.end());
  const FitResult fitted = fit(split.train, with, kRefit);
  const double n = static_cast<double>(split.heldout.size());
  const double nats =
      n * std::log(left_v2(split, fit(split.train, model, kRefit).model) /
                   std::max(left_v2(split, fitted.model), criteria::kLeastMeanSquare));
  if (!fitted.determined || nats < criteria::kAdmittedNats * static_cast<double>(events.size()))
    return std::nullopt;
  Model out = with_exact_moments(scene, fitted.model, 0);
  for (std::size_t k = out.effects.size(); k-- > model.effects.size();)
    if (!begins_at_once(scene, out, k))
      out = out.without(k);
  if (out.effects.size() == model.effects.size())
    return std::nullopt;
  return out;
}

} // namespace

SearchResult name_against_anonymous(const SearchStart &start, DataSplit &split,
                                    SearchResult found) {
  if (is_likelier_as_supply(start.scene, split, found, start.noise_v))
    return found;
  constexpr int kMostRounds = 3;
  const Model first = found.fit.model;
  const auto search = [&] {
    return Search({&start.scene, split.train, split.heldout, &start.judge}, start.baseline,
                  start.noise_v, start.report);
  };
  if (const auto events = with_events(start.scene, split, found.fit.model))
    found = search().run(true, &*events);
  bool exchanged = false;
  for (int round = 1; round <= kMostRounds; ++round) {
    const Model known = found.fit.model;
    const Anonymous left = anonymous_of(start.scene, split, known);
    if (!left.any()) {
      if (exchanged) { // what took a rival's place left nothing without a name
        split.train.coloured.reset();
        found = search().run(true, &known);
      }
      prefer_what_every_pair_has(start.scene, start.judge, split, found);
      drop_what_cancels(start.scene, split, found);
      drop_what_turns_back(split, found);
      name_what_the_direction_tells(split, found);
      return found;
    }
    const Discrepancy discrepancy =
        discrepancy_of(left.basis, left.selection, left.from, Stands::to_be_named);
    SearchResult next = search().run_against(
        discrepancy, unnamed_beside(start.scene, split, known, left, start.noise_v), known);
    const bool same = names_of(next) == names_of(found);
    found = std::move(next);
    split.train = thinned(split.train);
    split.train.coloured = std::make_shared<Coloured>(discrepancy, split.train);
    const auto better = round < kMostRounds
                            ? with_better_rival(start.scene, split, found, left.selection.noise_v2)
                            : std::nullopt;
    if (better)
      found.fit.model = *better; // the next round orders and weighs it anew
    else if (same)
      break;
    exchanged = better.has_value();
  }
  for (const Axis axis : {Axis::angle, Axis::frequency})
    drop_what_is_of_a_comb(start.scene, split, found, axis);
  drop_signatures_that_bring_forth(start.scene, start.judge, split, found);
  std::vector<const Effect *> unasked;
  if (take_back_what_explains_most(start.scene, split, first, found, unasked))
    colour(start.scene, split, found.fit.model);
  if (take_back_orders_that_stand_out(start.scene, split, first, found, unasked))
    colour(start.scene, split, found.fit.model);
  drop_what_has_no_name(start.scene, split, found);
  const std::size_t named = found.order.size();
  drop_what_chance_would_take(start.scene, split, found);
  // It may have stood in the place of what explains most.
  if (found.order.size() < named &&
      take_back_what_explains_most(start.scene, split, first, found, unasked)) {
    colour(start.scene, split, found.fit.model);
    drop_what_chance_would_take(start.scene, split, found);
  }
  drop_what_a_line_describes_better(split, found);
  ask_for_rivals(start.scene, start.judge, split, found, unasked);
  prefer_what_every_pair_has(start.scene, start.judge, split, found);
  drop_what_cancels(start.scene, split, found);
  drop_what_turns_back(split, found);
  colour(start.scene, split, found.fit.model);
  name_what_the_direction_tells(split, found);
  return found;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/naming.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "diagnosis/admission.h"
#include "diagnosis/criteria.h"
#include "diagnosis/fit.h"

namespace ada {

namespace {

constexpr int kRefit = 6; // iterations

std::vector<std::string_view> names_of(const SearchResult &found) {
  std::vector<std::string_view> out;
  for (std::size_t k : found.order)
    out.push_back(found.fit.model.effects[k].effect->info().id);
  std::sort(out.begin(), out.end());
  return out;
}

/// Training data of a size that coloured fits can hold.
Observations thinned(const Observations &train) {
  std::vector<std::uint32_t> all(train.size());
  std::iota(all.begin(), all.end(), 0u);
  Observations out = train;
  out.keep(thin(all, criteria::kAnonymousTrain, 100));
  return out;
}

/// Of causes that stand equally well beside what has no name, the one leads that leaves less of it:
/// less of the residual above the noise. The model with it; nothing where none leaves so little.
std::optional<Model> with_better_rival(const Parts &parts, const SearchResult &found,
                                       double noise_v2) {
  const auto unnamed_v2 = [&](const Model &model) {
    return white_sum_of_squares(parts.heldout, as_seen_by(parts.heldout, model)) /
               (2.0 * static_cast<double>(parts.heldout.size())) -
           noise_v2;
  };
  double least = criteria::kOfRival * unnamed_v2(found.fit.model);
  const Model *better = nullptr;
  for (const std::vector<Rival> &rivals : found.alternatives)
    for (const Rival &rival : rivals)
      if (const double left = unnamed_v2(rival.model); left < least) {
        least = left;
        better = &rival.model;
      }
  return better ? std::optional(*better) : std::nullopt;
}

/// Held-out log likelihood, nats, of a model together with what has no name beside it.
double nats_beside_anonymous(const Scene &scene, const Parts &parts, const Model &model) {
  const Anonymous left = anonymous_of(scene, parts, model);
  return -0.5 * left.from.n_heldout *
         std::log(std::max(left.selection.noise_v2, criteria::kLeastMeanSquare));
}

/// A cause is no finding where held-out data are likelier without it, with what has no name then
/// chosen anew: it stood for something that the anonymous model holds better.
void drop_what_has_no_name(const Scene &scene, Parts parts, SearchResult &found) {
  parts.train = thinned(parts.train);
  parts.train.coloured.reset();
  for (;;) {
    const Model &model = found.fit.model;
    const double with = nats_beside_anonymous(scene, parts, model);
    std::size_t worst = found.order.size();
    double most = criteria::kRivalNats;
    for (std::size_t place = 0; place < found.order.size(); ++place) {
      if (model.effects[found.order[place]].effect->info().prior_rank == 0)
        continue;
      Model less = model;
      less.effects.erase(less.effects.begin() + static_cast<std::ptrdiff_t>(found.order[place]));
      const double without =
          nats_beside_anonymous(scene, parts, fit(parts.train, less, kRefit).model);
      if (without - with > most) {
        most = without - with;
        worst = place;
      }
    }
    if (worst == found.order.size())
      return;
    found.forget(worst);
    found.fit.model = fit(parts.train, found.fit.model, kRefit).model;
  }
}

/// Mean square, V^2 of a channel, that an order of the structure has which repeats with the angle
/// and has no name, weighted by itself: of the orders that carry it, not of those that happen to be
/// in.
double comb_v2(const Anonymous &left) {
  std::map<int, double> of_order;
  for (std::size_t k = 0; k < left.selection.columns.size(); ++k) {
    const Group &group =
        left.basis.groups()[static_cast<std::size_t>(left.selection.columns[k] / 2)];
    if (group.axis == Axis::angle)
      of_order[group.order] +=
          0.5 * std::pow(left.selection.values[static_cast<Eigen::Index>(k)], 2);
  }
  double sum = 0.0, squares = 0.0;
  for (const auto &[order, v2] : of_order) {
    sum += v2;
    squares += v2 * v2;
  }
  return sum > 0.0 ? squares / sum : 0.0;
}

bool has_chosen_order(const Effect &effect) {
  const auto parameters = effect.info().parameters;
  return std::any_of(parameters.begin(), parameters.end(), [](const ParameterInfo &p) {
    return p.role == Role::chosen && p.name == "order";
  });
}

/// One order of many that repeat with the angle is no cause of its own: it must stand out of what
/// has no name.
void drop_orders_of_a_comb(const Scene &scene, Parts parts, SearchResult &found) {
  parts.train = thinned(parts.train);
  parts.train.coloured.reset();
  for (;;) {
    const Model &model = found.fit.model;
    std::size_t least_place = found.order.size();
    double least = 0.0;
    const ResidualColumns all = residual_columns(parts.heldout, model);
    for (std::size_t place = 0; place < found.order.size(); ++place) {
      const std::size_t at = found.order[place];
      if (!has_chosen_order(*model.effects[at].effect))
        continue;
      Model less = model;
      less.effects.erase(less.effects.begin() + static_cast<std::ptrdiff_t>(at));
      const ResidualColumns without = residual_columns(parts.heldout, less);
      double v2 = 0.0;
      for (std::size_t i = 0; i < all.model_sin.size(); ++i)
        v2 += 0.5 * (std::pow(all.model_sin[i] - without.model_sin[i], 2) +
                     std::pow(all.model_cos[i] - without.model_cos[i], 2));
      v2 /= static_cast<double>(std::max<std::size_t>(1, all.model_sin.size()));
      if (least_place == found.order.size() || v2 < least) {
        least = v2;
        least_place = place;
      }
    }
    if (least_place == found.order.size() ||
        least > criteria::kAboveComb * comb_v2(anonymous_of(scene, parts, model)))
      return;
    found.forget(least_place);
    found.fit.model = fit(parts.train, found.fit.model, kRefit).model;
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

std::optional<double> chosen(const EffectInstance &e, std::string_view name) {
  const auto parameters = e.effect->info().parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (parameters[k].role == Role::chosen && parameters[k].name == name)
      return e.values[k];
  return std::nullopt;
}

/// What turns the field, or the reference, with the order that a harmonic of one channel has along
/// the circle: order n of psi is n - 1 from the pair's own.
std::vector<EffectInstance> direction_errors_like(const EffectInstance &harmonic, int periods) {
  std::vector<EffectInstance> out;
  const auto order = chosen(harmonic, "order");
  if (!order || !chosen(harmonic, "channel"))
    return out;
  for (const Effect *effect : catalogue()) {
    const EffectInfo &info = effect->info();
    if ((info.stage != Stage::field && info.stage != Stage::record) ||
        info.evidence != Evidence::signal || info.remembers)
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
void drop_signatures_that_bring_forth(const Scene &scene, const Scene &judge, Parts parts,
                                      SearchResult &found) {
  parts.train = thinned(parts.train);
  parts.train.coloured.reset();
  const SearchData aside{&scene, parts.train, parts.heldout, &judge};
  for (std::size_t place = found.order.size(); place-- > 0;) {
    const Model &model = found.fit.model;
    const std::size_t at = found.order[place];
    const EffectInstance &signature = model.effects[at];
    if (!signature.effect->info().signature)
      continue;
    Model less = model;
    less.effects.erase(less.effects.begin() + static_cast<std::ptrdiff_t>(at));
    less = fit(parts.train, less, kRefit).model;
    if (brings_forth(model, less)) {
      found.forget(place);
      found.fit.model = std::move(less);
      place = found.order.size();
      continue;
    }
    const auto worth = [&](const Model &m) {
      return nats_beside_anonymous(scene, parts, m) + side_evidence(aside, m);
    };
    double least = worth(model) - criteria::kRivalNats;
    std::optional<Model> better;
    for (const EffectInstance &instead : direction_errors_like(signature, model.periods_per_turn)) {
      Model other = model;
      other.effects[at] = instead;
      other = fit(parts.train, other, kRefit).model;
      const double nats = worth(other);
      if (nats > least && brings_forth(model, other)) {
        least = nats;
        better = std::move(other);
      }
    }
    if (better) {
      found.fit.model = *std::move(better);
      found.alternatives[place].clear(); // they were of the signature
    }
  }
}

} // namespace

double unnamed_on_angle(const Scene &scene, const Parts &parts, const Model &model,
                        const Anonymous &left) {
  Model physical = model;
  const auto dropped = std::erase_if(
      physical.effects, [](const EffectInstance &e) { return e.effect->info().signature; });
  return (dropped > 0 ? anonymous_of(scene, parts, physical) : left)
      .selection.share_v2[static_cast<std::size_t>(Axis::angle)];
}

SearchResult name_against_anonymous(const SearchStart &start, Parts &parts, SearchResult found) {
  constexpr int kMostRounds = 3;
  const auto search = [&] {
    return Search({&start.scene, parts.train, parts.heldout, &start.judge}, start.baseline,
                  start.noise_v, start.report);
  };
  bool exchanged = false;
  for (int round = 1; round <= kMostRounds; ++round) {
    const Model known = found.fit.model;
    const Anonymous left = anonymous_of(start.scene, parts, known);
    if (!left.any()) {
      if (exchanged) { // what took a rival's place left nothing without a name
        parts.train.coloured.reset();
        return search().run(true, &known);
      }
      return found;
    }
    const Discrepancy discrepancy = discrepancy_of(left.basis, left.selection, left.from);
    SearchResult next =
        search().run_against(discrepancy, unnamed_on_angle(start.scene, parts, known, left), known);
    const bool same = names_of(next) == names_of(found);
    found = std::move(next);
    parts.train = thinned(parts.train);
    parts.train.coloured = std::make_shared<Coloured>(discrepancy, parts.train);
    const auto better = round < kMostRounds
                            ? with_better_rival(parts, found, left.selection.noise_v2)
                            : std::nullopt;
    if (better)
      found.fit.model = *better; // the next round orders and weighs it anew
    else if (same)
      break;
    exchanged = better.has_value();
  }
  drop_orders_of_a_comb(start.scene, parts, found);
  drop_signatures_that_bring_forth(start.scene, start.judge, parts, found);
  drop_what_has_no_name(start.scene, parts, found);
  return found;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/search/told_apart.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <utility>

#include "base/angle.h"
#include "diagnosis/criteria.h"
#include "diagnosis/search/admission.h"
#include "model/effect_text.h"

namespace ada {

namespace {

/// A cause of which one coordinate is this, and any other nothing.
EffectInstance of_size(const Effect &effect, double x, std::size_t coordinate = 0) {
  const std::vector<double> absent(effect.info().parameters.size(), 0.0);
  std::vector<double> coordinates = effect.to_coordinates(absent);
  coordinates[coordinate] = x;
  return {&effect, effect.from_coordinates(absent, coordinates), {}};
}

/// The largest size of this sign that physics does not rule out.
double largest(const Effect &effect, double sign, std::size_t coordinate,
               const Observations &data) {
  Residual facts;
  facts.sample_period_s = data.frame_period_s;
  double possible = 0.0, beyond = 2.0 * effect.info().parameters[0].maximum;
  constexpr int kHalvings = 50;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (possible + beyond);
    const EffectInstance e = of_size(effect, sign * middle, coordinate);
    (in_range(e) && !effect.refuted(e.values, facts) ? possible : beyond) = middle;
  }
  return possible;
}

/// Square of an error for the size of a cause that data make `size` with a standard error, before
/// which it is as likely to be absent as not, and if it is there, of either sign and of any power
/// of ten up to what is possible. What it then may be has a peak at none and a broad hill about
/// `size`: two errors hold as much of it as of a normal law, and one is no less than its root mean
/// square.
double square_of_what_it_may_be(double size, double error, double least, double most) {
  constexpr int kPoints = 240; // of a sum over the logarithm
  const auto likelihood = [&](double x) {
    const double off = (x - size) / error, absent = size / error;
    return std::exp(std::min(700.0, 0.5 * (absent * absent - off * off))); // over that of none
  };
  std::vector<std::pair<double, double>> may_be; // size and weight, the largest first
  double there = 0.0, squares = 0.0;
  for (int k = 0; k < kPoints; ++k) {
    const double part = std::pow(10.0, -criteria::kDecadesOfSize * (k + 0.5) / kPoints);
    for (const double x : {part * most, -part * least}) {
      const double weight = likelihood(x) / (2.0 * kPoints);
      may_be.emplace_back(std::abs(x), weight);
      there += weight;
      squares += x * x * weight;
    }
  }
  std::ranges::sort(may_be, std::greater{});
  double beyond = 0.0, within = 0.0;
  for (const auto &[x, weight] : may_be)
    if ((beyond += weight) > (1.0 - criteria::kWithinTwo) * (1.0 + there)) {
      within = x;
      break;
    }
  return std::max(squares / (1.0 + there), 0.25 * within * within);
}

/// Whether a cause that a model lacks may be beside what every pair has: one of one number that
/// shows beyond the angle, or a field error of a known order, which an arc does not tell from an
/// ellipse.
bool may_be_beside(const Effect &effect, const Model &model) {
  const EffectInfo &info = effect.info();
  const bool of_field = info.stage == Stage::field && of_the_angle(effect) &&
                        std::ranges::none_of(info.parameters, [](const ParameterInfo &p) {
                          return p.role == Role::chosen || is_place(p);
                        });
  return info.prior_rank == 1 && info.evidence == Evidence::signal &&
         ((shows_beyond_angle(effect) && info.parameters.size() == 1) || of_field) &&
         std::none_of(model.effects.begin(), model.effects.end(),
                      [&](const EffectInstance &e) { return e.effect == &effect; });
}

/// The coordinates of what every pair has, each with the effect that it is of.
std::vector<std::pair<Eigen::Index, std::size_t>> of_every_pair(const Model &model) {
  std::vector<std::pair<Eigen::Index, std::size_t>> out;
  auto at = static_cast<Eigen::Index>(coordinates_of(Model{}).size());
  for (std::size_t e = 0; e < model.effects.size(); ++e)
    for (std::size_t k = 0; k < coordinates(model.effects[e]); ++k, ++at)
      if (model.effects[e].effect->info().prior_rank == 0)
        out.emplace_back(at, e);
  return out;
}

} // namespace

std::vector<Untold> widen_by_what_is_not_told_apart(const Observations &all, FitResult &result) {
  constexpr double kSigmas = 2.0;       // of an error within which a value may be none at all
  constexpr std::size_t kEnough = 4000; // shapes are known by fewer than sizes are
  std::vector<Untold> out;
  const Model model = result.model;
  const auto places = of_every_pair(model);
  if (places.empty() || !result.determined)
    return out;
  const std::vector<double> x = coordinates_of(model);
  const auto n = static_cast<Eigen::Index>(x.size());
  const Eigen::MatrixXd before = result.covariance;
  std::optional<Observations> some;
  for (const Effect *other : catalogue()) {
    if (!may_be_beside(*other, model))
      continue;
    if (!some) {
      std::vector<std::uint32_t> indices(all.size());
      std::iota(indices.begin(), indices.end(), 0u);
      some = all.select(thin(indices, kEnough, 100));
    }
    Model both = model;
    both.effects.push_back(of_size(*other, 0.0));
    const FitResult look = fit(*some, both, 1);
    const auto entangled = [&](const auto &place) {
      const auto k = place.first;
      for (Eigen::Index of = n; of < look.covariance.cols(); ++of)
        if (std::abs(look.covariance(k, of)) >
            criteria::kWorthAFit * std::sqrt(look.covariance(k, k) * look.covariance(of, of)))
          return true;
      return false;
    };
    if (!look.determined || std::none_of(places.begin(), places.end(), entangled))
      continue;
    const FitResult joint = fit(all, both, 3);
    if (!joint.determined)
      continue;
    const std::vector<double> sizes = coordinates_of(joint.model);
    // Of each of what every pair has: by how much the other may move it, in variance, and by how
    // much a size of two errors does.
    std::vector<double> wider(places.size(), 0.0), moved(places.size(), 0.0);
    for (Eigen::Index of = n; of < joint.covariance.cols(); ++of) {
      const double size = sizes[static_cast<std::size_t>(of)];
      const double error = std::sqrt(joint.covariance(of, of));
      const auto coordinate = static_cast<std::size_t>(of - n);
      const double least = largest(*other, -1.0, coordinate, all),
                   most = largest(*other, 1.0, coordinate, all);
      if (error > std::max(least, most)) // one speed, say: then one or the other has the name
        continue;
      const double added = square_of_what_it_may_be(size, error, least, most);
      const Eigen::VectorXd moves = joint.covariance.col(of).head(n) / (error * error);
      if (!std::isfinite(added) || !moves.allFinite())
        continue;
      for (std::size_t p = 0; p < places.size(); ++p) {
        const double move = moves[places[p].first];
        wider[p] += added * move * move;
        moved[p] += std::pow(kSigmas * error * move, 2);
      }
    }
    for (std::size_t p = 0; p < places.size(); ++p) {
      const auto [k, effect] = places[p];
      // Where the other could stand for all of it, it is the one or the other: between all and
      // nothing, each as likely, lies half of the value to either side.
      const double value = x[static_cast<std::size_t>(k)];
      const bool all_of_it = value * value < moved[p];
      if (all_of_it)
        wider[p] = std::min(wider[p], 0.25 * value * value);
      if (all_of_it || wider[p] > criteria::kClear * before(k, k))
        out.push_back({effect, other});
      result.covariance(k, k) += wider[p];
    }
  }
  return out;
}

void widen_by_choices(const Observations &data, FitResult &result) {
  if (!result.determined)
    return;
  const std::vector<double> x = coordinates_of(result.model);
  for (std::size_t e = 0; e < result.model.effects.size(); ++e) {
    const EffectInstance &chosen = result.model.effects[e];
    for (auto &values : chosen.effect->choices(chosen.values)) {
      Model model = result.model;
      model.effects[e].values = std::move(values);
      const FitResult other = fit(data, model, 5);
      const std::vector<double> y = coordinates_of(other.model);
      const double nats = static_cast<double>(data.size()) * std::log(other.rss / result.rss);
      if (!other.determined || y.size() != x.size() || !(nats < criteria::kRivalNats))
        continue;
      const double likelihood = std::exp(-std::max(nats, 0.0)); // over that of the choice made
      const double weight = likelihood / (1.0 + likelihood);
      for (std::size_t k = 0; k < x.size(); ++k) {
        const auto at = static_cast<Eigen::Index>(k);
        result.covariance(at, at) += weight * (1.0 - weight) * std::pow(y[k] - x[k], 2);
      }
    }
  }
}

namespace {

constexpr double kEither = 0.25; // variance of one of two numbers that lie 1 apart

/// Which of a model's coordinates are those of an effect.
struct Span {
  std::size_t begin, end;
};

Span coordinates_within(const Model &model, std::size_t effect) {
  std::size_t begin = coordinates_of(Model{}).size();
  for (std::size_t e = 0; e < effect; ++e)
    begin += coordinates(model.effects[e]);
  return {begin, begin + coordinates(model.effects[effect])};
}

/// The model with a rival in the place of one of its causes; nothing where that is no such model.
std::optional<Model> with_rival(Model model, std::size_t effect, const Rival &rival) {
  for (const EffectInstance &e : rival.model.effects)
    if (e.effect->info().id == rival.id &&
        std::ranges::none_of(model.effects,
                             [&](const EffectInstance &o) { return repeats(e, o); })) {
      model.effects[effect] = e;
      return model;
    }
  return std::nullopt;
}

} // namespace

void widen_by_rivals(const Observations &data, const Model &as_found, std::size_t effect,
                     const std::vector<Rival> &rivals, FitResult &result) {
  const std::vector<double> x = coordinates_of(as_found);
  const auto [begin, end] = coordinates_within(as_found, effect);
  const double rss = sum_of_squares(data, as_found);
  std::vector<double> wider(x.size(), 0.0); // with several the farthest decides
  for (const Rival &rival : rivals) {
    const std::optional<Model> model = with_rival(as_found, effect, rival);
    if (!model)
      continue;
    const FitResult other = fit(data, *model, 5);
    if (!other.determined || !in_range(other.model) ||
        !(static_cast<double>(data.size()) * std::log(other.rss / rss) < criteria::kRivalNats))
      continue;
    const std::vector<double> y = coordinates_of(other.model);
    for (std::size_t k = 0; k < x.size(); ++k)
      if (k < begin || k >= end) {
        const double apart = y[k < begin ? k : k + y.size() - x.size()] - x[k];
        wider[k] = std::max(wider[k], kEither * apart * apart);
      }
  }
  for (std::size_t k = 0; k < x.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    result.covariance(at, at) += wider[k];
  }
}

namespace {

/// The error of the reference that a cause may be, or is, and its size as a ripple, rad; order 0:
/// it is none.
struct OfReference {
  OrderRipple ripple;
  double size_rad = 0.0;
  const Effect *other = nullptr; ///< of the two that both may be there
};

OfReference of_reference(const Observations &data, const Model &model, const SearchResult &found,
                         std::size_t place) {
  const EffectInstance &e = model.effects[found.order[place]];
  const auto size = [](const OrderRipple &r) { return std::hypot(r.cos, r.sin); };
  const auto first_known = [&](bool of_reference) {
    const Effect *out = nullptr;
    for (const Separation &from : e.effect->info().separations)
      if (const Effect *known = find_effect(from.rival);
          !out && known && known->info().evidence == Evidence::signal &&
          (known->info().stage == Stage::record) == of_reference)
        out = known;
    return out;
  };
  if (const OrderRipple own = e.effect->reference_ripple(e.values); own.order > 0.0)
    return {own, size(own), first_known(false)};
  if (e.effect->info().pattern != Pattern::turn || e.effect->info().stage != Stage::field)
    return {};
  for (const Rival &rival : found.alternatives[place])
    for (const EffectInstance &other : rival.model.effects)
      if (const OrderRipple r = other.effect->reference_ripple(other.values);
          r.order > 0.0 && other.effect->info().id == rival.id)
        return {{r.order, 0.0, 0.0}, size(r), other.effect};
  const Effect *other = first_known(true);
  if (!other || chosen(absent(*other), "order", "per turn"))
    return {};
  const double order = other->reference_ripple(of_size(*other, 1.0).values).order;
  return {{order, 0.0, 0.0},
          2.0 * moved_rms_v(data, model, found.order[place]) /
              (model.baseline.amplitude_v * model.periods_per_turn),
          other};
}

} // namespace

std::vector<Untold> widen_by_ripples(const std::vector<Ripple> &ripples, const Observations &data,
                                     const SearchResult &found, FitResult &result) {
  constexpr double kErrors = 3.0;
  std::vector<Untold> out;
  if (!result.determined)
    return out;
  std::vector<OfReference> all;
  for (std::size_t place = 0; place < found.order.size(); ++place)
    all.push_back(of_reference(data, result.model, found, place));
  const std::vector<double> x = coordinates_of(result.model);
  for (std::size_t place = 0; place < all.size(); ++place) {
    const OfReference &of = all[place];
    const auto n = static_cast<std::size_t>(std::max(of.ripple.order, 0.0));
    if (n == 0 || n > ripples.size() || static_cast<double>(n) != of.ripple.order || !of.other ||
        !(of.size_rad > 0.0) || std::ranges::count_if(all, [&](const OfReference &o) {
                                  return o.ripple.order == of.ripple.order;
                                }) > 1)
      continue;
    const Ripple &seen = ripples[n - 1];
    const double off = std::hypot(seen.cos - of.ripple.cos, seen.sin - of.ripple.sin);
    if (off < kErrors * seen.error)
      continue;
    // That both err is as likely as that the shaft ripples, but for the coincidence that two which
    // err by so much differ by so little.
    const double both = 0.5 * std::min(1.0, std::pow(of.size_rad / off, 2));
    const auto [begin, end] = coordinates_within(result.model, found.order[place]);
    double size2 = 0.0;
    for (std::size_t k = begin; k < end; ++k)
      size2 += x[k] * x[k];
    for (std::size_t k = begin; k < end; ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      result.covariance(at, at) += both * (1.0 - both) * size2 * std::pow(off / of.size_rad, 2);
    }
    out.push_back({found.order[place], of.other});
  }
  return out;
}

} // namespace ada

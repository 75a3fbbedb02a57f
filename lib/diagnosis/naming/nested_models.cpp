// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/naming/nested_models.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "base/pick.h"
#include "base/robust.h"
#include "base/solve.h"
#include "diagnosis/criteria.h"
#include "diagnosis/lines/one_line.h"
#include "diagnosis/naming/borne_out.h"
#include "diagnosis/noise/along_and_across.h"
#include "diagnosis/search/admission.h"
#include "diagnosis/search/first_model.h"
#include "diagnosis/search/identifiability.h"
#include "diagnosis/search/told_apart.h"
#include "diagnosis/words/explain.h"
#include "model/effect_text.h"
#include "model/wires.h"

namespace ada {

namespace {

/// The effect of a fitted model that this is a less fitted version of.
const EffectInstance *same_instance(const Model &model, const EffectInstance &e) {
  for (const EffectInstance &o : model.effects)
    if (repeats(o, e))
      return &o;
  return nullptr;
}

/// The model without anything that was found.
Model without_findings(const SearchResult &found) {
  Model model = found.fit.model;
  std::vector<std::size_t> drop = found.order;
  std::sort(drop.rbegin(), drop.rend());
  for (std::size_t k : drop)
    model.effects.erase(model.effects.begin() + static_cast<std::ptrdiff_t>(k));
  return model;
}

/// Standard error of the mean square of a supply that nobody recorded, of its mean: from stretch to
/// stretch, since a supply goes on from row to row, and a few starts of a motor may be all of it.
double error_of_supply(const DataSplit &split, const Model &model) {
  const Observations &data = split.train;
  const ResidualColumns r = residual_columns(data, model);
  std::vector<double> parts;
  const std::size_t stretch = std::max<std::size_t>(1, data.size() / criteria::kStretches);
  for (std::size_t first = 0; first + stretch <= data.size(); first += stretch) {
    double along2 = 0.0, of2 = 0.0;
    for (std::size_t i = first; i < first + stretch; ++i) {
      // What lies along the absolute voltages; of a pair that tells its angle itself, along that.
      double s = data.vsin[i], c = data.vcos[i], reach = std::hypot(s, c);
      if (!split.has_reference) {
        const double out_s = r.model_sin[i] - data.centre_sin_v,
                     out_c = r.model_cos[i] - data.centre_cos_v, out = std::hypot(out_s, out_c);
        reach = (s * out_s + c * out_c) / out;
        s = out_s * reach / out;
        c = out_c * reach / out;
      }
      const double along = (r.sin[i] * s + r.cos[i] * c) / std::max(std::abs(reach), 1e-12);
      along2 += along * along;
      of2 += reach * reach;
    }
    parts.push_back(along2 / of2);
  }
  const double n = static_cast<double>(parts.size());
  if (n < 2.0)
    return 0.0;
  const double mean = std::accumulate(parts.begin(), parts.end(), 0.0) / n;
  double squares = 0.0;
  for (double part : parts)
    squares += (part - mean) * (part - mean);
  return std::sqrt(squares / (n - 1.0) / n);
}

Finding supply_finding(const DataSplit &split, const Model &model, double rms_fraction,
                       const SplitQuality &before, const SplitQuality &after) {
  const double error =
      std::max(rms_fraction / std::sqrt(2.0 * static_cast<double>(split.train.size())),
               0.5 * error_of_supply(split, model) / rms_fraction);
  Finding out{
      &the_effect(follows_supply), {rms_fraction}, {error}, {}, {}, {}, before, after, false};
  put_in_words(out);
  return out;
}

} // namespace

void put_in_words(Finding &finding) {
  finding.separate_by = separation(*finding.effect, finding.alternatives);
  finding.explanation = explanation(finding);
}

namespace {

constexpr double kWithinOneSigma = 0.6827; ///< of normal numbers

/// Places that a cause could have been found at: the largest of as many chances is the larger by
/// twice the logarithm of their number (the square of a normal number exceeds that once in so
/// many).
double places_of(const EffectInstance &e, std::size_t samples) {
  double places = 1.0;
  for (const ParameterInfo &p : e.effect->info().parameters)
    if (is_place(p))
      places *=
          std::min(static_cast<double>(samples),
                   p.name == "order" ? p.maximum - p.minimum + 1.0 : static_cast<double>(samples));
  return places;
}

/// What the sum of so many squares of normal numbers exceeds as often as one of them exceeds two
/// standard deviations (Wilson and Hilferty, Proc. Natl. Acad. Sci. 17, 1931).
double twice_of(double count) {
  constexpr double kOneSided = 1.69; // of a normal number, 4.55 %
  const double part = 2.0 / (9.0 * count);
  return count * std::pow(1.0 - part + kOneSided * std::sqrt(part), 3);
}

std::vector<Clearness> clearness_of(const FitResult &fit, std::size_t samples) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  std::vector<Clearness> out;
  Eigen::Index first = static_cast<Eigen::Index>(coordinates_of(Model{}).size());
  for (const EffectInstance &e : fit.model.effects) {
    const std::vector<double> x = e.effect->to_coordinates(e.values);
    const auto parameters = e.effect->info().parameters;
    std::vector<Eigen::Index> sizes; // the coordinates that are 0 where it is absent
    for (std::size_t k = 0; k < x.size(); ++k)
      if (x.size() != parameters.size() || !is_place(parameters[k]))
        sizes.push_back(static_cast<Eigen::Index>(k));
    const auto all = static_cast<Eigen::Index>(x.size()),
               n = static_cast<Eigen::Index>(sizes.size());
    const Eigen::VectorXd value = Eigen::Map<const Eigen::VectorXd>(x.data(), all)(sizes);
    const Eigen::MatrixXd c = fit.covariance.block(first, first, all, all)(sizes, sizes);
    const double z2 = n == 0 ? kAny : value.dot(solved(c, value).col(0));
    const double count = static_cast<double>(n);
    out.push_back(fit.determined && std::isfinite(z2)
                      ? Clearness{z2 / count, (z2 - 2.0 * std::log(places_of(e, samples))) / count,
                                  n == 0 ? kAny : z2 / twice_of(count)}
                      : Clearness{kAny, kAny, 0.0});
    first += all;
  }
  return out;
}

FitResult fit_with_errors(const Observations &data, const Model &start) {
  // Along what the part without a name takes for its own the steps are small: most fits are at
  // their end after two.
  constexpr int kMostSteps = 40;
  FitResult out = fit(data, start, kMostSteps);
  widen_by_scatter(data, out);
  return out;
}

/// Scatter of the residual along and across the vector, and of either from sample to sample.
struct Scatter {
  double along, across, noise_along, noise_across;
};

Scatter scatter_of(const Observations &data, const Model &model) {
  const ResidualColumns r = residual_columns(data, model);
  std::vector<double> along, across;
  along_and_across(data, r, along, across);
  const auto of = [](std::vector<double> values, double &scatter, double &noise) {
    std::vector<double> steps;
    double last = 0.0;
    for (double &v : values) {
      steps.push_back(std::abs(v - std::exchange(last, v)));
      v = std::abs(v);
    }
    scatter = quantile(std::move(values), kWithinOneSigma);
    noise = quantile(std::move(steps), kWithinOneSigma) / std::numbers::sqrt2;
  };
  Scatter out{};
  of(std::move(along), out.along, out.noise_along);
  of(std::move(across), out.across, out.noise_across);
  return out;
}

} // namespace

std::optional<FitResult> fit_by_direction(DataSplit split, Model model, bool bent) {
  split.train.coloured.reset();
  constexpr int kPasses = 3; // what lies across shows only where the length no longer bends the fit
  for (int pass = 0; pass < kPasses; ++pass) {
    // A gain acts on the vector from the centre, of which the length has told little.
    const auto [centre_sin_v, centre_cos_v] = recorded_centre_v(model);
    split.train.centre_sin_v = centre_sin_v;
    split.train.centre_cos_v = centre_cos_v;
    const Scatter left = scatter_of(split.train, model);
    if (left.along <= criteria::kMoreThanNoise * left.across && !(bent && pass == 0))
      return std::nullopt;
    // What wanders has as many independent samples as its steps have of its mean square: it is a
    // witness no more often than that.
    const double independent = std::min(1.0, left.noise_along / left.along);
    split.weigh(Direction::radius, independent * left.noise_across / left.along);
    model = fit(split.train, model, 5).model;
  }
  // What is left across is noise, or next to nothing of what the length does.
  const Scatter left = scatter_of(split.train, model);
  if (left.across > criteria::kMoreThanNoise * left.noise_across &&
      left.across > criteria::kFarLessAcross * left.along)
    return std::nullopt;
  return fit_with_errors(split.train, model);
}

std::vector<Clearness> clear_by_length(DataSplit split, const Model &start, double weight_across) {
  split.train.coloured.reset();
  split.weigh(Direction::motion, weight_across);
  const FitResult apart = fit_with_errors(split.train, start);
  return apart.determined ? clearness_of(apart, split.train.size()) : std::vector<Clearness>{};
}

bool leaves_length(const Observations &data, const Model &model) {
  const Scatter left = scatter_of(data, model);
  return left.along > criteria::kMoreThanNoise * left.noise_along;
}

bool is_clearly_closer(const DataSplit &split, const Model &apart, const Model &alike) {
  const auto angle_error = [&](const Model &m) {
    return split.quality(m).heldout.angle_error_rms_deg.value();
  };
  return angle_error(alike) > criteria::kNoWorse * angle_error(apart);
}

namespace {

/// `one` with the numbers of the figure of `other`, and their errors.
FitResult with_figure_of(const FitResult &other, FitResult one) {
  std::vector<Eigen::Index> figure{0, 1, 2}; // amplitude and offsets
  auto first = static_cast<Eigen::Index>(coordinates_of(Model{}).size());
  for (std::size_t k = 0; k < one.model.effects.size(); ++k) {
    EffectInstance &e = one.model.effects[k];
    const auto n = static_cast<Eigen::Index>(e.effect->to_coordinates(e.values).size());
    if (shapes_the_figure(*e.effect)) {
      e.values = other.model.effects[k].values;
      for (Eigen::Index c = 0; c < n; ++c)
        figure.push_back(first + c);
    }
    first += n;
  }
  const double zero = one.model.baseline.angle_zero_deg;
  one.model.baseline = other.model.baseline;
  one.model.baseline.angle_zero_deg = zero;
  for (Eigen::Index a : figure) {
    one.covariance.row(a).setZero();
    one.covariance.col(a).setZero();
  }
  one.covariance(figure, figure) = other.covariance(figure, figure);
  return one;
}

/// Fits in which residuals across the vector weigh by their own scatter, in turn better ones as
/// long as the length of the vector says so: a reference that creeps, plays or is late by a random
/// time scatters there, and the length still says what figure the pair draws. Where the reference
/// is off by so much that its error bends the length, at the angle that the pair itself gives.
template <class Better> void fit_by_length(DataSplit split, FitResult &best, Better better) {
  split.train.coloured.reset();
  const Scatter left = scatter_of(split.train, best.model);
  if (left.across <= criteria::kMoreThanNoise * left.along)
    return;
  split.weigh(Direction::motion, left.along / left.across);
  if (const FitResult apart = fit_with_errors(split.train, fit(split.train, best.model, 5).model);
      apart.determined)
    if (FitResult merged = with_figure_of(apart, best); better(merged, best))
      best = std::move(merged);
  split.weigh(Direction::motion, kWeightOfOwnAngle);
  constexpr int kPasses = 3; // each at the angle that the last one gave
  for (int pass = 0; pass < kPasses; ++pass) {
    split.train = at_own_angle(std::move(split.train), best.model);
    const FitResult own = fit_with_errors(split.train, best.model);
    if (!own.determined)
      return;
    FitResult merged = with_figure_of(own, best);
    if (!better(merged, best))
      return;
    best = std::move(merged);
  }
}

} // namespace

namespace {

/// Means of values over the electrical period about each sample.
std::vector<double> mean_over_periods(const Observations &data, const std::vector<double> &values,
                                      int periods) {
  const double half = 0.5 * kTwoPi / periods;
  std::vector<double> out(values.size());
  std::size_t first = 0, end = 0;
  double sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto near = [&](std::size_t k) {
      return std::abs(data.alpha[k] - data.alpha[i]) <= half;
    };
    if (end < i) { // a gap
      first = end = i;
      sum = 0.0;
    }
    while (end < values.size() && near(end))
      sum += values[end++];
    while (first < i && !near(first))
      sum -= values[first++];
    out[i] = end > first ? sum / static_cast<double>(end - first) : 0.0;
  }
  return out;
}

/// Residual along the radius, V.
std::vector<double> along_radius(const Observations &data, const ResidualColumns &r) {
  std::vector<double> out;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double s = r.model_sin[i] - data.centre_sin_v, c = r.model_cos[i] - data.centre_cos_v;
    out.push_back((r.sin[i] * s + r.cos[i] * c) / std::sqrt(std::max(s * s + c * c, 1e-12)));
  }
  return out;
}

/// At the pair's own angle, with a length that does not drift.
Observations without_drift(const Observations &data, const Model &model) {
  Observations out = at_own_angle(data, model);
  const ResidualColumns r = residual_columns(out, model);
  const std::vector<double> slow =
      mean_over_periods(out, along_radius(out, r), model.periods_per_turn);
  for (std::size_t i = 0; i < out.size(); ++i) {
    // A gain: it changes what turns in proportion.
    const double s = r.model_sin[i] - out.centre_sin_v, c = r.model_cos[i] - out.centre_cos_v;
    const double part = slow[i] / std::sqrt(std::max(s * s + c * c, 1e-12));
    out.vsin[i] -= as_float(part * s);
    out.vcos[i] -= as_float(part * c);
  }
  return out;
}

} // namespace

RadiusLeft radius_left(const Observations &data, const Model &model) {
  const Observations own = at_own_angle(data, model);
  const std::vector<double> radius = along_radius(own, residual_columns(own, model));
  const std::vector<double> slow = mean_over_periods(own, radius, model.periods_per_turn);
  struct Sums {
    double along2 = 0.0, steps2 = 0.0, rows = 0.0;
    double mean() const { return along2 / std::max(rows, 1.0); }
  };
  std::map<double, Sums> of_period;
  Sums all;
  double before = 0.0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    const double along = radius[i] - slow[i], step = i > 0 ? along - before : 0.0;
    Sums &period = of_period[std::floor(own.alpha[i] * model.periods_per_turn / kTwoPi)];
    for (Sums *of : {&all, &period}) {
      of->along2 += along * along;
      of->steps2 += 0.5 * step * step;
      of->rows += 1.0;
    }
    before = along;
  }
  // What happens in one period and not in the others, as a gain that changes, is no matter of the
  // figure: its size is that of the period in the middle, and how white it is the middle half
  // tells.
  double mean_v2 = all.mean();
  Sums middle = all;
  const double usual_rows = all.rows / std::max<double>(1.0, static_cast<double>(of_period.size()));
  std::vector<Sums> periods;
  for (const auto &[place, sums] : of_period)
    if (sums.rows >= 0.5 * usual_rows)
      periods.push_back(sums);
  if (periods.size() >= criteria::kFewestPeriodsInTheMiddle) {
    std::ranges::sort(periods, {}, &Sums::mean);
    mean_v2 = periods[periods.size() / 2].mean();
    middle = {};
    for (std::size_t k = periods.size() / 4; k < periods.size() - periods.size() / 4; ++k) {
      middle.along2 += periods[k].along2;
      middle.steps2 += periods[k].steps2;
    }
  }
  return {std::sqrt(mean_v2),
          all.rows * (middle.along2 > 0.0 ? std::min(1.0, middle.steps2 / middle.along2) : 1.0)};
}

namespace {

/// The whole model with its errors. Where nothing but noise is left across the vector, what is left
/// along it is a length that wanders, with the air gap or the light, and says little of the pair:
/// only for an angle that is clearly better, as what is small across and has no name is then not
/// reckoned with. Where more is left across it than along it, the reference says little, and the
/// radius of held-out data is asked.
FitResult fit_whole(const DataSplit &split, const Model &start, bool &by_direction) {
  FitResult alike = fit_with_errors(split.train, start);
  const auto radius = [&](const FitResult &f) { return radius_left(split.heldout, f.model); };
  if (std::optional<FitResult> apart = fit_by_direction(split, start))
    return (by_direction = apart->determined && is_clearly_closer(split, apart->model, alike.model))
               ? *std::move(apart)
               : alike;
  fit_by_length(split, alike, [&](const FitResult &one, const FitResult &other) {
    return nats_between(radius(other), radius(one)) > criteria::kRivalNats;
  });
  // What is left of a course that was taken out says little, and with a weight for each of its half
  // waves the mean, which the offsets are, is free.
  if (split.courses_taken_out && split.train.coloured) {
    DataSplit white = split;
    white.train.coloured.reset();
    FitResult plain = fit_with_errors(white.train, alike.model);
    if ((white.quality(plain.model).heldout.log_likelihood -
         white.quality(alike.model).heldout.log_likelihood) *
            static_cast<double>(split.heldout.size()) >
        criteria::kRivalNats)
      alike = std::move(plain);
  }
  return alike;
}

/// The whole model where the angle is read off the pair. What the motion leaves over bends the fit,
/// and so may what has no name: the radius of held-out data, to which the motion gives nothing,
/// says whether a fit without the one, by the radius alone, or by a radius that does not drift is
/// the better one.
FitResult fit_without_reference(DataSplit split, const Model &start) {
  FitResult best = fit_with_errors(split.train, start);
  RadiusLeft least = radius_left(split.heldout, best.model);
  double nats = criteria::kRivalNats;
  const auto consider = [&] {
    FitResult other = fit_with_errors(split.train, best.model);
    if (split.train.disturbed == Direction::motion)
      other = with_figure_of(other, best);
    const RadiusLeft left = radius_left(split.heldout, other.model);
    if (!other.determined || nats_between(least, left) <= nats)
      return;
    least = left;
    nats = 0.0; // a further pass need only be the better one
    best = std::move(other);
  };
  if (split.train.coloured) {
    split.train.coloured.reset();
    consider();
  }
  if (split.train.disturbed != Direction::supply) {
    split.weigh(Direction::motion, kWeightOfOwnAngle);
    constexpr int kPasses = 3; // each at the angle that the last one gave
    for (int pass = 0; pass < kPasses; ++pass) {
      split.train = at_own_angle(std::move(split.train), best.model);
      consider();
    }
    nats = criteria::kRivalNats;
    const Observations as_it_is = split.train;
    for (int pass = 0; pass < kPasses; ++pass) {
      split.train = without_drift(as_it_is, best.model);
      consider();
    }
  }
  return best;
}

/// A model on the way to the whole one, the better the less it leaves. Where the angle is read off
/// the pair that is along the radius alone. A part of the whole does not tell a direction of the
/// figure from the zero angle: with hardly a weight across the vector the zero angle would follow
/// what the part cannot be.
Model fit_on_the_way(const DataSplit &split, Model model, int most_steps) {
  const auto left_of = [&](const Model &of) { return split.quality(of).in_sample.residual_rms_v; };
  if (!split.own_angle)
    return fit(split.train, model, most_steps).model;
  Observations train = split.train;
  train.coloured.reset();
  train.disturbed = Direction::none;
  train.weight_along = 1.0;
  double least_v = left_of(model);
  constexpr int kPasses = 4; // each at the angle that the last one gave
  for (int pass = 0; pass < kPasses; ++pass) {
    train = at_own_angle(std::move(train), model);
    Model next = fit(train, model, most_steps).model;
    const double left_v = left_of(next);
    if (left_v >= least_v)
      break;
    least_v = left_v;
    model = std::move(next);
  }
  return model;
}

/// A part of a model that leaves more than the one before: of two causes that cancel each other in
/// part the first is too large without the second, and what has no name, beside which it is fitted,
/// takes the difference and is no part of the step. Fitted without that it stands by itself.
SplitQuality fitted_by_itself(const DataSplit &split, Model &step, SplitQuality after) {
  if (!split.train.coloured)
    return after;
  const Uncoloured uncoloured(split);
  Model plain = fit_on_the_way(uncoloured.split(), step, 5);
  SplitQuality other = split.quality(plain);
  if (other.heldout.log_likelihood < after.heldout.log_likelihood)
    return after;
  step = std::move(plain);
  return other;
}

std::vector<std::string> ids_of(const std::vector<Rival> &rivals) {
  std::vector<std::string> out;
  for (const Rival &r : rivals)
    out.push_back(r.id);
  return out;
}

void add_alternative(const Effect &effect, std::vector<std::string> &ids) {
  if (std::find(ids.begin(), ids.end(), effect.info().id) == ids.end())
    ids.emplace_back(effect.info().id);
}

/// What else it may be: the rivals that the search met, what its value hangs on, and whose line it
/// may be.
std::vector<std::string> alternatives_of(const std::vector<Rival> &rivals,
                                         const std::vector<Untold> &untold,
                                         const Observations &data, const Model &model,
                                         std::size_t effect) {
  std::vector<std::string> out = ids_of(rivals);
  for (const Untold &u : untold)
    if (u.effect == effect)
      add_alternative(*u.other, out);
  const EffectInstance &e = model.effects[effect];
  if (e.effect->one_line(e.values)) {
    const double variance_v2 =
        white_sum_of_squares(data, model) / (2.0 * static_cast<double>(data.size()));
    for (const Effect *other : same_line(data, model, effect, variance_v2))
      add_alternative(*other, out);
  }
  return out;
}

/// Every number hangs on which of its alternatives a cause is.
void widen_by_alternatives(const Observations &data, const SearchResult &found, FitResult &whole) {
  if (!whole.determined ||
      std::ranges::all_of(found.alternatives, [](const auto &rivals) { return rivals.empty(); }))
    return;
  const Model as_found = fit(data, whole.model, 5).model;
  for (std::size_t i = 0; i < found.order.size(); ++i)
    if (!found.alternatives[i].empty())
      widen_by_rivals(data, as_found, found.order[i], found.alternatives[i], whole);
}

} // namespace

std::optional<Model> with_what_the_length_shows(const DataSplit &split, const Model &model) {
  Model more = with_expected(model);
  const Scatter left = scatter_of(split.train, model);
  if (more.effects.size() == model.effects.size() ||
      left.across <= criteria::kMoreThanNoise * left.along)
    return std::nullopt;
  // Both as the length has them: a figure that the reference has bent is no matter of one or the
  // other.
  const auto by_length = [&](const Model &start) {
    DataSplit at = split;
    at.train.coloured.reset();
    at.weigh(Direction::motion, left.along / left.across);
    FitResult out = fit(at.train, start, 12);
    at.train = at_own_angle(std::move(at.train), out.model);
    at.weigh(Direction::motion, kWeightOfOwnAngle);
    return fit(at.train, out.model, 5);
  };
  const FitResult with = by_length(more), without = by_length(model);
  if (!with.determined ||
      nats_between(radius_left(split.heldout, without.model),
                   radius_left(split.heldout, with.model)) <= criteria::kLeastNats)
    return std::nullopt;
  return with.model;
}

NestedModels nested_models(const Scene &scene, DataSplit &split, const SearchResult &found) {
  // A supply that is not recorded counts as a finding, and so from its own step on.
  const bool supply = found.disturbed == Direction::supply;
  split.weigh(found.disturbed, supply ? 1.0 : found.weight_along);
  NestedModels out;
  Model step = out.baseline = fit_on_the_way(split, without_findings(found), 6);
  out.models.push_back(step);
  out.first = out.last = split.quality(step);
  split.weigh(found.disturbed, found.weight_along);
  if (found.supply_rms_fraction > 0.0) {
    if (supply)
      step = fit_on_the_way(split, step, 6);
    const SplitQuality after = split.quality(step);
    out.supply = supply_finding(split, step, found.supply_rms_fraction, out.first, after);
    out.last = after;
  }
  const bool weighs_alike = split.has_reference && found.disturbed != Direction::supply;
  FitResult whole = weighs_alike           ? fit_whole(split, found.fit.model, out.by_direction)
                    : !split.has_reference ? fit_without_reference(split, found.fit.model)
                                           : fit_with_errors(split.train, found.fit.model);
  std::vector<Clearness> clear = clearness_of(whole, split.train.size());
  if (weighs_alike)
    widen_by_what_is_not_borne_out(split.train, whole);
  std::vector<Untold> untold = widen_by_what_is_not_told_apart(split.train, whole);
  widen_by_choices(split.train, whole);
  const std::vector<Clearness> as_said = clearness_of(whole, split.train.size());
  for (std::size_t k = 0; k < clear.size(); ++k)
    clear[k].as_said = as_said[k].as_said;
  widen_by_alternatives(split.train, found, whole);
  if (split.has_reference)
    for (const Untold &both : widen_by_ripples(scene.reference_ripples, split.train, found, whole))
      untold.push_back(both);
  attach_errors(whole);
  out.extended = std::move(whole.model);
  const Model &model = out.extended;
  for (std::size_t i = 0; i < found.order.size(); ++i) {
    const EffectInstance &e = model.effects[found.order[i]];
    step.effects.push_back(e);
    // Everything else starts where the whole model has it: a clipping bends the baseline far.
    step.baseline = model.baseline;
    for (EffectInstance &earlier : step.effects)
      if (const EffectInstance *last = same_instance(model, earlier))
        earlier.values = last->values;
    const bool last = i + 1 == found.order.size();
    step = last ? model : fit_on_the_way(split, step, 5);
    SplitQuality after = split.quality(step);
    if (!last && after.heldout.log_likelihood < out.last.heldout.log_likelihood)
      after = fitted_by_itself(split, step, std::move(after));
    out.models.push_back(step);
    out.findings.push_back(
        {e.effect,
         e.values,
         e.std_errors,
         alternatives_of(found.alternatives[i], untold, split.train, model, found.order[i]),
         {},
         {},
         out.last,
         after,
         e.effect->info().correctable});
    put_in_words(out.findings.back());
    out.clearness.push_back(clear[found.order[i]]);
    out.last = after;
  }
  if (out.supply && supply) {
    // What its weights are worth shows where nothing else is wrong any more.
    split.weigh(found.disturbed, 1.0);
    const SplitQuality plain = split.quality(model);
    split.weigh(found.disturbed, found.weight_along);
    for (Quality SplitQuality::*part : {&SplitQuality::in_sample, &SplitQuality::heldout}) {
      (out.supply->before.*part).log_likelihood = (plain.*part).log_likelihood;
      (out.supply->after.*part).log_likelihood = (out.last.*part).log_likelihood;
    }
  }
  return out;
}

} // namespace ada

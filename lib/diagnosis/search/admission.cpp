// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/search/admission.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/angle.h"
#include "base/robust.h"
#include "base/solve.h"
#include "diagnosis/conditions/gains.h"
#include "diagnosis/conditions/reference_zero.h"
#include "diagnosis/criteria.h"
#include "diagnosis/events/change_points.h"
#include "diagnosis/events/edges.h"
#include "diagnosis/events/step_shape.h"
#include "diagnosis/noise/along_and_across.h"
#include "diagnosis/search/candidates.h"
#include "diagnosis/search/identifiability.h"

namespace ada {

namespace {

/// How far the leak of VCOS into VTEMP is from what the model makes it, in standard errors.
double leak_left(const Observations &train, const Model &model) {
  if (train.vtemp_on_vcos_error <= 0.0)
    return 0.0;
  return (train.vtemp_on_vcos - vtemp_on_vcos(model)) / train.vtemp_on_vcos_error;
}

} // namespace

std::size_t coordinates(const EffectInstance &e) {
  return e.effect->to_coordinates(e.values).size();
}

std::optional<double> chosen(const EffectInstance &e, std::string_view name,
                             std::string_view unit) {
  const auto parameters = e.effect->info().parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (parameters[k].role == Role::chosen && parameters[k].name == name &&
        (unit.empty() || parameters[k].unit == unit))
      return e.values[k];
  return std::nullopt;
}

double penalty(const EffectInstance &e) {
  double nats = criteria::kNatsPerCoordinate * static_cast<double>(coordinates(e));
  for (const ParameterInfo &p : e.effect->info().parameters)
    if (p.role == Role::chosen && p.unit == "s")
      nats += criteria::kNatsPerMoment;
  return nats;
}

double least_of_noise(const Effect &effect) {
  for (const ParameterInfo &p : effect.info().parameters)
    if (p.name == "order" || p.name == "frequency_hz")
      return 2.5 * criteria::kLeastOfNoise;
  return criteria::kLeastOfNoise;
}

bool of_the_angle(const Effect &effect) {
  return is_static(effect) || effect.info().stage == Stage::motion;
}

EffectInstance absent(const Effect &effect) {
  EffectInstance out{&effect, {}, {}};
  for (const ParameterInfo &p : effect.info().parameters)
    out.values.push_back(p.role == Role::chosen ? p.fallback : 0.0);
  return out;
}

bool holds(const Model &model, const Effect *effect) {
  return std::any_of(model.effects.begin(), model.effects.end(),
                     [&](const EffectInstance &e) { return e.effect == effect; });
}

bool shapes_the_figure(const Effect &effect) {
  const Stage stage = effect.info().stage;
  return is_static(effect) && (stage == Stage::bridge || stage == Stage::chain);
}

bool shows_beyond_angle(const Effect &effect) {
  return effect.info().axis != axis_name(Axis::angle);
}

bool leaks(const EffectInstance &e) {
  return e.effect->vtemp_on_vcos(e.values) != 0.0;
}

bool leak_unexplained(const Observations &train, const Model &model) {
  return 0.5 * leak_left(train, model) * leak_left(train, model) > criteria::kLeastNats;
}

bool is_measured_aside(const Observations &train, const Model &model, std::size_t effect) {
  return leaks(model.effects[effect]) && leak_unexplained(train, model.without(effect)) &&
         !leak_unexplained(train, model);
}

std::vector<Ripple> unnamed_ripples(const Scene &scene, const Model &model) {
  std::vector<Ripple> left = scene.reference_ripples;
  for (const EffectInstance &e : model.effects) {
    const OrderRipple part = e.effect->reference_ripple(e.values);
    const auto n = static_cast<std::size_t>(std::clamp(part.order, 0.0, 1e6));
    if (part.order != static_cast<double>(n) || n == 0 || n > left.size())
      continue;
    left[n - 1].cos -= part.cos;
    left[n - 1].sin -= part.sin;
  }
  return left;
}

double side_evidence(const SearchData &data, const Model &model) {
  double sum = -0.5 * leak_left(data.train, model) * leak_left(data.train, model);
  // The reference's own error must show against a smooth motion, unless the motion ripples so.
  const std::vector<Ripple> left = unnamed_ripples(*data.scene, model);
  const auto squared = [](const Ripple &r) { return r.cos * r.cos + r.sin * r.sin; };
  // What a fit leaves of it counts by its part of the whole: the fit has errors of its own.
  for (std::size_t k = 0; k < left.size(); ++k) {
    const Ripple &seen = data.scene->reference_ripples[k];
    const double rest = squared(left[k]), whole = std::max(squared(seen), 1e-30);
    sum -= std::min(0.5 * rest / (seen.error * seen.error),
                    criteria::kCoincidence * std::min(1.0, rest / whole));
  }
  return sum;
}

double Search::contribution(const State &with, const State &less) const {
  return std::sqrt(std::max(0.0, less.heldout - with.heldout) /
                   (2.0 * static_cast<double>(data_.heldout.size())));
}

/// The same in volts as they are, however residuals are weighed.
double Search::volts_explained(const State &with, const State &less) const {
  if (data_.heldout.weight_along == 1.0)
    return contribution(with, less);
  Observations plain = data_.heldout;
  plain.weight_along = 1.0;
  const double fall = sum_of_squares(plain, less.judged) - sum_of_squares(plain, with.judged);
  return std::max(contribution(with, less),
                  std::sqrt(std::max(0.0, fall) / (2.0 * static_cast<double>(plain.size()))));
}

/// What each effect moves beyond the baseline's own freedom (offsets, amplitude and zero, and a
/// common delay where that is free), V^2: products of each with each, means of a channel.
Eigen::MatrixXd Search::own_moves(const Model &model) const {
  const auto n = static_cast<Eigen::Index>(model.effects.size());
  const ResidualColumns all = residual_columns(coarse_, model);
  const auto samples = static_cast<Eigen::Index>(coarse_.size());
  // Where the pair is its own reference, what lies along the circle is no evidence: neither here
  // nor in what there is to explain.
  const auto weigh = [&](Eigen::Index i, double &sin, double &cos) {
    const auto at = static_cast<std::size_t>(i);
    if (coarse_.disturbed == Direction::motion)
      coarse_.whiten(at, all.model_sin[at], all.model_cos[at], sin, cos);
  };
  // Where the zero angles, or an angle that is the pair's own, hold any common delay, the one that
  // the baseline has is no cause: what it could take is no evidence of another. Nor is what a zero
  // angle of each record could.
  const Capture &capture = *data_.scene->capture;
  const auto records =
      static_cast<Eigen::Index>(data_.scene->has_reference ? capture.starts.size() : 0);
  bool delay_is_free = false;
  Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(2 * samples, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const EffectInfo &info = model.effects[static_cast<std::size_t>(k)].effect->info();
    if (info.evidence != Evidence::signal ||
        is_measured_aside(data_.train, model,
                          static_cast<std::size_t>(k))) // it takes no part of another
      continue;
    if (k < static_cast<Eigen::Index>(given_) && is_common_delay(info) &&
        (data_.scene->lag_in_zeros || !data_.scene->has_reference)) {
      delay_is_free = true;
      continue;
    }
    const ResidualColumns rest =
        residuals_alone(coarse_, model.without(static_cast<std::size_t>(k)));
    for (Eigen::Index i = 0; i < samples; ++i) {
      const auto at = static_cast<std::size_t>(i);
      double sin = rest.sin[at] - all.sin[at], cos = rest.cos[at] - all.cos[at];
      weigh(i, sin, cos);
      moved.col(k).segment<2>(2 * i) << sin, cos;
    }
  }
  double fastest = 1e-12; // rad/s
  for (double w : coarse_.omega)
    fastest = std::max(fastest, std::abs(w));
  // At one speed each the zeros of the records hold a delay: a column of its own would be one too
  // many.
  delay_is_free = delay_is_free && records < 2;
  const Eigen::Index zeros = std::max<Eigen::Index>(records - 1, 0),
                     freedoms = 4 + zeros + delay_is_free;
  Eigen::MatrixXd free = Eigen::MatrixXd::Zero(2 * samples, freedoms);
  for (Eigen::Index i = 0; i < samples; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double y = all.model_sin[at] - coarse_.centre_sin_v;
    const double x = all.model_cos[at] - coarse_.centre_cos_v;
    free.row(2 * i).head<4>() << 1.0, 0.0, y, x;
    free.row(2 * i + 1).head<4>() << 0.0, 1.0, x, -y;
    if (delay_is_free) { // relative to the fastest: columns of one size
      const double turning = coarse_.omega[at] / fastest;
      free.block<2, 1>(2 * i, 4) << x * turning, -y * turning;
    }
    if (const auto record =
            zeros > 0 ? static_cast<Eigen::Index>(capture_at(capture, coarse_.time[at])) : 0;
        record > 0)
      free.block<2, 1>(2 * i, 3 + record) << x, -y;
    for (Eigen::Index k = 0; k < freedoms; ++k)
      weigh(i, free(2 * i, k), free(2 * i + 1, k));
  }
  const Eigen::MatrixXd onto = free.transpose() * moved;
  const Eigen::MatrixXd within = free.transpose() * free;
  return (moved.transpose() * moved - onto.transpose() * solved(within, onto)) /
         (2.0 * static_cast<double>(samples));
}

namespace {

/// Whether the effects of `group`, together with any others after `from`, do so much less than the
/// largest of them does alone that they cancel each other.
bool cancels(const Eigen::MatrixXd &own, Eigen::Index from, std::size_t members, double together,
             double largest, std::vector<Eigen::Index> &group) {
  constexpr std::size_t kMostMembers = 4;
  if (members >= 2 && together < criteria::kLeastOfGroup * criteria::kLeastOfGroup * largest)
    return true;
  for (Eigen::Index j = from; members < kMostMembers && j < own.rows(); ++j) {
    if (std::find(group.begin(), group.end(), j) != group.end())
      continue;
    double more = own(j, j);
    for (Eigen::Index k : group)
      more += 2.0 * own(j, k);
    group.push_back(j);
    const bool found =
        cancels(own, j + 1, members + 1, together + more, std::max(largest, own(j, j)), group);
    group.pop_back();
    if (found)
      return true;
  }
  return false;
}

} // namespace

/// Whether an effect stands by itself: it is no larger than what there is to explain, and no others
/// cancel it.
bool Search::stands_alone(const Eigen::MatrixXd &own, std::size_t effect) const {
  const auto k = static_cast<Eigen::Index>(effect);
  const double most = criteria::kMostOfDiscrepancy * discrepancy_v_;
  std::vector<Eigen::Index> group{k};
  return own(k, k) <= most * most && !cancels(own, 0, 1, own(k, k), own(k, k), group);
}

/// Whether lengths and zeros of the records' own could take all that an effect moves, and do so
/// better. They have as many numbers as they need, and the effect has a law: it is told from them
/// where its law leaves less than a tenth of what the lengths differ by.
bool Search::the_records_could(const State &state, std::size_t effect) const {
  const Model &model = state.fit.model;
  const Capture &joined = *data_.scene->capture;
  if (!data_.scene->lag_in_zeros || !held_by_records(joined, coarse_, model, effect))
    return false;
  return scatter_of_lengths(joined, coarse_, model) >
         criteria::kLawLeaves * scatter_of_lengths(joined, coarse_, model.without(effect));
}

bool Search::all_stand_alone(const Model &model) const {
  const Eigen::MatrixXd own = own_moves(model);
  for (std::size_t k = given_; k < model.effects.size(); ++k)
    if (!stands_alone(own, k))
      return false;
  return true;
}

/// Whether an effect stands beside those that look like it: none takes back what another does, and
/// each is clear of its error, which their likeness makes large.
bool Search::adds_up(const FitResult &fit, std::size_t effect) const {
  constexpr double kAlike = 0.9; // cosine of the angle between two moves
  const auto is_clear = [&](std::size_t k) {
    return errors_from_none(fit, k) > criteria::kClearErrors;
  };
  const Eigen::MatrixXd own = own_moves(fit.model);
  const auto at = static_cast<Eigen::Index>(effect);
  for (Eigen::Index k = 0; k < own.cols(); ++k) {
    const double both = std::sqrt(own(at, at) * own(k, k));
    if (k == at || !(std::abs(own(at, k)) > kAlike * both))
      continue;
    if (own(at, k) < 0.0 || !is_clear(static_cast<std::size_t>(k)))
      return false;
  }
  return is_clear(effect);
}

/// What an effect explains, V rms: no more than it moves, and where the evidence stands beside the
/// pair all of that.
double Search::size_of(const State &with, const State &less, std::size_t effect) const {
  const double moved = moved_rms_v(quick_, with.fit.model, effect);
  if (data_.train.coloured) // what it gains counts against what has no name, and not against noise
    return moved;
  if (leak_unexplained(data_.train, less.fit.model) &&
      (leaks(with.fit.model.effects[effect]) || !leak_unexplained(data_.train, with.fit.model)))
    return moved;
  return std::min(volts_explained(with, less), moved);
}

/// What an effect must explain beyond what is not known to second order, V rms: a coarse
/// converter's error is no noise, and looks like a little of many effects.
double Search::doubt_v(const Model &model) const {
  return std::max(second_order(*data_.scene, quick_, model) + next_of_supply(quick_, model),
                  criteria::kOfStep * data_.scene->coarse_step_v);
}

namespace {

/// Whether an effect has an order that no product of two others has: those of the catalogue reach
/// to kNamedPeriods electrical periods, each product to twice that, or as far about another order
/// and about twice that order.
bool above_products(const Model &model, std::size_t effect) {
  const double reach = criteria::kNamedPeriods * model.periods_per_turn;
  const auto order = chosen(model.effects[effect], "order", "per turn");
  if (!order || *order <= 2.0 * reach)
    return false;
  for (std::size_t k = 0; k < model.effects.size(); ++k)
    if (const auto other = chosen(model.effects[k], "order", "per turn");
        k != effect && other &&
        std::min(std::abs(*other - *order), std::abs(2.0 * *other - *order)) <= reach)
      return false;
  return true;
}

} // namespace

/// Whether a cause of the model explains more than `doubt` of the others. What is not known to
/// second order repeats with the angle, as what it is a product of does: of a cause that shows
/// beyond the angle, that part needs no allowance.
bool Search::beyond_doubt(double size_v, const Model &model, std::size_t effect,
                          double doubt) const {
  const Effect &e = *model.effects[effect].effect;
  const double step_v = reference_step_rad(data_.scene->screened) * model.periods_per_turn *
                        model.baseline.amplitude_v;
  const bool of_the_shaft = e.info().stage == Stage::motion || e.info().stage == Stage::field ||
                            e.reference_ripple(model.effects[effect].values).order > 0.0;
  // A line far above the pair's own orders, or between whole ones, and within the last count of
  // the reference is that count's own: at a steady speed the rounding comes back in every turn, or
  // beats with the readings.
  const auto order = chosen(model.effects[effect], "order", "per turn");
  const double count_v =
      data_.scene->reference_grid_rad * model.periods_per_turn * model.baseline.amplitude_v;
  const bool of_a_count =
      order && (*order > criteria::kNamedPeriods * model.periods_per_turn ||
                std::abs(*order - std::round(*order)) * data_.scene->turns > 1.0);
  if (of_the_shaft && of_a_count && 2.0 * size_v < 0.5 * count_v)
    return false;
  if (of_the_shaft &&
      2.0 * size_v < criteria::kOfReferenceStep * step_v) // an amplitude is twice a channel's rms
    return false;
  // What every pair has is no likeliest of many shapes that a coarse converter's error takes.
  if (e.info().prior_rank == 0)
    doubt =
        std::min(doubt, second_order(*data_.scene, quick_, model) + next_of_supply(quick_, model));
  if (size_v > doubt)
    return true;
  if (above_products(model, effect))
    return size_v >
           std::max(least_of_noise(e) * noise_v_, criteria::kOfStep * data_.scene->coarse_step_v);
  return shows_beyond_angle(e) && size_v > next_of_supply(quick_, model) &&
         std::min(size_v, moved_off_angle_v(model, effect)) > least_of_noise(e) * noise_v_;
}

/// What every pair has is expected: it need only be worth the freedom that it is fitted with, which
/// a pair without it gains by chance once in a thousand. Anything else is looked for among many.
bool Search::worth_keeping(double worth, const Effect &effect) const {
  return worth > (effect.info().prior_rank == 0 ? criteria::kExpectedNats : criteria::kLeastNats);
}

/// By how many nats an effect makes held-out data likelier. Where it stands out of what has no
/// name, whose variance is known from a few coefficients only, Student's distribution takes the
/// place of the normal, with the degrees of freedom of Welch and Satterthwaite (Biometrics 2, 1946,
/// p. 110) for the part of the variance that the samples' own noise gives. What every pair has is
/// no outlier, and what takes most of what has no name was its own yardstick.
double Search::against_unnamed(const State &with, const State &less, std::size_t effect) const {
  const double nats = with.score - less.score;
  const FitResult &fit = with.fit;
  const EffectInstance &e = fit.model.effects[effect];
  if (!data_.train.coloured || fit.unnamed_share.size() == 0 || !(nats > 0.0) ||
      e.effect->info().prior_rank == 0)
    return nats;
  auto at = static_cast<Eigen::Index>(coordinates_of(Model{}).size());
  for (std::size_t k = 0; k < effect; ++k)
    at += static_cast<Eigen::Index>(coordinates(fit.model.effects[k]));
  const auto n = static_cast<Eigen::Index>(coordinates(e));
  const double share = n > 0 ? fit.unnamed_share.segment(at, n).maxCoeff() : 0.0;
  if (!(share > 0.0))
    return nats;
  const auto unnamed = [&](const State &state) {
    return white_sum_of_squares(data_.heldout, state.judged) /
               (2.0 * static_cast<double>(data_.heldout.size())) -
           data_.train.coloured->rest_v2();
  };
  if (unnamed(with) < criteria::kOfRival * unnamed(less))
    return nats;
  const double freedom = data_.train.coloured->freedom() / (share * share);
  return 0.5 * (freedom + static_cast<double>(n)) * std::log1p(2.0 * nats / freedom);
}

/// An event acts along the vector and across it as it says, and takes away in each what it acts
/// there. What takes less than half of that in one of the two, by more than its noise, bends what
/// is in the other: an angle that errs for a while is no offset.
bool Search::helps_in_each_direction(const State &with, const State &less) const {
  if (!data_.scene->has_reference)
    return true; // the angle is the pair's own, or the motion's
  const Observations &data = data_.heldout;
  const ResidualColumns a = residual_columns(data, with.judged),
                        b = residual_columns(data, less.judged);
  ResidualColumns moved = a;
  for (std::size_t i = 0; i < data.size(); ++i) {
    moved.sin[i] = b.sin[i] - a.sin[i];
    moved.cos[i] = b.cos[i] - a.cos[i];
  }
  std::array<std::vector<double>, 2> left, by;
  along_and_across(data, a, left[0], left[1]);
  along_and_across(data, moved, by[0], by[1]);
  for (const std::size_t k : {0u, 1u}) {
    double acts = 0.0, takes = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < data.size(); ++i) {
      acts += by[k][i] * by[k][i];
      takes += by[k][i] * (by[k][i] + 2.0 * left[k][i]); // of the sum of squares
      squares += std::pow(by[k][i] * left[k][i], 2);
    }
    if (takes + criteria::kClearErrors * 2.0 * std::sqrt(squares) < 0.5 * acts)
      return false;
  }
  return true;
}

/// A filter, or a delay, of both channels makes neither worse: one that helps the one at the cost
/// of the other stands for what that one has alone, as a filter of its own.
bool Search::helps_both_channels(const State &with, const State &less, std::size_t effect) const {
  const EffectInfo &info = with.fit.model.effects[effect].effect->info();
  if (info.stage != Stage::chain || info.character != Character::dynamic)
    return true;
  const Observations &data = data_.heldout;
  const ResidualColumns a = residual_columns(data, with.judged),
                        b = residual_columns(data, less.judged);
  const double n = static_cast<double>(data.size());
  const double variance =
      std::max(white_sum_of_squares(data, with.judged) / (2.0 * n), criteria::kLeastMeanSquare);
  constexpr double kLengthTells = 0.5; // of which below this what lies along is the motion's
  constexpr double kAboutPeak = 0.75;  // within 30 degrees
  double of_sin = 0.0, of_cos = 0.0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    double as = a.sin[i], ac = a.cos[i], bs = b.sin[i], bc = b.cos[i];
    data.whiten(i, a.model_sin[i], a.model_cos[i], as, ac);
    data.whiten(i, b.model_sin[i], b.model_cos[i], bs, bc);
    if (data.disturbed == Direction::motion && data.weight_along < kLengthTells) {
      // The length about its peaks is a channel's own.
      const auto [along_s, along_c] = data.direction_at(i, b.model_sin[i], b.model_cos[i]);
      const double gain = bs * bs + bc * bc - as * as - ac * ac;
      of_sin += along_c * along_c > kAboutPeak ? gain : 0.0;
      of_cos += along_s * along_s > kAboutPeak ? gain : 0.0;
      continue;
    }
    of_sin += bs * bs - as * as;
    of_cos += bc * bc - ac * ac;
  }
  return 0.5 * std::min(of_sin, of_cos) / variance > -criteria::kRivalNats;
}

/// A true cause makes no part of the record worse: one that helps here at the cost of there stands
/// for something that comes and goes. Judged in stretches that each are worth so much that chance
/// makes none of them worse, and hold whole turns.
bool Search::helps_everywhere(const State &with, const State &less) const {
  const Observations &data = data_.heldout;
  const ResidualColumns a = residual_columns(data, with.judged),
                        b = residual_columns(data, less.judged);
  std::vector<double> gain(data.size());
  double left = 0.0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    double as = a.sin[i], ac = a.cos[i], bs = b.sin[i], bc = b.cos[i];
    data.whiten(i, a.model_sin[i], a.model_cos[i], as, ac);
    data.whiten(i, b.model_sin[i], b.model_cos[i], bs, bc);
    left += as * as + ac * ac;
    gain[i] = bs * bs + bc * bc - as * as - ac * ac;
  }
  const double n = static_cast<double>(data.size());
  const double nats = std::accumulate(gain.begin(), gain.end(), 0.0) * n /
                      std::max(left, criteria::kLeastMeanSquare * n);
  const double turns = n / static_cast<double>(std::max<std::size_t>(1, data_.scene->all.size())) *
                       data_.scene->turns;
  const auto stretches = static_cast<std::size_t>(
      std::max(0.0, std::min({criteria::kMostStretchesOfGain, nats / criteria::kNatsOfStretch,
                              turns / criteria::kTurnsOfStretch})));
  if (stretches < criteria::kFewestStretchesOfGain)
    return true;
  // What a reference rounds stays the same for as long as it counts no further: of a shaft that
  // rests all readings are one, and what each stretch is worth is known from so many only.
  const bool rounded = reference_step_rad(data_.scene->screened) > 0.0;
  std::vector<double> of_stretch(stretches, 0.0), squares(stretches, 0.0);
  for (std::size_t i = 0; i < data.size();) {
    const std::size_t stretch = i * stretches / data.size();
    double run = gain[i++];
    while (rounded && i < data.size() && data.alpha[i] == data.alpha[i - 1] &&
           i * stretches / data.size() == stretch)
      run += gain[i++];
    of_stretch[stretch] += run;
    squares[stretch] += rounded ? run * run : 0.0;
  }
  double better = 0.0, worse = 0.0;
  for (std::size_t k = 0; k < stretches; ++k)
    if (of_stretch[k] > 0.0)
      better += of_stretch[k];
    else
      worse += std::max(0.0, -of_stretch[k] - criteria::kHarmByChance * std::sqrt(squares[k]));
  return worse < criteria::kMostHarm * better;
}

/// What nobody knows of the residual, V rms of a channel: all but what is white. That differs
/// between neighbours in time as well as between neighbours in the turn as two independent values
/// do, however much it is: a reference or a sampling instant that scatters is known for noise.
/// Without a reference a motion that was followed badly may look like that as well, and what a
/// reference rounds to steps does: its lines are at any order.
double Search::unknown_v(const State &now) const {
  const double noise = std::max(noise_v_, data_.scene->white_noise_v);
  const auto beyond = [](double all_v2, double known_v2) {
    return std::sqrt(std::max(0.0, all_v2 - known_v2));
  };
  if (!data_.scene->has_reference || reference_step_rad(data_.scene->screened) > 0.0)
    return beyond(white_sum_of_squares(data_.train, now.fit.model) /
                      (2.0 * static_cast<double>(data_.train.size())),
                  noise * noise);
  ResidualColumns left = residual_columns(data_.train, now.fit.model);
  for (std::size_t i = 0; i < left.sin.size(); ++i)
    data_.train.whiten(i, left.model_sin[i], left.model_cos[i], left.sin[i], left.cos[i]);
  const double all_v2 = 0.5 * (mean_square(left.sin) + mean_square(left.cos));
  const auto between = [&](auto at) {
    double sum = 0.0;
    for (std::size_t i = 1; i < left.sin.size(); ++i)
      sum += std::pow(left.sin[at(i)] - left.sin[at(i - 1)], 2) +
             std::pow(left.cos[at(i)] - left.cos[at(i - 1)], 2);
    return 0.25 * sum / static_cast<double>(std::max<std::size_t>(1, left.sin.size() - 1));
  };
  if (by_place_.empty()) {
    by_place_.resize(data_.train.size());
    std::iota(by_place_.begin(), by_place_.end(), 0u);
    const auto place = [&](std::uint32_t i) { return wrap(data_.train.alpha[i], kTwoPi); };
    std::sort(by_place_.begin(), by_place_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
  }
  const double white_v2 = std::min(between([](std::size_t i) { return i; }),
                                   between([&](std::size_t i) { return by_place_[i]; }));
  return beyond(all_v2, std::max(noise * noise, white_v2));
}

/// What an effect moves beyond what repeats with the electrical angle, V rms of a channel.
double Search::moved_off_angle_v(const Model &model, std::size_t effect) const {
  const Model less = model.without(effect);
  const ResidualColumns with = residual_columns(coarse_, model),
                        without = residual_columns(coarse_, less);
  const auto n = static_cast<Eigen::Index>(coarse_.size());
  Eigen::MatrixXd angle(n, 2 * criteria::kNamedPeriods + 1), moved(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    moved.row(i) << without.sin[at] - with.sin[at], without.cos[at] - with.cos[at];
    angle(i, 0) = 1.0;
    for (int order = 1; order <= criteria::kNamedPeriods; ++order) {
      const double phase = order * model.periods_per_turn * coarse_.alpha[at];
      angle(i, 2 * order - 1) = std::cos(phase);
      angle(i, 2 * order) = std::sin(phase);
    }
  }
  moved -= angle * solved(angle.transpose() * angle, angle.transpose() * moved);
  return std::sqrt(moved.squaredNorm() / (2.0 * static_cast<double>(n)));
}

/// Whether a cause is more than the likeliest of many shapes takes of an unknown structure. What
/// repeats with the angle has no shape by chance that changes with the speed, say, so that beyond
/// the angle a cause need stand out only of what is unknown there.
bool Search::stands_out(const State &now, std::size_t effect, double size_v) const {
  const Model &model = now.fit.model;
  // Beside what has no name a cause with a law of its own is held against that in the likelihood,
  // with the variance that it has at the cause's own orders: unknown is what that leaves as well. A
  // signature has no law, and is one shape of many.
  const double unknown =
      data_.train.coloured && !model.effects[effect].effect->info().signature
          ? std::sqrt(
                std::max(0.0, data_.train.coloured->rest_v2() -
                                  std::pow(std::max(noise_v_, data_.scene->white_noise_v), 2)))
          : unknown_v(now);
  if (size_v > criteria::kOfUnknown * unknown)
    return true;
  return unnamed_.angle_v2 > 0.0 && shows_beyond_angle(*model.effects[effect].effect) &&
         moved_off_angle_v(model, effect) > criteria::kOfUnknown * std::sqrt(unnamed_.elsewhere_v2);
}

/// Causes that cancel each other are the shape of something else, unless with them nothing is left
/// but noise: a skew may well undo most of a quadrature error at the usual speed.
bool Search::leaves_noise(const State &now) const {
  return unknown_v(now) < criteria::kOfUnknown * std::max(noise_v_, data_.scene->white_noise_v);
}

std::vector<std::size_t> Search::cancelled(const Model &now) {
  measure_discrepancy();
  State state;
  state.fit.model = now;
  std::vector<std::size_t> out;
  if (leaves_noise(state))
    return out;
  const Eigen::MatrixXd own = own_moves(now);
  for (std::size_t k = now.effects.size(); k-- > given_;)
    if (!stands_alone(own, k))
      out.push_back(k);
  std::stable_sort(out.begin(), out.end(), [&](std::size_t a, std::size_t b) {
    return now.effects[a].effect->info().prior_rank > now.effects[b].effect->info().prior_rank;
  });
  return out;
}

/// Of two events at one moment the second is the shape of the first, unless it is another kind of
/// event and no small part of it: where a magnet is glued anew the offsets move as well.
bool Search::is_shape_of_event(const Model &model, std::size_t effect) const {
  const EffectInstance &e = model.effects[effect];
  if (!has_moment(*e.effect))
    return false;
  const double period_s = median_step(data_.scene->capture->time_s);
  for (std::size_t k = 0; k < effect; ++k) {
    const EffectInstance &first = model.effects[k];
    if (has_moment(*first.effect) && std::abs(first.values[0] - e.values[0]) < 2.0 * period_s &&
        (first.effect == e.effect ||
         moved_rms_v(quick_, model, effect) < criteria::kOfUnknown * moved_rms_v(quick_, model, k)))
      return true;
  }
  return false;
}

/// Whether what seems to come with the time may be of the angle, or of the reference: the shaft
/// came round too seldom to tell. An event then has an edge, or leaves nothing but noise beside it;
/// a reference that counts in coarse steps has lines at any order, as a tone has.
bool Search::may_not_be_of_time(const State &state, std::size_t effect) const {
  const Model &model = state.fit.model;
  const Scene &scene = *data_.scene;
  const EffectInstance &e = model.effects[effect];
  if (!scene.has_reference || scene.rounds(1.0) >= criteria::kFewestTurnsToRepeat)
    return false;
  if (!has_moment(*e.effect)) {
    const auto line = e.effect->one_line(e.values);
    return line && line->per == OneLine::Per::second && reference_step_rad(scene.screened) > 0.0;
  }
  if (leaves_noise(state))
    return false;
  const ResidualColumns rest = residual_columns(quick_, model.without(effect));
  const std::size_t reach =
      reach_of_edges(quick_.size(), scene.rounds(1.0), model.periods_per_turn);
  const auto edges =
      find_edges(quick_.time, rest.sin, rest.cos, quick_.direction, reach, criteria::kMostSteps);
  return std::none_of(edges.begin(), edges.end(), [&](const Edge &edge) {
    return quick_.time[edge.at - reach] <= e.values[0] &&
           e.values[0] <= quick_.time[edge.at + reach - 1];
  });
}

/// Whether what was measured rules an effect out as it was fitted.
bool Search::refuted(const State &state, std::size_t effect) const {
  return refuted(state, effect, effect + 1);
}

/// The same of any from one place to before another.
bool Search::refuted(const State &state, std::size_t from, std::size_t to,
                     bool told_from_speed) const {
  const Model &model = state.fit.model;
  const ResidualColumns columns = residual_columns(quick_, model);
  Residual view = residual_view(*data_.scene, quick_, columns, data_.scene->white_noise_v,
                                model.baseline.amplitude_v);
  for (std::size_t k = from; k < to; ++k) {
    const EffectInstance &e = model.effects[k];
    ResidualColumns without;
    if (e.effect->info().spoils == Spoils::peaks)
      without = residual_columns(quick_, model.without(k));
    view.without_sin_v = without.model_sin;
    view.without_cos_v = without.model_cos;
    const Observations &all = data_.scene->all;
    if ((has_moment(*e.effect) && !begins_at_once(*data_.scene, model, k, told_from_speed)) ||
        e.effect->refuted(e.values, view) ||
        (data_.scene->has_reference && e.effect->refuted_by_motion(e.values, all.time, all.alpha)))
      return true;
  }
  return false;
}

/// A signature describes one term of what repeats with the angle. It is worth a name of its own
/// while it holds more than all the terms smaller than it together.
bool Search::dominates(double size_v, std::size_t effect, const Model &model) const {
  if (unnamed_.angle_v2 <= 0.0)
    return true;
  double larger = 0.0, smaller = 0.0;
  for (std::size_t k = 0; k < model.effects.size(); ++k)
    if (k != effect && model.effects[k].effect->info().signature) {
      const double other = moved_rms_v(quick_, model, k);
      (other > size_v ? larger : smaller) += other * other;
    }
  // Two bounds: of what was unnamed without signatures, and of what the model leaves over. Beside
  // large ones a difference of squares says little.
  const double left =
      white_sum_of_squares(quick_, model) / (2.0 * static_cast<double>(quick_.size())) -
      data_.scene->white_noise_v * data_.scene->white_noise_v;
  const double rest = std::min(unnamed_.angle_v2 - size_v * size_v - larger, left + smaller);
  return size_v * size_v > rest;
}

} // namespace ada

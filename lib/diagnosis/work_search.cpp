// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/work.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "base/angle.h"
#include "base/robust.h"
#include "base/solve.h"
#include "diagnosis/anonymous/beside_anonymous.h"
#include "diagnosis/conditions/jumps_aside.h"
#include "diagnosis/conditions/reference_zero.h"
#include "diagnosis/conditions/uneven_motion.h"
#include "diagnosis/conditions/unseen_supply.h"
#include "diagnosis/criteria.h"
#include "diagnosis/events/change_points.h"
#include "diagnosis/events/step_shape.h"
#include "diagnosis/naming/naming.h"
#include "diagnosis/noise/along_and_across.h"
#include "diagnosis/search/admission.h"
#include "diagnosis/search/first_model.h"
#include "motion/surroundings.h"

namespace ada {

bool Work::zeros_moved() {
  return move_zeros(scene_, worked_on(), found_.fit.model, std::max(noise_, found_.residual_rms_v));
}

Scene Work::scene_of(const Capture &capture, bool needs_split) const {
  if (baseline() && !capture.has_reference()) {
    const Model known = baseline()->at_supply(capture.meta.supply_v);
    if (Scene scene = prepare(capture, needs_split, &known, vdd_level_v());
        scene.insufficient.empty())
      return scene;
  }
  return prepare(capture, needs_split, nullptr, vdd_level_v());
}

std::optional<double> Work::vdd_level_v() const {
  if (!given_.has_vdd())
    return std::nullopt;
  if (named_before_ && named_before_->vdd_reference_v)
    return named_before_->vdd_reference_v;
  return SupplyOverTime(given_).mean_v;
}

bool Work::free_vtemp() {
  if (!scene_.has_reference || given_.has_vdd() || !scene_.why_no_temperature.empty() ||
      found_.disturbed != Direction::supply)
    return false;
  auto freed = with_free_vtemp(worked_on(), scene_, found_.fit.model);
  if (!freed)
    return false;
  freed_ = std::move(freed);
  scene_ = prepare(*freed_, options_.heldout == nullptr);
  scene_.reference_errs = options_.reference_errs;
  return true;
}

Search Work::search(const Model &start) {
  return Search({&scene_, scene_.all.select(thin(scene_.train, criteria::kSearchTrain)),
                 options_.heldout
                     ? judge_->all
                     : scene_.all.select(thin(scene_.heldout, criteria::kSearchHeldout)),
                 &judge()},
                start, noise_, options_.progress);
}

void Work::search_causes() {
  choose_parts();
  const Model start = first_model(scene_, baseline());
  // Without a reference the angle is the pair's own, lag and all: a common delay is free.
  // So it is where each of several captures has its own zero angle and one speed.
  const bool own = scene_.has_reference ? scene_.lag_in_zeros : !scene_.radius_only;
  free_lag_ =
      own && (scene_.several_speeds || scene_.both_directions) && !has(start, is_common_delay);
  const auto is_slip = [](const EffectInfo &e) { return is_jump(e) && e.stage == Stage::motion; };
  std::vector<EffectInstance> jumps;
  if (scene_.has_reference)
    for (const JumpAside &jump : jumps_aside(scene_.all, scene_.periods))
      jumps.push_back({&the_effect(is_slip), {jump.time_s, jump.by_rad * kDegPerRad}, {}});
  found_ = search(found_baseline()).run(false, nullptr, {}, jumps);
  // They take each other back: without one of them the others say nothing.
  const auto held = std::ranges::count_if(
      found_.fit.model.effects, [&](const EffectInstance &e) { return is_slip(e.effect->info()); });
  if (held < std::ssize(jumps))
    found_ = search(found_baseline()).run(false);
}

void Work::search_further() {
  const Model start = found_baseline();
  const Model physical = found_.fit.model;
  const Unnamed unnamed =
      unnamed_beside(scene_, split_, physical, anonymous_of(scene_, split_, physical), noise_);
  // What is left over is looked at against what has no name: second thoughts come there.
  found_ = search(start).run(false, &physical, unnamed);
  if (!anonymous_of(scene_, split_, found_.fit.model).any()) {
    const Model known = found_.fit.model;
    found_ = search(start).run(true, &known, unnamed);
  }
}

void Work::search_thoroughly() {
  search_causes();
  search_further();
}

bool Work::offsets_moved() const {
  constexpr double kMuch = 0.75; // of the sum of squares stays with offsets of its own
  if (!judge_)
    return false;
  Observations own = split_.heldout;
  own.own_offsets = true;
  const Model &model = found_.fit.model;
  return sum_of_squares(own, as_seen_by(own, model)) <
         kMuch * sum_of_squares(split_.heldout, as_seen_by(split_.heldout, model));
}

void Work::report_moved_offsets() {
  if (!judge_ || !judge_->all.own_offsets)
    return;
  const Baseline &first = out_.extended.baseline;
  const Baseline second = as_seen_by(split_.heldout, out_.extended).baseline;
  const double sin = second.offset_sin_v - first.offset_sin_v;
  const double cos = second.offset_cos_v - first.offset_cos_v;
  out_.structure.push_back(
      {"time",
       fmt::format("between the two captures the offsets move by {:+.3g} mV (VSIN) and {:+.3g} "
                   "mV (VCOS); the second is judged with its own",
                   1e3 * sin, 1e3 * cos),
       std::hypot(sin, cos) / std::sqrt(2.0)});
}

Model Work::found_baseline() const {
  Model out = first_model(scene_, baseline());
  if (free_lag_)
    out.effects.push_back({&the_effect(is_common_delay), {0.0}, {}});
  return out;
}

bool Work::name_what_the_length_shows() {
  if (!scene_.has_reference || found_.disturbed != Direction::none || nested_.by_direction)
    return false;
  const std::size_t before = found_.fit.model.effects.size();
  const auto more = with_what_the_length_shows(split_, found_.fit.model);
  if (!more)
    return false;
  found_.fit = fit(split_.train, *more, 12);
  for (std::size_t k = before; k < found_.fit.model.effects.size(); ++k) {
    found_.order.push_back(k);
    found_.contribution.push_back(0.0); // of what the reference makes of it
    found_.alternatives.emplace_back();
  }
  return true;
}

bool Work::needed_by_all(std::size_t place) const {
  const Model less = fit(split_.train, found_.fit.model.without(found_.order[place]), 6).model;
  if (!nested_.by_direction)
    return makes_worse(nested_.last.heldout, split_.quality(less).heldout);
  const std::optional<FitResult> apart = fit_by_direction(split_, less); // like with like
  return !apart || makes_worse(nested_.last.heldout, split_.quality(apart->model).heldout);
}

bool Work::makes_worse(const Quality &before, const Quality &after) const {
  // A figure that the direction alone has told makes the length no likelier.
  if (nested_.by_direction)
    return after.angle_error_rms_deg.value() >
           criteria::kNoWorse * before.angle_error_rms_deg.value();
  return (before.log_likelihood - after.log_likelihood) *
             static_cast<double>(split_.heldout.size()) >
         criteria::kRivalNats;
}

bool Work::leaves_its_own(const Finding &f) const {
  const double more_v2 = std::pow(f.after.heldout.residual_rms_v, 2) -
                         std::pow(f.before.heldout.residual_rms_v, 2);
  const auto &effects = nested_.extended.effects;
  const auto there = std::find_if(effects.begin(), effects.end(),
                                  [&](const EffectInstance &e) { return e.effect == f.effect; });
  return !(more_v2 > 0.0) || there == effects.end() ||
         more_v2 <= std::pow(moved_rms_v(split_.heldout, nested_.extended,
                                         static_cast<std::size_t>(there - effects.begin())),
                             2);
}

bool Work::drop_what_harms() {
  const Quality &first = nested_.first.heldout, &last = nested_.last.heldout;
  // The length is no witness of a figure that the direction alone tells.
  const bool likelier = nested_.by_direction || last.log_likelihood >= first.log_likelihood;
  const bool closer = !last.angle_error_rms_deg ||
                      *last.angle_error_rms_deg <= criteria::kNoWorse * *first.angle_error_rms_deg;
  const bool whole_harms = !likelier || !closer;
  // What every pair has is fitted beside what has no name, which takes a part of it back: it may
  // leave more by itself, if its size is known, and no more than it moves: what is more than that
  // other numbers have done. Any other cause has to make held-out data likelier.
  // Jumps that take each other back harm until the last of them is there.
  const auto is_one_of_several = [&](std::size_t i) {
    const Effect *effect = nested_.findings[i].effect;
    return has_moment(*effect) &&
           std::ranges::count(nested_.findings, effect, &Finding::effect) > 1 && needed_by_all(i);
  };
  std::size_t worst = nested_.findings.size();
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < nested_.findings.size(); ++i) {
    const Finding &f = nested_.findings[i];
    const Quality &before = f.before.heldout, &after = f.after.heldout;
    const double less = before.log_likelihood - after.log_likelihood;
    const bool by_angle = nested_.by_direction || (whole_harms && likelier);
    const double harm = by_angle ? *after.angle_error_rms_deg - *before.angle_error_rms_deg : less;
    const bool may_leave_more = f.effect->info().prior_rank == 0 &&
                                nested_.clearness[i].as_said >= 1.0 && leaves_its_own(f);
    // A fit that is judged by the likelihood and not by the angle: any other cause that leaves
    // held-out data less likely was of what the others have taken since.
    const bool in_vain = f.effect->info().prior_rank != 0 && !nested_.by_direction && less > 0.0;
    const bool by_itself = !may_leave_more && (in_vain || makes_worse(before, after)) &&
                           !is_measured_aside(split_.train, found_.fit.model, found_.order[i]) &&
                           !is_one_of_several(i);
    if ((whole_harms || by_itself) && harm > most) {
      most = harm;
      worst = i;
    }
  }
  if (worst == nested_.findings.size())
    return false;
  // What is named after it may be what it has to stand on.
  if (!whole_harms && worst + 1 < found_.order.size() && needed_by_all(worst) &&
      named_last_.insert(nested_.findings[worst].effect).second)
    found_.name_last(worst);
  else
    found_.forget(worst);
  return true;
}

bool Work::drop_what_is_impossible() {
  const auto &f = nested_.findings;
  const auto impossible = std::find_if(f.begin(), f.end(), [](const Finding &of) {
    return !in_range({of.effect, of.values, {}});
  });
  if (impossible == f.end())
    return false;
  found_.forget(static_cast<std::size_t>(impossible - f.begin()));
  return true;
}

bool Work::drop_what_is_cancelled() {
  for (std::size_t effect : search(found_baseline()).cancelled(nested_.extended)) {
    const auto place = std::find(found_.order.begin(), found_.order.end(), effect);
    if (place == found_.order.end())
      continue;
    found_.forget(static_cast<std::size_t>(place - found_.order.begin()));
    return true;
  }
  return false;
}

bool Work::drop_slips_within_a_step() {
  const double step_deg = reference_step_rad() * kDegPerRad;
  for (std::size_t place = 0; place < found_.order.size(); ++place) {
    const EffectInstance &e = found_.fit.model.effects[found_.order[place]];
    const auto parameters = e.effect->info().parameters;
    if (!has_moment(*e.effect) || e.effect->info().pattern != Pattern::turn)
      continue;
    for (std::size_t k = 0; k < parameters.size(); ++k)
      if (parameters[k].unit == "deg" && std::abs(e.values[k]) < step_deg) {
        found_.forget(place);
        return true;
      }
  }
  return false;
}

bool Work::drop_what_comes_in_slowly() {
  for (std::size_t place = 0; place < found_.order.size(); ++place) {
    const std::size_t at = found_.order[place];
    if (!has_moment(*found_.fit.model.effects[at].effect) ||
        !comes_in_slowly(scene_, found_.fit.model, at))
      continue;
    found_.forget(place);
    return true;
  }
  return false;
}

double Work::lengthens(const Model &model, double order) const {
  const Observations &data = split_.heldout;
  const ResidualColumns left = residual_columns(data, as_seen_by(data, model));
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double s = left.model_sin[i] - data.centre_sin_v,
                 c = left.model_cos[i] - data.centre_cos_v;
    const double along = (left.sin[i] * s + left.cos[i] * c) / std::hypot(s, c);
    const Eigen::Vector3d row(1.0, std::cos(order * data.alpha[i]),
                              std::sin(order * data.alpha[i]));
    normal += row * row.transpose();
    right += along * row;
  }
  const Eigen::Vector3d x = solved(normal, right);
  return std::hypot(x[1], x[2]);
}

bool Work::drop_turns_that_lengthen() {
  for (std::size_t place = 0; place < found_.order.size(); ++place) {
    const EffectInstance &e = found_.fit.model.effects[found_.order[place]];
    const auto order = chosen(e, "order", "per turn");
    if (!order || e.effect->info().pattern != Pattern::turn ||
        std::abs(*order - std::round(*order)) * scene_.turns < 1.0)
      continue;
    const Model &model = found_.fit.model;
    // Once a slow process of the gain is taken out, the length no longer shows it.
    const bool known = std::any_of(lengthening_.begin(), lengthening_.end(), [&](double other) {
      return std::abs(*order - other) * scene_.turns < 1.0;
    });
    // V along a circle, of which each channel has half the power.
    const double turns_v = 2.0 * moved_rms_v(split_.heldout, model, found_.order[place]);
    if (!known && lengthens(model, *order) < criteria::kAsMuchAlong * turns_v)
      continue;
    lengthening_.push_back(*order);
    found_.forget(place);
    return true;
  }
  return false;
}

namespace {

/// The order of the turn at which a cause turns the vector to and fro, where it does no more than
/// that: of the shaft's own ripple and of the field's errors the one that was chosen, of those of
/// the field that have none the largest. What a shaft does by chance looks like either.
std::optional<int> ripple_order(const Observations &all, const Model &model, std::size_t effect) {
  constexpr std::size_t kHighest = 4; // of a field's error without an order of its own: 1 and 2
  constexpr double kNearlyAll = 0.9;  // of what it does
  constexpr std::size_t kEnough = 20000;
  const EffectInstance &e = model.effects[effect];
  const Stage stage = e.effect->info().stage;
  if (stage != Stage::motion && stage != Stage::field)
    return std::nullopt;
  if (const auto order = chosen(e, "order", "per turn"))
    return *order == std::round(*order) ? std::optional(static_cast<int>(*order)) : std::nullopt;
  if (stage == Stage::motion)
    return std::nullopt;
  std::vector<std::uint32_t> some(all.size());
  std::iota(some.begin(), some.end(), 0u);
  const Observations data = all.select(thin(some, kEnough));
  const ResidualColumns with = residual_columns(data, model);
  ResidualColumns moved = residual_columns(data, model.without(effect));
  for (std::size_t i = 0; i < data.size(); ++i) {
    moved.sin[i] -= with.sin[i];
    moved.cos[i] -= with.cos[i];
  }
  std::vector<double> along, across;
  along_and_across(data, moved, along, across);
  // Each sample by the way that it stands for: a shaft that rests says little of an order.
  std::array<std::complex<double>, kHighest> at{};
  double whole = 0.0, power = 0.0;
  for (std::size_t i = 1; i < data.size(); ++i) {
    const double way = std::abs(data.alpha[i] - data.alpha[i - 1]);
    whole += way;
    power += way * (across[i] * across[i] + along[i] * along[i]);
    for (std::size_t k = 0; k < kHighest; ++k)
      at[k] += way * across[i] * std::polar(1.0, -static_cast<double>(k + 1) * data.alpha[i]);
  }
  const auto largest = std::max_element(at.begin(), at.end(), [](const auto &a, const auto &b) {
    return std::norm(a) < std::norm(b);
  });
  if (2.0 * std::norm(*largest) < kNearlyAll * power * whole)
    return std::nullopt;
  return static_cast<int>(largest - at.begin()) + 1;
}

} // namespace

bool Work::drop_ripples_by_chance() {
  if (scene_.has_reference || scene_.radius_only)
    return false;
  const Observations &data = scene_.all;
  const Model &model = found_.fit.model;
  for (std::size_t place = 0; place < found_.order.size(); ++place) {
    const auto order = ripple_order(data, model, found_.order[place]);
    if (!order)
      continue;
    const ResidualColumns rest = residual_columns(data, model.without(found_.order[place]));
    std::vector<double> along, across;
    along_and_across(data, rest, along, across);
    Kinematics motion;
    motion.alpha = data.alpha;
    motion.omega.assign(data.omega.begin(), data.omega.end());
    motion.direction.assign(data.direction.begin(), data.direction.end());
    for (std::size_t i = 0; i < data.size(); ++i)
      across[i] =
          data.alpha[i] +
          across[i] / (scene_.periods * std::max(std::hypot(rest.model_sin[i] - data.centre_sin_v,
                                                            rest.model_cos[i] - data.centre_cos_v),
                                                 1e-12));
    const std::vector<char> all(data.size(), 1);
    const bool falls = model.effects[found_.order[place]].effect->info().stage == Stage::motion;
    if (!differs_from_turn_to_turn(motion, across, all, *order, falls))
      continue;
    found_.forget(place);
    return true;
  }
  return false;
}

namespace {

/// What is left along the vector to what is left across it, in the middle: a few spikes are in
/// either.
double along_to_across(const Observations &data, const Model &model) {
  std::vector<double> along, across;
  const Observations some = thinned(data);
  along_and_across(some, residual_columns(some, model), along, across);
  for (std::vector<double> *of : {&along, &across})
    for (double &v : *of)
      v = std::abs(v);
  return quantile(std::move(along), 0.5) / quantile(std::move(across), 0.5);
}

} // namespace

bool Work::drop_what_the_length_denies() {
  const Model &model = found_.fit.model;
  std::vector<std::size_t> places;
  for (std::size_t place = 0; place < found_.order.size(); ++place) {
    const std::size_t at = found_.order[place];
    const Effect &effect = *model.effects[at].effect;
    if (effect.info().prior_rank > 0 && shapes_the_figure(effect) &&
        !is_measured_aside(split_.train, model, at))
      places.push_back(place);
  }
  if (places.empty())
    return false;
  if (!scene_.has_reference) {
    for (const std::size_t place : places)
      if (const Model less = fit(split_.train, model.without(found_.order[place]), 5).model;
          nats_between(ada::radius_left(split_.heldout, less),
                       ada::radius_left(split_.heldout, model)) <= criteria::kRivalNats) {
        found_.forget(place);
        return true;
      }
    return false;
  }
  // Beside a reference that says little the length is the witness of what shapes the figure: what
  // is none by it was made of what the reference errs by.
  if (split_.train.disturbed != Direction::none)
    return false;
  Model bare = model; // with what has a name of the reference's errors
  std::vector<std::size_t> shapes;
  for (const std::size_t place : places)
    shapes.push_back(found_.order[place]);
  std::ranges::sort(shapes, std::greater{});
  for (const std::size_t at : shapes)
    bare = bare.without(at);
  const double ratio = along_to_across(split_.train, fit(split_.train, bare, 5).model);
  if (!(ratio < criteria::kMuchLessAcross))
    return false;
  const std::vector<Clearness> clear = clear_by_length(split_, model, ratio);
  for (auto place = places.rbegin(); place != places.rend(); ++place)
    if (const std::size_t at = found_.order[*place];
        at < clear.size() && clear[at].own < criteria::kClear) {
      found_.forget(*place);
      return true;
    }
  return false;
}

std::optional<Work::Line> Work::line_of(const EffectInstance &e) const {
  const auto parameters = e.effect->info().parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    if (!is_place(parameters[k]) || scene_.all.time.empty())
      continue;
    if (parameters[k].unit == "per turn")
      return Line{Line::of_angle, e.values[k] * scene_.turns,
                  e.values[k] == std::round(e.values[k])};
    if (parameters[k].unit == "Hz")
      return Line{Line::of_time, e.values[k] * (scene_.all.time.back() - scene_.all.time.front()),
                  false};
  }
  return std::nullopt;
}

bool Work::drop_lines_that_stand_together() {
  const Model &model = found_.fit.model;
  for (std::size_t place = 0; place < found_.order.size(); ++place) {
    const auto line = line_of(model.effects[found_.order[place]]);
    if (!line)
      continue;
    std::vector<std::size_t> together;
    double sum = 0.0, most = 0.0, widest = 0.0;
    std::size_t strongest = place;
    for (std::size_t other = 0; other < found_.order.size(); ++other) {
      const std::size_t at = found_.order[other];
      const auto beside = line_of(model.effects[at]);
      if (!beside || beside->axis != line->axis)
        continue;
      // Whole orders are what comes with every turn, and not the sides of a line that changes.
      if (other != place && line->axis == Line::of_angle && line->whole && beside->whole)
        continue;
      const double apart = std::abs(beside->periods - line->periods);
      if (other != place && (apart < criteria::kOneLine || apart > criteria::kTwoLines))
        continue;
      together.push_back(other);
      widest = std::max(widest, apart);
      const double v2 = std::pow(moved_rms_v(split_.heldout, model, at), 2);
      sum += v2;
      if (v2 > most) {
        most = v2;
        strongest = other;
      }
    }
    if (together.size() < 2)
      continue;
    // A tone that wanders is still one: of its lines the strongest stands for it.
    const bool steady =
        most > criteria::kMostlySteady * sum ||
        (line->axis == Line::of_time && widest < criteria::kSameTone * line->periods);
    for (auto other = together.rbegin(); other != together.rend(); ++other)
      if (!steady || *other != strongest)
        found_.forget(*other);
    return true;
  }
  return false;
}

bool Work::drop_what_is_unclear() {
  std::vector<std::size_t> places(nested_.clearness.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  std::sort(places.begin(), places.end(),
            [&](auto a, auto b) { return nested_.clearness[a].own < nested_.clearness[b].own; });
  for (const std::size_t place : places) {
    const Clearness &clear = nested_.clearness[place];
    // With what else there may be its size is not known, and nothing that it could be instead is:
    // what has no name says as much.
    const Finding &f = nested_.findings[place];
    const bool of_unknown_size =
        f.effect->info().prior_rank != 0 && clear.as_said < 1.0 && f.alternatives.empty();
    if (clear.beyond_chance >= criteria::kClear && !of_unknown_size)
      continue;
    if (clear.own >= criteria::kUnclear && !of_unknown_size) {
      const Taken takes = taken(scene_, split_, found_.fit.model, found_.order[place]);
      if (takes.most && (clear.beyond_chance >= criteria::kUnclear ||
                         takes.of_left > criteria::kMoreThanChanceTakes))
        continue;
    }
    found_.forget(place);
    return true;
  }
  return false;
}

bool Work::has(const Model &model, bool (*is)(const EffectInfo &)) {
  return std::any_of(model.effects.begin(), model.effects.end(),
                     [&](const EffectInstance &e) { return is(e.effect->info()); });
}

} // namespace ada

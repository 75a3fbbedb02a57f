// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/work.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/pick.h"
#include "diagnosis/conditions/gains.h"
#include "diagnosis/criteria.h"
#include "diagnosis/events/change_points.h"
#include "diagnosis/noise/beside_process.h"
#include "diagnosis/noise/random_causes.h"
#include "diagnosis/residual/few_rows.h"
#include "model/wires.h"

namespace ada {

bool Work::take_out_processes() {
  // In less than two turns a magnet whose poles differ, as all do, and what wanders are one.
  if (scene_.periods > 2 && scene_.rounds(1.0) < criteria::kFewestTurnsToRepeat)
    return false;
  if (found_.disturbed == Direction::supply) // what goes on slowly along it is the supply's
    return false;
  const Uncoloured uncoloured(split_);
  const DataSplit &white = uncoloured.split();
  // What is carried without a name is a part of what the anonymous model holds.
  Model named = out_.extended;
  named.remainder.reset();
  // A slow process goes along with speed and temperature by chance. It is named where it alone
  // explains most of what changes with any of them, unless the speed or the temperature alone does
  // so as well: what wanders is not expected to follow their few functions.
  Anonymous slow = anonymous_of(scene_, white, named, {.speed = false, .others = false});
  const double whole =
      slow.from.heldout(slow.from.heldout.rows() - 1, slow.from.heldout.rows() - 1) /
      slow.from.n_heldout;
  if (slow.selection.noise_v2 - unnamed_.selection.noise_v2 >=
      criteria::kLittle * (whole - unnamed_.selection.noise_v2))
    return false;
  std::vector<RandomCause> found =
      slow_causes(slow, white, named, periods_in_all(), reference_step_rad() > 0.0);
  std::erase_if(found, [&](const RandomCause &c) { return goes_on(c); });
  if (found.empty() || goes_with_a_condition(slow, whole, white, named))
    return false;
  // The largest alone: what it hid may be no process, as a step that a course of the same pattern
  // would take in.
  const RandomCause largest = *std::ranges::max_element(found, {}, &RandomCause::slow_v2);
  const int waves = slow.selection.orders[static_cast<std::size_t>(Axis::time)];
  if (const auto shape = shape_of(largest, waves)) {
    const Named before = named_now();
    const std::size_t known = processes_.size();
    take_for(largest, *shape);
    const bool more = take_out_processes(); // then the process is another one
    if (processes_.size() > known)
      return more;
    take_again(before); // and where there is none then, it was a cause
  }
  if (!take_out_courses(std::move(slow), {largest}))
    return false;
  slow_waves_ = std::max(slow_waves_, waves);
  processes_.push_back(largest);
  return largest.slow_v2 > unnamed_.selection.noise_v2;
}

Work::Named Work::named_now() const {
  return {found_, nested_, out_, unnamed_, split_, first_, last_, named_, noise_, shapes_};
}

void Work::take_again(const Named &named) {
  found_ = named.found;
  nested_ = named.nested;
  out_ = named.out;
  unnamed_ = named.unnamed;
  split_ = named.split;
  first_ = named.first;
  last_ = named.last;
  named_ = named.named;
  noise_ = named.noise_v;
  shapes_ = named.shapes;
}

Observations Work::over_the_record() const {
  constexpr std::size_t kEnough = 20000; // for how slow things go
  std::vector<std::uint32_t> some(scene_.all.size());
  std::iota(some.begin(), some.end(), 0u);
  return scene_.all.select(thin(some, kEnough, 1));
}

std::optional<std::size_t> Work::shape_of(const RandomCause &process, int waves) const {
  const Observations data = over_the_record();
  const Pattern pattern = process.effect->info().pattern;
  for (std::size_t place = 0; place < found_.order.size(); ++place) {
    const std::size_t at = found_.order[place];
    const std::vector<double> errors =
        errors_beside(data, out_.extended, at, process, std::max(1, waves));
    if (has_moment(*out_.extended.effects[at].effect) ||
        std::ranges::none_of(errors, [](double e) { return e > 0.0; }))
      continue;
    const Model less = fit(split_.train, out_.extended.without(at), 5).model;
    if (!(nats_over_walk(data, out_.extended, less, pattern) > criteria::kAdmittedNats))
      return place;
  }
  return std::nullopt;
}

void Work::take_for(const RandomCause &process, std::size_t shape) {
  shapes_.emplace_back(process.effect, out_.extended.effects[found_.order[shape]].effect);
  found_.forget(shape);
  take(nested_models(scene_, split_, found_));
  judge_model();
}

bool Work::goes_on(const RandomCause &c) const {
  return std::any_of(processes_.begin(), processes_.end(),
                     [&](const RandomCause &old) { return old.effect == c.effect; });
}

void Work::take_out_rest_of_courses() {
  if (processes_.empty())
    return;
  const Uncoloured uncoloured(split_);
  const DataSplit &white = uncoloured.split();
  Model named = out_.extended;
  named.remainder.reset();
  Anonymous slow = anonymous_of(scene_, white, named, {.speed = false, .others = false});
  std::vector<RandomCause> rest =
      slow_causes(slow, white, named, periods_in_all(), reference_step_rad() > 0.0);
  std::erase_if(rest, [&](const RandomCause &c) { return !goes_on(c); });
  if (!rest.empty())
    take_out_courses(std::move(slow), rest);
}

bool Work::drop_steps_of_processes(const std::vector<RandomCause> &noise) {
  for (std::size_t place = 0; place < found_.order.size(); ++place) {
    const Effect &step = *found_.fit.model.effects[found_.order[place]].effect;
    if (!has_moment(step))
      continue;
    double left_v2 = 0.0;
    for (const RandomCause &process : processes_)
      if (process.effect->info().pattern == step.info().pattern)
        left_v2 += beyond_course_v2(process.effect->info(), process.values);
    for (const RandomCause &cause : noise) // none of its course was taken out
      if (is_coloured_noise(cause.effect->info()) &&
          cause.effect->info().pattern == step.info().pattern)
        left_v2 += std::pow(cause.values[0], 2);
    if (found_.contribution[place] < criteria::kOfProcess * std::sqrt(left_v2)) {
      found_.forget(place);
      return true;
    }
  }
  return false;
}

std::vector<RandomCause> Work::read_noise() const {
  const Uncoloured uncoloured(split_);
  Model named = out_.extended;
  named.remainder.reset();
  const double stated = !noise_stated_ ? 0.0
                        : named_before_ && named_before_->noise_rms_v
                            ? std::max(noise_, *named_before_->noise_rms_v)
                            : noise_;
  return noise_causes(unnamed_, uncoloured.split(), named,
                      {stated, std::max(reference_step_rad(), scene_.reference_grid_rad),
                       share_of_lines_across(scene_, out_.extended), &scene_.all, even_clock()});
}

void Work::name_random_causes() {
  // A converter's steps are no noise.
  const bool reads_noise = !supply_is_inferred() && scene_.coarse_step_v <= 0.0;
  look_for_reference_steps();
  const std::vector<double> &t = scene_.all.time;
  const auto noise_now = [&] { return reads_noise ? read_noise() : std::vector<RandomCause>{}; };
  std::vector<RandomCause> noise = noise_now();
  while (drop_steps_of_processes(noise)) {
    take(nested_models(scene_, split_, found_));
    judge_model();
    noise = noise_now();
  }
  leave_to_flicker(processes_, noise, slow_waves_, t.back() - t.front());
  for (const std::vector<RandomCause> *causes : {&processes_, &noise})
    for (const RandomCause &c : *causes)
      name_process(c);
  widen_beside_processes();
  if (!reads_noise)
    return;
  // Without a reference the motion has taken in what lies along the circle.
  const double left = std::max(std::sqrt(unnamed_.selection.noise_v2),
                               scene_.has_reference ? 0.0 : out_.noise.along_v);
  if (!random_.empty() || !noise.empty())
    explained_noise_ = std::max(noise_, left);
}

void Work::widen_beside_processes() {
  if (processes_.empty())
    return;
  const Observations data = over_the_record();
  for (const RandomCause &process : processes_) {
    std::vector<std::vector<double>> errors;
    int slow = 0; // causes that take of it
    for (std::size_t k = 0; k < out_.extended.effects.size(); ++k) {
      errors.push_back(errors_beside(data, out_.extended, k, process, std::max(1, slow_waves_)));
      slow += std::ranges::any_of(errors.back(), [](double e) { return e > 0.0; });
    }
    const double more = std::sqrt(more_of_walk(slow));
    // Of what they may have taken, all or nothing, each as likely: half to either side.
    widen_process(*process.effect, 0.5 * (more - 1.0));
    for (std::size_t k = 0; k < errors.size(); ++k) {
      for (double &e : errors[k])
        e *= more;
      widen(out_.extended.effects[k], errors[k], *process.effect);
    }
  }
}

void Work::widen_process(const Effect &process, double taken) {
  const auto wider = [&](auto &named) {
    for (auto &one : named)
      if (one.effect == &process)
        for (std::size_t p = 0; p < one.std_errors.size(); ++p)
          one.std_errors[p] = std::hypot(one.std_errors[p], taken * one.values[p]);
  };
  wider(random_);
  wider(recorded_);
  for (Finding &f : random_)
    if (f.effect == &process)
      put_in_words(f);
}

void Work::widen(EffectInstance &cause, const std::vector<double> &errors, const Effect &process) {
  for (Finding &f : nested_.findings) {
    if (f.effect != cause.effect || f.values != cause.values)
      continue;
    bool untold = false, clear = false;
    for (std::size_t p = 0; p < f.std_errors.size(); ++p) {
      f.std_errors[p] = std::hypot(f.std_errors[p], errors[p]);
      (std::abs(f.values[p]) > criteria::kClearErrors * f.std_errors[p] ? clear : untold) |=
          errors[p] > 0.0;
    }
    const std::string id(process.info().id);
    if (untold && !clear && std::ranges::find(f.alternatives, id) == f.alternatives.end())
      f.alternatives.push_back(id);
    put_in_words(f);
  }
  for (std::size_t p = 0; p < cause.std_errors.size(); ++p)
    cause.std_errors[p] = std::hypot(cause.std_errors[p], errors[p]);
}

bool Work::goes_with_a_condition(const Anonymous &slow, double whole_v2, const DataSplit &white,
                                 const Model &named) const {
  const double of_slow = whole_v2 - slow.selection.noise_v2;
  const auto explained_by = [&](Asked asked) {
    asked.over_time = false;
    return anonymous_of(scene_, white, named, asked).selection.noise_v2 - slow.selection.noise_v2 <
           criteria::kNearlyAll * of_slow;
  };
  return ((scene_.several_speeds || scene_.both_directions) && explained_by({.others = false})) ||
         (scene_.why_no_temperature.empty() && explained_by({.speed = false}));
}

bool Work::even_clock() const {
  const std::vector<double> &t = scene_.all.time;
  const double mean = (t.back() - t.front()) / static_cast<double>(t.size());
  return t.size() >= criteria::kFewestForLines && !scene_.stops &&
         mean < criteria::kUneven * scene_.all.frame_period_s;
}

void Work::name_process(const RandomCause &c) {
  // What the functions of a larger process leave of it is faster, and passes for noise.
  double larger_v2 = 0.0;
  for (const RandomCause &other : processes_)
    larger_v2 = std::max(larger_v2, other.slow_v2);
  if (c.effect->info().evidence == Evidence::noise && c.slow_v2 > 0.0 &&
      c.slow_v2 < criteria::kLittle * larger_v2)
    return;
  seen_random_.push_back({c.effect, c.values, c.std_errors});
  if (given(c.effect))
    return;
  std::vector<std::string> alternatives = c.alternatives;
  for (const auto &[process, shape] : shapes_) // but for what a later search has named after all
    if (const std::string id(shape->info().id);
        process == c.effect && std::ranges::find(alternatives, id) == alternatives.end() &&
        std::ranges::none_of(nested_.findings, [&](const Finding &f) { return f.effect == shape; }))
      alternatives.push_back(id);
  SplitQuality before = last_;
  const double samples = static_cast<double>(std::max<std::size_t>(1, split_.heldout.size()));
  before.heldout.log_likelihood = last_.heldout.log_likelihood - c.nats / samples;
  random_.push_back(
      recorded({c.effect, c.values, c.std_errors, alternatives, {}, {}, before, last_, false}));
}

bool Work::take_out_courses(Anonymous slow, const std::vector<RandomCause> &processes) {
  const double before_v2 = left_v2(split_, out_.extended);
  const double goes_on_v2 = slow.selection.share_v2[static_cast<std::size_t>(Axis::time)];
  const Outputs as_they_were(*this);
  Anonymous unnamed = std::exchange(unnamed_, std::move(slow));
  const auto courses_of = [&](Pattern pattern) {
    Selection out;
    std::vector<double> values;
    if (std::any_of(processes.begin(), processes.end(),
                    [&](const RandomCause &c) { return c.effect->info().pattern == pattern; }))
      for (std::size_t k = 0; k < unnamed_.selection.columns.size(); ++k)
        if (is_course_of(unnamed_, unnamed_.selection.columns[k], pattern)) {
          out.columns.push_back(unnamed_.selection.columns[k]);
          values.push_back(unnamed_.selection.values[static_cast<Eigen::Index>(k)]);
        }
    out.values =
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    return out;
  };
  const Selection offsets = courses_of(Pattern::offset), gain = courses_of(Pattern::gain);
  const Baseline &b = out_.extended.baseline;
  const auto [sin_v, cos_v] = recorded_centre_v(out_.extended);
  for (Observations *data : all_data()) {
    if (judge_ && data == &split_.heldout)
      continue;
    ResidualColumns pair, turning;
    pair.sin = as_doubles(data->vsin);
    pair.cos = as_doubles(data->vcos);
    subtract(unnamed_.basis, offsets, *data, pair);
    turning.sin.assign(data->size(), 0.0);
    turning.cos = turning.sin;
    subtract(unnamed_.basis, gain, *data, turning);
    for (std::size_t i = 0; i < data->size(); ++i) {
      const double s = pair.sin[i] - sin_v, c = pair.cos[i] - cos_v;
      // What the gain adds lies along the vector that it was read off.
      const double more = std::hypot(turning.sin[i], turning.cos[i]);
      const double sign = s * turning.sin[i] + c * turning.cos[i] > 0.0 ? -1.0 : 1.0;
      const double by = std::max(1.0 + sign * more / b.amplitude_v, criteria::kLeastGain);
      data->vsin[i] = as_float(sin_v + s / by);
      data->vcos[i] = as_float(cos_v + c / by);
    }
  }
  if (before_v2 - left_v2(split_, out_.extended) < criteria::kOfCourse * goes_on_v2) {
    as_they_were.put_back(*this);
    unnamed_ = std::move(unnamed);
    return false;
  }
  look_anew();
  return true;
}

void Work::look_anew() {
  split_.courses_taken_out = true;
  const Uncoloured uncoloured(split_);
  const DataSplit &white = uncoloured.split();
  Model named = out_.extended;
  named.remainder.reset();
  unnamed_ = anonymous_of(scene_, white, named);
  name_in_budget();
  out_.noise = noise_shape(unnamed_, white, named);
  last_ = white.quality(out_.extended);
}

bool Work::take_out_record_gains() {
  const auto share = [&](Axis axis) {
    return std::max(0.0, unnamed_.selection.share_v2[static_cast<std::size_t>(axis)]);
  };
  const double goes_on_v2 = share(Axis::time) + share(Axis::speed);
  if (worked_on().starts.size() < 2 || judge_ || found_.disturbed == Direction::supply ||
      goes_on_v2 < unnamed_.selection.noise_v2)
    return false;
  const double before_v2 = left_v2(split_, out_.extended);
  const Outputs as_they_were(*this);
  const StretchGains gains(starts_of_records_s(worked_on()), scene_, out_.extended);
  for (Observations *data : all_data())
    for (std::size_t i = 0; i < data->size(); ++i)
      gains.take_out(data->time[i], data->vsin[i], data->vcos[i]);
  const Model alike = fit(split_.train, gains.common(), 5).model;
  const double after_v2 = left_v2(split_, alike);
  if (before_v2 - after_v2 < criteria::kOfCourse * goes_on_v2 || after_v2 > goes_on_v2) {
    as_they_were.put_back(*this);
    return false;
  }
  const double samples = static_cast<double>(split_.heldout.size());
  const double nats =
      samples * std::log(before_v2 / std::max(after_v2, criteria::kLeastMeanSquare));
  look_anew();
  processes_.push_back(gains.as_cause(nats, before_v2 - after_v2));
  return true;
}

bool Work::take_out_step_at_the_reversal() {
  const auto back_s = turns_back_once_s(scene_.all);
  const double by_direction_v2 = unnamed_.selection.share_v2[static_cast<std::size_t>(Axis::speed)];
  if (!back_s || !scene_.has_reference || judge_ || !processes_.empty() || reversal_ ||
      worked_on().starts.size() > 1 || found_.disturbed != Direction::none ||
      scene_.several_speeds || by_direction_v2 < unnamed_.selection.noise_v2)
    return false;
  const double before_v2 = left_v2(split_, out_.extended);
  const Outputs as_they_were(*this);
  const StretchGains gains({scene_.all.time.front(), *back_s}, scene_, out_.extended);
  for (Observations *data : all_data())
    for (std::size_t i = 0; i < data->size(); ++i)
      gains.take_out_with_centre(data->time[i], data->vsin[i], data->vcos[i]);
  const Uncoloured uncoloured(split_);
  const DataSplit &white = uncoloured.split();
  const double moved_v2 = before_v2 - left_v2(white, fit(white.train, gains.common(), 12).model);
  if (moved_v2 < unnamed_.selection.noise_v2) { // beside which it hides nothing
    as_they_were.put_back(*this);
    return false;
  }
  const auto &own = gains.own();
  reversal_ = {*back_s, own[1].gain / own[0].gain - 1.0, own[1].sin_v - own[0].sin_v,
               own[1].cos_v - own[0].cos_v, std::sqrt(moved_v2)};
  look_anew();
  return true;
}

void Work::name_in_budget() {
  for (BudgetLine &line : out_.budget) {
    if (line.axis == Axis::noise) {
      line.rms_v = line.unnamed_rms_v = std::sqrt(unnamed_.selection.noise_v2);
      continue;
    }
    double left = std::max(0.0, unnamed_.selection.share_v2[static_cast<std::size_t>(line.axis)]);
    if (reversal_ && line.axis == Axis::speed) // taken out, and without a name
      left += reversal_->moved_v * reversal_->moved_v;
    line.unnamed_rms_v = std::min(line.rms_v, std::sqrt(left));
    line.named_rms_v =
        std::sqrt(std::max(0.0, line.rms_v * line.rms_v - line.unnamed_rms_v * line.unnamed_rms_v));
  }
}

} // namespace ada

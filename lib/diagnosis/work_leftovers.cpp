// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/work.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "base/angle.h"
#include "diagnosis/criteria.h"
#include "diagnosis/noise/along_and_across.h"
#include "diagnosis/residual/repetition.h"
#include "diagnosis/search/admission.h"
#include "diagnosis/words/describe.h"

namespace ada {

namespace {

/// Takes out what is only known to go on from row to row, where most of its power is told with what
/// it goes, or something else goes on in time as well.
void drop_what_others_tell(std::vector<Structure> &structure, const Structure &goes_on) {
  double told_v2 = 0.0;
  bool in_time = false;
  for (const Structure &s : structure)
    if (s.description != goes_on.description) {
      told_v2 += s.rms_v * s.rms_v;
      in_time = in_time || s.along == axis_name(Axis::time);
    }
  if (in_time || told_v2 > 0.5 * goes_on.rms_v * goes_on.rms_v)
    std::erase_if(structure,
                  [&](const Structure &s) { return s.description == goes_on.description; });
}

} // namespace

void Work::look_at_leftovers() {
  const Explained explained{explained_noise_ > 0.0 ? explained_noise_ : noise_,
                            second_order_floor(out_.extended, found_), noise_stated_,
                            supply_is_inferred(),
                            unnamed_.selection.orders[static_cast<std::size_t>(Axis::angle)]};
  note_unnamed();
  note_what_stands_out();
  LeftOver left = left_over(scene_, split_, out_.extended, explained, last_, angle_left_);
  const Structure of_few_rows = left.of_few_rows ? left.structure.front() : Structure{};
  std::move(left.structure.begin(), left.structure.end(), std::back_inserter(out_.structure));
  drop_what_is_random();
  // Nothing new where more is known of what goes on.
  if (left.of_few_rows)
    drop_what_others_tell(out_.structure, of_few_rows);
  std::move(left.of_rows.begin(), left.of_rows.end(), std::back_inserter(out_.structure));
  note_what_the_anonymous_model_does_better();
  note_what_is_not_sure();
  std::stable_sort(out_.structure.begin(), out_.structure.end(),
                   [](const Structure &a, const Structure &b) { return a.rms_v > b.rms_v; });
  double unnamed2 = left.unexplained_rms_v * left.unexplained_rms_v;
  for (const BudgetLine &line : out_.budget)
    if (line.axis != Axis::noise)
      unnamed2 += line.unnamed_rms_v * line.unnamed_rms_v;
  out_.unexplained_rms_v = std::sqrt(unnamed2);
  in_bursts_ = left.bursts;
}

void Work::note_what_the_anonymous_model_does_better() {
  // Of a rounding the anonymous model has what comes again.
  const double named2 = std::pow(last_.heldout.residual_rms_v, 2) - std::pow(random_v(), 2) +
                        rounding_that_does_not_come_again_v2();
  const double anonymous2 = std::pow(out_.anonymous.residual_rms_v, 2);
  // Where the motion is read off the pair the anonymous model takes a part of it.
  const bool of_motion = !scene_.has_reference && !scene_.radius_only;
  if (!out_.structure.empty() || supply_is_inferred() || of_motion || !(anonymous2 > 0.0) ||
      named2 < criteria::kMoreVariance * anonymous2 ||
      static_cast<double>(split_.heldout.size()) * std::log(named2 / anonymous2) <
          criteria::kNatsOfNoise)
    return;
  const double left_v = std::sqrt(named2 - anonymous2);
  out_.structure.push_back(
      {std::string(axis_name(Axis::time)),
       fmt::format("the best model that names nothing takes out {:.3g} mV rms more of held-out "
                   "data, and no named cause accounts for them",
                   1e3 * left_v),
       left_v});
}

double Work::channel_rms_v() const {
  return std::abs(out_.extended.baseline.amplitude_v) / std::numbers::sqrt2;
}

double Work::process_v(const EffectInfo &info, const std::vector<double> &values) const {
  return info.pattern == Pattern::gain ? values[0] * channel_rms_v()
                                       : std::max(values[0], values[1]);
}

double Work::beyond_course_v2(const EffectInfo &info, const std::vector<double> &values) const {
  return std::pow(process_v(info, values), 2) / std::max(1, slow_waves_);
}

double Work::random_v(bool in_time, bool turning) const {
  const double waves = std::max(1, slow_waves_);
  const double alike = in_time ? 1.0 : crosstalk(periods_in_all(), waves) / criteria::kLittle;
  double sum = 0.0;
  for (const EffectInstance &e : seen_random_) {
    const EffectInfo &info = e.effect->info();
    if (turning && info.pattern == Pattern::gain)
      continue;
    if (is_coloured_noise(info))
      sum += e.values[0] * e.values[0];        // what else is left over is not its own
    else if (info.evidence != Evidence::noise) // white noise has no structure of its own
      sum += beyond_course_v2(info, e.values) * alike;
  }
  sum += rounding_v2();
  // Steps that no noise blurs err by the place, and so with whatever the place goes with.
  sum += std::pow(scene_.coarse_step_v, 2) / 12.0;
  // A supply that is only inferred is weighed down to the noise along one of two directions, and
  // goes with whatever changes as slowly as it does.
  if (found_.disturbed == Direction::supply)
    sum += 0.5 * unnamed_.selection.noise_v2;
  return std::sqrt(sum);
}

double Work::rounding_v2() const {
  return std::pow(reference_step_rad() * scene_.periods * channel_rms_v(), 2) / 12.0;
}

double Work::rounding_that_does_not_come_again_v2() const {
  const double step = reference_step_rad();
  if (!(step > 0.0))
    return 0.0;
  if (rounding_that_does_not_come_again_v2_)
    return *rounding_that_does_not_come_again_v2_;
  const NotNamed left = not_named();
  const Observations data = at_own_angle(left.data, out_.extended);
  ResidualColumns rest = residual_columns(data, out_.extended);
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double rounding = step * std::round(data.alpha[i] / step) - data.alpha[i];
    rest.sin[i] = scene_.periods * rounding * (rest.model_cos[i] - data.centre_cos_v);
    rest.cos[i] = -scene_.periods * rounding * (rest.model_sin[i] - data.centre_sin_v);
  }
  const auto again = repeats(left.data, rest);
  const double v2 = again ? rounding_v2() - std::clamp(again->v2, 0.0, rounding_v2()) : 0.0;
  rounding_that_does_not_come_again_v2_ = v2;
  return v2;
}

bool Work::is_coloured_noise(const EffectInfo &info) {
  return info.evidence == Evidence::noise && info.character == Character::process;
}

bool Work::is_white(const EffectInfo &info) {
  return info.evidence == Evidence::noise && info.character != Character::process;
}

double Work::white_v() const {
  const bool any = std::any_of(seen_random_.begin(), seen_random_.end(), is_white_noise);
  const double left = last_.heldout.residual_rms_v;
  return any ? std::sqrt(std::max(0.0, left * left - noise_ * noise_)) : 0.0;
}

double Work::motion_v() const {
  if (scene_.has_reference || scene_.radius_only)
    return 0.0;
  const NoiseShape &n = out_.noise;
  return std::sqrt(0.5 * std::max(0.0, n.across_v * n.across_v - n.along_v * n.along_v));
}

void Work::drop_what_is_random() {
  const double accounted = std::hypot(random_v(), white_v());
  const bool noise_only = white_v() > 0.0;
  const auto too_much = [&](const Structure &s) {
    return (s.along == "angle" || s.along == "frequency") &&
           s.rms_v > criteria::kOfRandom * accounted;
  };
  // Noise of both channels is told by what is fast in it, whatever else is left.
  const auto by_what_is_left = [](const auto &named) {
    const EffectInfo &info = named.effect->info();
    return is_white(info) && info.pattern != Pattern::offset;
  };
  if (noise_only && std::any_of(out_.structure.begin(), out_.structure.end(), too_much)) {
    std::erase_if(recorded_, by_what_is_left);
    std::erase_if(random_, by_what_is_left);
    std::erase_if(seen_random_, by_what_is_left);
  }
  drop_processes_that_leave_more();
  const std::optional<Structure> turns = what_turns_the_vector();
  std::erase_if(out_.structure, [&](const Structure &s) {
    const bool in_time = s.along == axis_name(Axis::time) || s.along == axis_name(Axis::frequency);
    const double rounding_v2 = s.comes_again ? rounding_that_does_not_come_again_v2() : 0.0;
    return s.rms_v < criteria::kOfProcess *
                         std::sqrt(std::max(0.0, std::pow(random_v(in_time), 2) - rounding_v2));
  });
  if (turns && out_.structure.empty())
    out_.structure.push_back(*turns);
}

std::optional<Structure> Work::what_turns_the_vector() const {
  const bool gain = std::any_of(processes_.begin(), processes_.end(), [](const RandomCause &c) {
    return c.effect->info().pattern == Pattern::gain;
  });
  if (!gain || !scene_.has_reference)
    return std::nullopt;
  std::vector<double> along, across;
  along_and_across(scene_.all, residual_columns(scene_.all, out_.extended), along, across);
  double squares = 0.0, products = 0.0; // of neighbours, in which white noise vanishes
  for (std::size_t i = 1; i < across.size(); ++i) {
    squares += across[i] * across[i];
    products += across[i] * across[i - 1];
  }
  const double n = static_cast<double>(std::max<std::size_t>(2, across.size()) - 1);
  const double v2 = products / n, error_v2 = squares / n / std::sqrt(n);
  const double of_channel_v = std::sqrt(0.5 * std::max(0.0, v2));
  if (v2 < criteria::kClearErrors * error_v2 || of_channel_v < criteria::kWorthAWord * floor() ||
      of_channel_v < criteria::kOfProcess * random_v(true, true))
    return std::nullopt;
  return Structure{std::string(axis_name(Axis::time)),
                   fmt::format("{:.3g} mV rms turn the vector and go on from row to row, which no "
                               "gain does: no named cause explains them",
                               1e3 * of_channel_v),
                   of_channel_v};
}

void Work::drop_processes_that_leave_more() {
  const auto leaves_more = [&](const auto &named) {
    const EffectInfo &info = named.effect->info();
    if (info.character != Character::process)
      return false;
    const double v = is_coloured_noise(info) ? named.values[0] : process_v(info, named.values);
    return std::any_of(out_.structure.begin(), out_.structure.end(), [&](const Structure &s) {
      return s.along == axis_name(Axis::time) && s.rms_v > std::numbers::sqrt2 * v;
    });
  };
  if (!std::any_of(seen_random_.begin(), seen_random_.end(), leaves_more))
    return;
  std::erase_if(recorded_, leaves_more);
  std::erase_if(random_, leaves_more);
  std::erase_if(seen_random_, leaves_more);
  for (BudgetLine &line : out_.budget)
    if (line.axis == Axis::time)
      line.unnamed_rms_v =
          std::exchange(line.named_rms_v, 0.0) > 0.0 ? line.rms_v : line.unnamed_rms_v;
}

double Work::reference_step_rad() const {
  return ada::reference_step_rad(scene_.screened);
}

void Work::look_for_reference_steps() {
  if (!scene_.has_reference || reference_step_rad() > 0.0 ||
      goes_on_evenly(worked_on().reference_deg))
    return;
  constexpr std::size_t kEnough = 4000; // for how the counts are spread
  std::vector<std::uint32_t> some(scene_.all.size());
  std::iota(some.begin(), some.end(), 0u);
  some = thin(some, kEnough, 100);
  const Observations data = scene_.all.select(some);
  const ResidualColumns rest = residual_columns(data, out_.extended);
  std::vector<double> along, across, reference_deg;
  along_and_across(data, rest, along, across);
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double radius =
        std::hypot(rest.model_sin[i] - data.centre_sin_v, rest.model_cos[i] - data.centre_cos_v);
    across[i] /= std::max(radius, 1e-12) * scene_.periods;
    reference_deg.push_back(worked_on().reference_deg[scene_.index[some[i]]]);
  }
  const double noise_rad =
      std::sqrt(mean_square(along)) / (out_.extended.baseline.amplitude_v * scene_.periods);
  const double step = counted_step(reference_deg, across, noise_rad);
  if (!(step > 0.0))
    return;
  for (const Effect *effect : catalogue())
    if (effect->info().parameters.size() == 1 &&
        effect->reference_step_rad(std::vector{step}) > 0.0)
      scene_.screened.push_back({effect, {step}, {0.0}, {}, {}});
}

Work::NotNamed Work::not_named() const {
  constexpr std::size_t kEnough = 200000, kRun = 2000; // of a long capture more tell no more
  Model named = out_.extended;
  named.remainder.reset(); // it is what has no name
  std::vector<std::uint32_t> some(scene_.all.size());
  std::iota(some.begin(), some.end(), 0u);
  NotNamed out{scene_.all.select(thin(some, kEnough, kRun)), {}, {}};
  if (scene_.radius_only)
    out.data = at_own_angle(std::move(out.data), named);
  out.rest = residuals_alone(out.data, named);
  out.of_the_angle = scene_.radius_only
                         ? out.rest
                         : of_the_angle_alone(unnamed_, out.data, out_.extended, out.rest);
  return out;
}

std::optional<Repeated> Work::repeats(const Observations &data, const ResidualColumns &rest) const {
  constexpr double kCellsOfWave = 4.0;
  const double turn = in_turns(scene_) ? kTwoPi : kTwoPi / scene_.periods;
  const int highest = std::max(1, unnamed_.selection.orders[static_cast<std::size_t>(Axis::angle)]);
  return repeated_v2(data, rest, turn, turn / (kCellsOfWave * highest));
}

Recurrence Work::recurrence(const NotNamed &left, double rms_v) const {
  constexpr double kErrors = 2.0, kSure = 2.5;
  const auto seen = repeats(left.data, left.of_the_angle);
  if (!seen)
    return Recurrence::once;
  if (seen->v2 > kSure * seen->error_v2)
    return Recurrence::seen;
  return seen->v2 + kErrors * seen->error_v2 < rms_v * rms_v ? Recurrence::none
                                                             : Recurrence::untold;
}

bool Work::comes_again_in_part(const NotNamed &left, double rms_v) const {
  constexpr double kWorthSaying = 0.1; // of its power
  const auto seen = repeats(left.data, left.of_the_angle);
  return seen && seen->v2 > seen->error_v2 && seen->v2 > kWorthSaying * rms_v * rms_v;
}

void Work::note_unnamed() {
  const double noise = std::sqrt(unnamed_.selection.noise_v2);
  const double steps_v2 = std::max(0.0, unnamed_.selection.steps_v2);
  for (Structure &step : unnamed_steps(unnamed_, out_.extended))
    if (step.rms_v > criteria::kWorthAWord * noise)
      out_.structure.push_back(std::move(step));
  if (reversal_)
    out_.structure.push_back(
        {std::string(axis_name(Axis::speed)),
         fmt::format("{:.3g} mV rms are a step at {:.4g} s, where the shaft turns back: the centre "
                     "moves by {:+.3g} mV (VSIN) and {:+.3g} mV (VCOS), the length by {:+.2g} %; "
                     "the causes were looked for beside it, and none explains it",
                     1e3 * reversal_->moved_v, reversal_->time_s, 1e3 * reversal_->sin_v,
                     1e3 * reversal_->cos_v, 100.0 * reversal_->gain),
         reversal_->moved_v});
  const double least = std::max(criteria::kWorthAWord * noise, criteria::kOfProcess * motion_v());
  for (BudgetLine line : out_.budget) {
    // How a supply that is only inferred goes with the time is its own affair, also where at one of
    // the speeds it comes again at the same place.
    if (found_.disturbed == Direction::supply &&
        (line.axis == Axis::time || line.axis == Axis::frequency ||
         (line.axis == Axis::angle && remainder_in_part_)))
      continue;
    if (reversal_ && line.axis == Axis::speed) // as has the step at the reversal
      line.unnamed_rms_v = std::sqrt(std::max(0.0, line.unnamed_rms_v * line.unnamed_rms_v -
                                                       reversal_->moved_v * reversal_->moved_v));
    if (line.axis == Axis::time) // the steps have sentences of their own
      line.unnamed_rms_v =
          std::sqrt(std::max(0.0, line.unnamed_rms_v * line.unnamed_rms_v - steps_v2));
    NotNamed left;
    Recurrence again = Recurrence::seen;
    if (line.axis == Axis::angle && line.unnamed_rms_v > least) {
      left = not_named();
      again = remainder_in_part_ ? Recurrence::none : recurrence(left, line.unnamed_rms_v);
    }
    if (again == Recurrence::none) {
      const double left_v = std::max(line.unnamed_rms_v, goes_on_v(left.rest));
      out_.structure.push_back(
          {std::string(axis_name(Axis::time)),
           fmt::format("{:.3g} mV rms go on from row to row and do not{} come again at the same "
                       "place, and no named cause explains them",
                       1e3 * left_v, comes_again_in_part(left, left_v) ? " all" : ""),
           left_v});
      continue;
    }
    const char *whose = line.axis == Axis::angle && remainder_of_reference_
                            ? ": the reference ripples so against even time and the pair does "
                              "not, so unless this pair regulates the shaft they are the "
                              "reference's, and they are not corrected"
                            : "";
    if (line.axis != Axis::noise && line.unnamed_rms_v > least)
      out_.structure.push_back({std::string(axis_name(line.axis)),
                                unnamed_sentence(line, unnamed_.selection, scene_, again) + whose,
                                line.unnamed_rms_v,
                                line.axis == Axis::angle && again == Recurrence::seen});
  }
}

void Work::note_what_is_not_sure() {
  for (std::size_t k = 0; k < nested_.findings.size(); ++k) {
    const Finding &f = nested_.findings[k];
    const auto &effects = out_.extended.effects;
    const auto there = std::find_if(effects.begin(), effects.end(), [&](const EffectInstance &e) {
      return e.effect == f.effect && e.values == f.values;
    });
    if (nested_.clearness[k].as_said >= 1.0 || !f.alternatives.empty() || there == effects.end())
      continue;
    const double takes_v =
        moved_rms_v(scene_.all, out_.extended, static_cast<std::size_t>(there - effects.begin()));
    out_.structure.push_back(
        {std::string(axis_name(shows_beyond_angle(*f.effect) ? Axis::time : Axis::angle)),
         fmt::format("{:.3g} mV rms are given to {}, the size of which is less than twice its "
                     "error: how much is its own, and how much that of the others, these data do "
                     "not tell",
                     1e3 * takes_v, f.effect->info().id),
         takes_v});
  }
}

void Work::note_what_stands_out() {
  const auto n = static_cast<double>(scene_.all.size() + scene_.spiked.size());
  if (const double few = few_spikes_.rms_v * std::sqrt(static_cast<double>(few_spikes_.count) / n);
      few_spikes_.count != 0 && n < criteria::kShortTable && few >= criteria::kWorthAWord * floor())
    out_.structure.push_back(
        {std::string(axis_name(Axis::time)),
         fmt::format("{} of {:.0f} readings alone depart from what is about them, by up to {:.3g} "
                     "mV: too few to tell a disturbance from a wrong number; left out",
                     few_spikes_.count, n, 1e3 * few_spikes_.worst_v),
         few});
  const double rms = no_spikes_.rms_v * std::sqrt(static_cast<double>(no_spikes_.count) / n);
  if (no_spikes_.count == 0 || rms < criteria::kWorthAWord * floor())
    return;
  out_.structure.push_back(
      {std::string(axis_name(no_spikes_.place_rad ? Axis::angle : Axis::time)),
       fmt::format(
           "{} of {:.0f} samples stand out of the noise by {:.3g} mV rms, {}", no_spikes_.count, n,
           1e3 * no_spikes_.rms_v,
           no_spikes_.place_rad
               ? fmt::format("at the same places in the turn, most of them about {:.0f} deg",
                             *no_spikes_.place_rad * kDegPerRad)
           : no_spikes_.level_v
               ? fmt::format("most of them where their channel is at about {:.4g} V",
                             *no_spikes_.level_v)
           : no_spikes_.on_curve
               ? "along the curve that the pair draws: the shaft jerks, or the readings come late"
               : "several in a row"),
       rms});
}

bool Work::supply_is_inferred() const {
  return found_.supply_rms_fraction > 0.0 ||
         (freed_ && freed_->has_vdd() && !given_.has_vdd() && has(out_.extended, follows_supply));
}

} // namespace ada

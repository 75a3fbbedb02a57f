// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/work.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "base/angle.h"
#include "diagnosis/anonymous/beside_anonymous.h"
#include "diagnosis/conditions/level_gap.h"
#include "diagnosis/conditions/reference_zero.h"
#include "diagnosis/conditions/several.h"
#include "diagnosis/conditions/uneven_motion.h"
#include "diagnosis/conditions/unseen_supply.h"
#include "diagnosis/criteria.h"
#include "diagnosis/events/change_points.h"
#include "diagnosis/lines/images.h"
#include "diagnosis/naming/naming.h"
#include "diagnosis/noise/along_and_across.h"
#include "diagnosis/search/admission.h"
#include "diagnosis/search/candidates.h"
#include "diagnosis/search/first_model.h"
#include "diagnosis/words/describe.h"
#include "model/effect_text.h"
#include "model/wires.h"

namespace ada {

Work::Work(const Capture &capture, const DiagnosisOptions &options, bool guess,
           const Model *apart_from_motion)
    : given_(capture), freed_(guess ? with_unseen_supply(capture) : std::nullopt),
      options_(options), named_before_(named_part(options.baseline, capture.meta.supply_v)),
      scene_(scene_of(worked_on(), options.heldout == nullptr)) {
  scene_.reference_errs = options.reference_errs;
  if (apart_from_motion)
    read_by_radius(scene_, *apart_from_motion);
  if (options.heldout)
    judge_ = scene_of(*options.heldout, false);
  if (judge_ && judge_->insufficient.empty() && scene_.insufficient.empty() &&
      judge_->has_reference == scene_.has_reference && judge_->periods == scene_.periods) {
    const ReferenceZero mine(scene_), other(*judge_);
    if (const double by_rad =
            scene_.has_reference ? mine.move_if_needed(other) : mine.period_of(other);
        by_rad != 0.0)
      move_angle(*judge_, by_rad);
  }
  if (judge_ && scene_.radius_only != judge_->radius_only)
    judge_radius_only(scene_.radius_only ? *judge_ : scene_);
}

void Work::read_by_radius(Scene &scene, const Model &model) const {
  scene.all = at_own_angle(std::move(scene.all), model);
  judge_radius_only(scene);
  std::vector<std::uint32_t> rows; // that are the sensor's, spikes or not
  std::set_union(scene.index.begin(), scene.index.end(), scene.spiked_index.begin(),
                 scene.spiked_index.end(), std::back_inserter(rows));
  const auto [centre_sin_v, centre_cos_v] = recorded_centre_v(model);
  scene.own_jumps =
      own_jumps(worked_on(), rows, centre_sin_v, centre_cos_v, has(model, follows_supply));
}

Diagnosis Work::run() {
  describe_capture(given_, scene_, out_);
  out_.baseline_name = options_.baseline_name;
  if (!usable()) {
    name_dead_channel();
    return out_;
  }
  noise_ = expected_noise(worked_on(), scene_, noise_stated_);
  out_.noise_rms_v = noise_;
  if ((scene_.gap = level_gap(worked_on()))) {
    name_nothing();
    return out_;
  }
  search_causes();
  // A supply that was guessed is asked for first: not taken then, it is not there.
  if (guesses_supply() && !has(found_.fit.model, follows_supply))
    return out_;
  if (free_vtemp())
    search_causes();
  if (scene_.has_reference)
    search_further();
  if (offsets_moved()) {
    judge_->all.own_offsets = true;
    search_causes();
    if (scene_.has_reference)
      search_further();
  }
  constexpr int kMostZeros = 3;
  for (int k = 0; k < kMostZeros && scene_.has_reference && zeros_moved(); ++k)
    search_thoroughly();
  // Without a reference what was found bent the motion as well: with it taken out look again, as
  // long as that leaves less over.
  constexpr int kMostLooks = 4;
  constexpr double kMuchLess = 0.9, kLess = 0.97;
  double before = std::numeric_limits<double>::infinity();
  for (int look = 1; !scene_.has_reference && look < kMostLooks; ++look) {
    const double now = found_.residual_rms_v;
    const double less = now > criteria::kAboveNoise * floor() ? kMuchLess : kLess;
    if (found_.order.empty() || now > less * std::exchange(before, now))
      break;
    Model known = found_.fit.model;
    fold_images(scene_.all, known);
    Scene again = prepare(worked_on(), options_.heldout == nullptr, &known, vdd_level_v());
    if (!again.insufficient.empty())
      break;
    if (scene_.radius_only)
      read_by_radius(again, known);
    scene_ = std::move(again);
    search_causes();
  }
  if (!scene_.has_reference && (!found_.order.empty() || found_.supply_rms_fraction > 0.0))
    search_further();
  if (!scene_.has_reference && found_.supply_rms_fraction > 0.0 &&
      !accounts_for_radius(split_.heldout, found_.fit.model, found_.supply_rms_fraction, floor()))
    found_.supply_rms_fraction = 0.0;
  // What wandered hid what does not: with its course taken out the search is made once more.
  constexpr int kMostRounds = 3; // one for each process, and one for what a step hid
  const Direction disturbed = scene_.all.disturbed;
  const double weight_along = scene_.all.weight_along;
  settle();
  if (take_out_record_gains()) {
    weigh(disturbed, weight_along);
    search_thoroughly();
    settle();
  }
  for (int round = 0; round < kMostRounds && take_out_processes(); ++round) {
    weigh(disturbed, weight_along);
    search_thoroughly();
    settle();
  }
  if (take_out_step_at_the_reversal()) {
    weigh(disturbed, weight_along);
    search_thoroughly();
    settle();
  }
  take_out_rest_of_courses();
  name_random_causes();
  angle_left_ = keep_for_last_look(scene_, out_.extended, floor());
  look_at_leftovers();
  conclude();
  return out_;
}

bool Work::may_blame_the_sensor_for_the_motion() const {
  return !scene_.has_reference && !scene_.radius_only &&
         (out_.verdict == Verdict::partly_explained || out_.verdict == Verdict::unexplained);
}

bool Work::names_what_the_motion_follows() const {
  if (scene_.knots.empty())
    return false;
  const Observations &data = scene_.all;
  const std::vector<char> all(data.size(), 1);
  return std::any_of(out_.findings.begin(), out_.findings.end(), [&](const Finding &f) {
    const EffectInstance e{f.effect, f.values, {}};
    const auto order = chosen(e, "order", "per turn");
    if (!order || f.effect->info().stage != Stage::motion)
      return false;
    std::vector<double> size;
    if (const double rpm = chosen(e, "speed_rpm").value_or(0.0); rpm > 0.0)
      for (double w : data.omega)
        size.push_back(ripple_at(w, rpm / 60.0 * kTwoPi));
    return beyond_knots(scene_.knots, data.time, data.alpha, all, *order, size) <
           criteria::kBeyondKnots;
  });
}

bool Work::guesses_supply() const {
  return freed_ && freed_->has_vdd() && !given_.has_vdd();
}

bool Work::guessed_in_vain() const {
  return guesses_supply() && !has(out_.extended, follows_supply);
}

void Work::weigh(Direction disturbed, double weight_along) {
  for (Observations *o : {&scene_.all, &scene_.spiked}) {
    o->disturbed = disturbed;
    o->weight_along = weight_along;
  }
}

void Work::settle() {
  weigh(found_.disturbed, found_.weight_along);
  found_.fit.model = with_exact_moments(scene_, found_.fit.model, 0);
  found_ = name_against_anonymous({scene_, judge(), found_baseline(), noise_, options_.progress},
                                  split_, std::move(found_));
  take(nested_models(scene_, split_, found_));
  for (; found_.by_direction > 0 && !nested_.by_direction; --found_.by_direction) {
    found_.forget(found_.order.size() - 1);
    take(nested_models(scene_, split_, found_));
  }
  if (name_what_the_length_shows())
    take(nested_models(scene_, split_, found_));
  while (drop_what_is_impossible() || drop_what_is_cancelled() || drop_slips_within_a_step() ||
         drop_what_comes_in_slowly() || drop_steps_of_processes() ||
         drop_lines_that_stand_together() || drop_what_the_length_denies() ||
         drop_turns_that_lengthen() || drop_ripples_by_chance() || drop_what_harms() ||
         drop_what_is_unclear())
    take(nested_models(scene_, split_, found_));
  judge_model();
}

void Work::name_nothing() {
  choose_parts();
  found_ = SearchResult{};
  found_.fit = fit(split_.train, with_expected(found_baseline()), 12);
  take(nested_models(scene_, split_, found_));
  nested_.baseline = out_.extended; // the ellipse is no finding
  judge_model();
  first_ = split_.quality(nested_.baseline); // at the angle that the pair has now
  angle_left_ = keep_for_last_look(scene_, out_.extended, floor());
  look_at_leftovers();
  conclude();
}

void Work::judge_model() {
  if (scene_.radius_only) // the angle is that of the pair as the model has it now
    for (Observations *o : {&scene_.all, &split_.train, &split_.heldout})
      *o = at_own_angle(std::move(*o), out_.extended);
  if (nothing_taken_out())
    first_ = scene_.radius_only ? split_.quality(nested_.baseline) : nested_.first;
  if (scene_.radius_only || found_.order.empty())
    last_ = split_.quality(out_.extended);
  // Where nothing has a name the better one of two fits of the same model stands.
  if (found_.order.empty() && !nested_.supply)
    if (const SplitQuality plain = split_.quality(nested_.baseline);
        likelier_and_no_farther(plain)) {
      out_.extended.baseline = nested_.baseline.baseline;
      last_ = plain;
    }
  // What was taken for noise before any fit may have held what the model explains: beside a
  // reference all noise is in what is left.
  if (!noise_stated_ && scene_.has_reference && found_.disturbed == Direction::none)
    if (const double left_v =
            std::max(last_.heldout.residual_rms_v, last_.in_sample.residual_rms_v);
        left_v > 0.0 && left_v < noise_) {
      noise_ = out_.noise_rms_v = left_v;
      scene_.white_noise_v = std::min(scene_.white_noise_v, left_v);
    }
  compare_with_anonymous();
  if (spikes())
    compare_with_anonymous();
}

std::optional<Model> Work::named_part(const Model *model, double supply_v) {
  if (!model)
    return std::nullopt;
  Model out = model->at_supply(supply_v);
  out.remainder.reset();
  return out;
}

std::optional<Model> Work::with_given_remainder(Model model) const {
  if (!options_.baseline || !options_.baseline->remainder)
    return std::nullopt;
  model.remainder = options_.baseline->remainder;
  return model;
}

void Work::choose_parts() {
  split_.has_reference = scene_.has_reference;
  split_.own_angle = scene_.radius_only;
  split_.second_capture = judge_.has_value();
  split_.recent = std::make_shared<RecentAnonymous>();
  split_.train = scene_.all.select(thin(scene_.train, criteria::kFitTrain));
  split_.heldout = options_.heldout
                       ? judge_->all
                       : scene_.all.select(thin(scene_.heldout, criteria::kFitHeldout));
}

bool Work::usable() {
  out_.reason = scene_.insufficient;
  if (out_.reason.empty() && judge_ && !judge_->insufficient.empty())
    out_.reason = "the held-out capture: " + judge_->insufficient;
  if (out_.reason.empty() && judge_ &&
      (judge_->has_reference != scene_.has_reference || judge_->periods != scene_.periods))
    out_.reason = "the two captures differ in reference or periods per turn";
  out_.verdict = Verdict::insufficient_data;
  return out_.reason.empty();
}

void Work::name_dead_channel() {
  for (Finding &f : screened_findings())
    if (f.effect->info().spoils == Spoils::channel) {
      out_.reason = f.explanation + " Beyond that: " + out_.reason;
      out_.findings.push_back(std::move(f));
    }
}

bool Work::given(const Effect *effect) const {
  return named_before_ && std::any_of(named_before_->effects.begin(), named_before_->effects.end(),
                                      [&](const EffectInstance &e) { return e.effect == effect; });
}

std::vector<Finding> Work::screened_findings() {
  std::vector<Finding> out;
  for (const ScreenFinding &f : scene_.screened) {
    // Spikes are measured against the final model.
    if (f.effect->info().spoils == Spoils::readings)
      continue;
    if (given(f.effect)) {
      given_seen_ = true;
      continue;
    }
    // Without a reference the ends of a burst jump as well, and so does what passes between two
    // ranges of readings that do not join.
    if (!scene_.has_reference && is_jump(f.effect->info()) && (in_bursts_ || scene_.gap))
      continue;
    const bool correctable = f.effect->info().correctable;
    out.push_back(
        {f.effect, f.values, f.std_errors, f.alternatives, {}, {}, first_, first_, correctable});
    put_in_words(out.back());
    if (!f.explanation.empty())
      out.back().explanation += " " + f.explanation;
    if (!correctable || f.effect->info().evidence != Evidence::screening)
      recorded_.push_back({f.effect, f.values, f.std_errors});
  }
  return out;
}

Finding Work::recorded(Finding finding) {
  put_in_words(finding);
  recorded_.push_back({finding.effect, finding.values, finding.std_errors});
  return finding;
}

void Work::compare_with_anonymous() {
  const Uncoloured uncoloured(split_);
  const DataSplit &white = uncoloured.split();
  unnamed_ = anonymous_of(scene_, white, out_.extended);
  if (nothing_taken_out()) {
    const Anonymous whole = anonymous_of(scene_, white, nested_.baseline);
    out_.budget = budget_of(whole, unnamed_);
    out_.anonymous = quality_with(whole, white, nested_.baseline);
  } else {
    name_in_budget();
  }
  out_.noise = noise_shape(unnamed_, white, out_.extended);
  named_ = last_;
  carry_remainder(white);
}

namespace {

/// Rms of what a model leaves across the vector to that along it.
double left_across_to_along(const Observations &data, const Model &model) {
  std::vector<double> along, across;
  along_and_across(data, residual_columns(data, model), along, across);
  return std::sqrt(mean_square(across) / mean_square(along));
}

} // namespace

bool Work::is_of_the_reference(const Model &with) const {
  const std::vector<Ripple> ripples = unnamed_ripples(scene_, with);
  if (ripples.empty())
    return false;
  const Observations data = thinned(split_.train);
  const std::vector<double> turned = turned_by_remainder(data, with);
  double of_orders2 = 0.0, against2 = 0.0, error4 = 0.0;
  const auto figure = static_cast<std::size_t>(scene_.periods);
  for (std::size_t n = 1; n <= ripples.size(); ++n) {
    if (n == figure || n == 2 * figure) // the ellipse has taken that up
      continue;
    std::complex<double> order;
    for (std::size_t i = 0; i < turned.size(); ++i)
      order += turned[i] * std::polar(2.0 / static_cast<double>(turned.size()),
                                      static_cast<double>(n) * data.alpha[i]);
    const Ripple &r = ripples[n - 1];
    // What the reference reads too much the sensor seems to read too little. The errors of the
    // ripples know nothing of the remainder, and so of many orders they cancel.
    of_orders2 += std::norm(order);
    against2 -= (order * std::complex<double>(r.cos, -r.sin)).real();
    error4 += std::norm(order) * r.error * r.error;
  }
  // Half of it at least is of orders that tell, and of these the reference has as much, no less and
  // no more, clearly beyond the errors.
  return of_orders2 > mean_square(turned) && against2 > criteria::kMostOfRemainder * of_orders2 &&
         criteria::kMostOfRemainder * against2 < of_orders2 &&
         against2 > criteria::kClearErrors * std::sqrt(error4);
}

void Work::carry_remainder(const DataSplit &white) {
  remainder_of_reference_ = remainder_in_part_ = false;
  out_.remainder_rms_v = out_.remainder_angle_rms_deg = 0.0;
  auto kept = with_given_remainder(out_.extended);
  Model judged = out_.extended; // by the training part alone
  // What the shaft did not meet again where it passed again is no function of the angle.
  const auto comes_again = [&](const Model &with) {
    const Recurrence again =
        recurrence(not_named(), with.remainder->rms() * out_.extended.baseline.amplitude_v);
    return again != Recurrence::none;
  };
  const auto carry = [&](double weight_along) {
    const auto fitted = [&](const Observations &data) {
      return with_remainder(scene_, unnamed_, data, out_.extended, weight_along);
    };
    Model with = fitted(white.train);
    if (!with.remainder)
      return false;
    const SplitQuality after = white.quality(with);
    if (!likelier_and_no_farther(after) || !comes_again(with))
      return false;
    // Along a supply that is only inferred nothing says what is the angle's.
    Observations judge = white.heldout;
    const bool beside_supply = judge.disturbed == Direction::supply;
    if (beside_supply)
      judge.weight_along = 0.0;
    const auto left = [&](const Model &model) {
      ResidualColumns out = residual_columns(judge, as_seen_by(judge, model));
      for (std::size_t i = 0; beside_supply && i < judge.size(); ++i)
        judge.whiten(i, out.model_sin[i], out.model_cos[i], out.sin[i], out.cos[i]);
      return out;
    };
    if (!takes_throughout(judge, left(with), left(out_.extended), beside_supply)) {
      remainder_in_part_ = true;
      return false;
    }
    if ((remainder_of_reference_ = is_of_the_reference(with)))
      return true; // and there is none to carry
    judged = std::move(with);
    out_.extended = fitted(everything());
    last_ = after;
    return true;
  };
  // What the length does besides gets into the angle where both are fitted alike.
  if (!carry(1.0) && !remainder_in_part_ && scene_.has_reference && white.train.weight_along == 1.0)
    if (const double ratio = left_across_to_along(thinned(white.train), out_.extended);
        ratio > 0.0 && ratio < criteria::kMuchLessAcross)
      carry(ratio);
  if (kept)
    if (const SplitQuality after = white.quality(*kept); likelier_and_no_farther(after)) {
      judged = out_.extended = *std::move(kept);
      last_ = after;
    }
  carry_mean_of_unnamed(white, judged);
  if (!out_.extended.remainder)
    return;
  out_.remainder_rms_v = out_.extended.remainder->rms() * out_.extended.baseline.amplitude_v;
  if (split_.has_reference)
    out_.remainder_angle_rms_deg = remainder_angle_rms(split_.heldout, out_.extended);
}

bool Work::likelier_and_no_farther(const SplitQuality &other) const {
  const auto &after = other.heldout.angle_error_rms_deg,
             &before = last_.heldout.angle_error_rms_deg;
  return other.heldout.log_likelihood > last_.heldout.log_likelihood &&
         !(after && before && *after > criteria::kNoWorse * *before);
}

void Work::carry_mean_of_unnamed(const DataSplit &white, const Model &judged) {
  if (!scene_.has_reference)
    return;
  const auto with_mean = [](Observations data, const Model &model) {
    data.own_offsets = true;
    return as_seen_by(data, model);
  };
  const SplitQuality after = white.quality(with_mean(white.train, judged));
  const double nats = static_cast<double>(white.heldout.size()) *
                      (after.heldout.log_likelihood - last_.heldout.log_likelihood);
  const double error = after.heldout.angle_error_rms_deg.value(),
               was = last_.heldout.angle_error_rms_deg.value();
  // The angle is what the offsets are for: what the length would rather have counts less.
  if (!(error <= was && nats > criteria::kRivalNats) && !(criteria::kNoWorse * error < was))
    return;
  out_.extended = with_mean(everything(), out_.extended);
  last_ = after;
}

Observations Work::everything() const {
  if (judge_)
    return split_.train;
  std::vector<std::uint32_t> all(scene_.all.size());
  std::iota(all.begin(), all.end(), 0u);
  Observations out = scene_.all.select(thin(all, criteria::kRemainderSamples));
  return out;
}

bool Work::spikes() {
  const double noise = std::max({floor(), std::sqrt(unnamed_.selection.noise_v2),
                                 loudest_noise(split_.train, out_.extended)});
  const Spikes spikes = spikes_against(scene_, out_.extended, scene_.heldout, noise);
  no_spikes_ = spikes.no_spikes;
  few_spikes_ = spikes.few;
  if (!spikes.found)
    return false;
  // Those that no first look took out have bent the fits.
  const SplitQuality with = nested_.first;
  const DataSplit whole = split_;
  const NestedModels beside = nested_;
  const Model extended = out_.extended;
  const SplitQuality last = last_;
  leave_out(spikes.hit);
  take(nested_models(scene_, split_, found_));
  // Rows that leave as much behind as they take were a part of what is left, and no spikes in it.
  const bool more =
      std::any_of(spikes.hit.begin(), spikes.hit.end(), [](char h) { return h != 0; });
  if (more && !judge_ && nested_.last.heldout.residual_rms_v > beside.last.heldout.residual_rms_v) {
    split_ = whole;
    take(beside);
    out_.extended = extended;
    last_ = last;
    return false;
  }
  if (given(&the_effect_that_spoils(Spoils::readings))) {
    given_seen_ = true;
    return true;
  }
  Finding finding{&the_effect_that_spoils(Spoils::readings),
                  {spikes.rate, spikes.amplitude_v},
                  {spikes.rate_error, spikes.amplitude_error_v},
                  {},
                  {},
                  {},
                  with,
                  nested_.first,
                  false};
  finding.before.heldout.log_likelihood = spikes.before;
  finding.after.heldout.log_likelihood = spikes.after;
  spikes_ = recorded(std::move(finding));
  return true;
}

void Work::take(NestedModels nested) {
  nested_ = std::move(nested);
  out_.extended = nested_.extended;
  last_ = nested_.last;
}

void Work::leave_out(const std::vector<char> &hit) {
  const auto rest = [&](const std::vector<std::uint32_t> &from) {
    std::vector<std::uint32_t> keep;
    for (std::uint32_t i : from)
      if (!hit[i])
        keep.push_back(i);
    return keep;
  };
  const auto select = [&](const Observations &old, const std::vector<std::uint32_t> &keep) {
    Observations out = scene_.all.select(keep);
    out.disturbed = old.disturbed;
    out.weight_along = old.weight_along;
    return out;
  };
  split_.train = select(split_.train, rest(thin(scene_.train, criteria::kFitTrain)));
  if (!judge_)
    split_.heldout = select(split_.heldout, rest(thin(scene_.heldout, criteria::kFitHeldout)));
}

void Work::note_invisible(const Effect &effect) {
  const ResidualColumns none;
  const Residual facts =
      residual_view(scene_, scene_.all, none, noise_, out_.extended.baseline.amplitude_v);
  std::string why = effect.invisible(facts);
  if (why.empty() && scene_.lag_in_zeros && is_common_delay(effect.info()))
    why = "each capture has one speed and a zero angle of its own, which holds the delay";
  if (why.empty() && scene_.radius_only && needs_motion(effect))
    why = "without a reference, and with a shaft that turns unevenly, only the radius is judged";
  const bool named = std::any_of(out_.findings.begin(), out_.findings.end(),
                                 [&](const Finding &f) { return f.effect == &effect; });
  if (why.empty() && !named)
    why = effect.invisible_part(facts);
  if (!why.empty())
    out_.invisible.push_back({std::string(effect.info().id), why});
}

namespace {

/// Adds an effect, or to the one at its place what that has not: the other end of a channel that
/// the search saw clip, say.
void put_in(EffectInstance e, Model &model) {
  const auto same = std::ranges::find_if(
      model.effects, [&](const EffectInstance &other) { return repeats(other, e); });
  if (same == model.effects.end())
    return model.effects.push_back(std::move(e));
  for (std::size_t k = 0; k < e.values.size(); ++k)
    if (!std::isfinite(same->values[k])) {
      same->values[k] = e.values[k];
      if (k < same->std_errors.size() && k < e.std_errors.size())
        same->std_errors[k] = e.std_errors[k];
    }
}

} // namespace

void Work::conclude() {
  out_.radius_only = scene_.radius_only;
  out_.fastest_rad_s = fastest_over_periods(scene_);
  report_moved_offsets();
  out_.baseline = nested_.baseline;
  const auto given = with_given_remainder(nested_.baseline);
  out_.baseline_quality = given ? split_.quality(*given) : first_;
  out_.extended_quality = last_;
  out_.nested = std::move(nested_.models);
  out_.findings = screened_findings();
  for (std::optional<Finding> *finding : {&spikes_, &nested_.supply})
    if (*finding)
      out_.findings.push_back(std::move(**finding));
  std::move(nested_.findings.begin(), nested_.findings.end(), std::back_inserter(out_.findings));
  std::move(random_.begin(), random_.end(), std::back_inserter(out_.findings));
  if (free_lag_)
    for (Model *m : {&out_.baseline, &out_.extended})
      std::erase_if(m->effects,
                    [](const EffectInstance &e) { return is_common_delay(e.effect->info()); });
  for (EffectInstance &e : recorded_)
    put_in(std::move(e), out_.extended);
  if (has(out_.extended, follows_supply))
    out_.extended.vdd_reference_v = vdd_level_v();
  out_.extended.noise_rms_v = last_.in_sample.residual_rms_v;
  out_.extended.provenance = provenance_of(worked_on(), last_);
  for (const Effect *effect : catalogue())
    note_invisible(*effect);
  out_.verdict = verdict();
}

Verdict Work::verdict() const {
  const bool named = !out_.findings.empty() || given_explains();
  if (out_.structure.empty())
    return named ? Verdict::explained : Verdict::no_discrepancy;
  return named ? Verdict::partly_explained : Verdict::unexplained;
}

bool Work::given_explains() const {
  if (!named_before_ || named_before_->effects.empty())
    return false;
  const bool random = std::any_of(seen_random_.begin(), seen_random_.end(),
                                  [&](const EffectInstance &e) { return given(e.effect); });
  if (given_seen_ || random)
    return true;
  const Model bare = fit(split_.train, first_model(scene_, nullptr), 6).model;
  const double nats =
      (nested_.first.heldout.log_likelihood - split_.quality(bare).heldout.log_likelihood) *
      static_cast<double>(split_.heldout.size());
  return nats > criteria::kAdmittedNats;
}

} // namespace ada

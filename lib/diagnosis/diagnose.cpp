// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/diagnose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/anonymous/anonymous.h"
#include "diagnosis/candidates.h"
#include "diagnosis/conditions/gains.h"
#include "diagnosis/conditions/held_rows.h"
#include "diagnosis/conditions/level_gap.h"
#include "diagnosis/conditions/reference_zero.h"
#include "diagnosis/conditions/several.h"
#include "diagnosis/criteria.h"
#include "diagnosis/describe.h"
#include "diagnosis/first_model.h"
#include "diagnosis/images.h"
#include "diagnosis/ladder.h"
#include "diagnosis/leftovers.h"
#include "diagnosis/moments.h"
#include "diagnosis/naming.h"
#include "diagnosis/noise_causes.h"
#include "diagnosis/parts.h"
#include "diagnosis/random_causes.h"
#include "diagnosis/search.h"
#include "diagnosis/unseen_supply.h"
#include "motion/surroundings.h"

namespace ada {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kLeastGain = 0.1; ///< below a tenth of its length a vector tells no angle
/// A residual this far above the noise is worth a thorough search.
constexpr double kAboveNoise = 1.25;
constexpr std::size_t kSearchTrain = 30000, kSearchHeldout = 15000;
/// For the last fits; more only narrow errors that are far below anything physical.
constexpr std::size_t kFitTrain = 160000, kFitHeldout = 80000;

/// The parts of a diagnosis that work on one pair of training and held-out data.
class Work {
public:
  /// `guess`: a supply that is not recorded may be read off the radius first. `apart_from_motion`:
  /// only the radius is judged, at the angle that the pair gives with this model.
  Work(const Capture &capture, const DiagnosisOptions &options, bool guess,
       const Model *apart_from_motion = nullptr)
      : given_(capture), freed_(guess ? with_unseen_supply(capture) : std::nullopt),
        options_(options), named_before_(named_part(options.baseline, capture.meta.supply_v)),
        scene_(scene_of(worked_on(), options.heldout == nullptr)) {
    if (apart_from_motion) {
      scene_.all = at_own_angle(std::move(scene_.all), *apart_from_motion);
      judge_radius_only(scene_);
    }
    if (options.heldout)
      judge_ = scene_of(*options.heldout, false);
    if (judge_ && judge_->insufficient.empty() && scene_.insufficient.empty() &&
        judge_->has_reference && scene_.has_reference && judge_->periods == scene_.periods)
      move_angle(*judge_, ReferenceZero(scene_).move_if_needed(ReferenceZero(*judge_)));
    if (judge_ && scene_.radius_only != judge_->radius_only)
      judge_radius_only(scene_.radius_only ? *judge_ : scene_);
  }

  Diagnosis run() {
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
    free_vtemp();
    search_causes(scene_.has_reference);
    if (offsets_moved()) {
      judge_->all.own_offsets = true;
      search_causes(scene_.has_reference);
    }
    constexpr int kMostZeros = 3;
    for (int k = 0; k < kMostZeros && scene_.has_reference && zeros_moved(); ++k)
      search_causes(true);
    // Without a reference what was found bent the motion as well: with it taken out look again, as
    // long as that leaves less over.
    constexpr int kMostLooks = 4;
    constexpr double kMuchLess = 0.9, kLess = 0.97;
    double before = kInfinite;
    for (int look = 1; !scene_.has_reference && look < kMostLooks; ++look) {
      const double now = found_.residual_rms_v;
      const double less = now > kAboveNoise * floor() ? kMuchLess : kLess;
      if (found_.order.empty() || now > less * std::exchange(before, now))
        break;
      Model known = found_.fit.model;
      fold_images(scene_.all, known);
      Scene again = prepare(worked_on(), options_.heldout == nullptr, &known, vdd_level_v());
      if (!again.insufficient.empty())
        break;
      if (scene_.radius_only) {
        again.all = at_own_angle(std::move(again.all), known);
        judge_radius_only(again);
      }
      scene_ = std::move(again);
      search_causes(false);
    }
    if (!scene_.has_reference && (!found_.order.empty() || found_.supply_rms_fraction > 0.0))
      search_causes(true);
    if (!scene_.has_reference && found_.supply_rms_fraction > 0.0 &&
        !accounts_for_radius(parts_.heldout, found_.fit.model, found_.supply_rms_fraction, floor()))
      found_.supply_rms_fraction = 0.0;
    // What wandered hid what does not: with its course taken out the search is made once more.
    constexpr int kMostRounds = 2;
    const Direction disturbed = scene_.all.disturbed;
    const double weight_along = scene_.all.weight_along;
    settle();
    if (take_out_record_gains()) {
      weigh(disturbed, weight_along);
      search_causes(true);
      settle();
    }
    for (int round = 0; round < kMostRounds && take_out_processes(); ++round) {
      weigh(disturbed, weight_along);
      search_causes(true);
      settle();
    }
    take_out_rest_of_courses();
    name_random_causes();
    angle_left_ = keep_for_last_look(scene_, out_.extended, floor());
    look_at_leftovers();
    conclude();
    return out_;
  }

  /// Whether the shaft was taken for a reference and something is left over that may be its motion.
  bool may_blame_the_sensor_for_the_motion() const {
    return !scene_.has_reference && !scene_.radius_only &&
           (out_.verdict == Verdict::partly_explained || out_.verdict == Verdict::unexplained);
  }
  /// What the extended model leaves along the radius of held-out data, V rms.
  RadiusLeft radius_left() const { return ada::radius_left(parts_.heldout, out_.extended); }

  /// Whether a supply was read off the radius that the search then did not confirm.
  bool guessed_in_vain() const {
    return freed_ && freed_->has_vdd() && !given_.has_vdd() && !has(out_.extended, follows_supply);
  }

private:
  void weigh(Direction disturbed, double weight_along) {
    for (Observations *o : {&scene_.all, &scene_.spiked}) {
      o->disturbed = disturbed;
      o->weight_along = weight_along;
    }
  }

  /// Names what the search found against what has no name, and fits and judges the whole.
  void settle() {
    weigh(found_.disturbed, found_.weight_along);
    found_.fit.model = with_exact_moments(scene_, found_.fit.model, 0);
    found_ = name_against_anonymous({scene_, judge(), found_baseline(), noise_, options_.progress},
                                    parts_, std::move(found_));
    take(build_ladder(parts_, found_));
    while (drop_what_is_impossible() || drop_what_harms() || drop_what_is_unclear())
      take(build_ladder(parts_, found_));
    judge_model();
  }

  /// What the readings of two ranges that do not join show together is no cause's: a fit of any would
  /// mend the joint. The ellipse, and what repeats with the angle, are carried all the same.
  void name_nothing() {
    choose_parts();
    found_ = SearchResult{};
    found_.fit = fit(parts_.train, with_expected(found_baseline()), 12);
    take(build_ladder(parts_, found_));
    ladder_.baseline = out_.extended; // the ellipse is no finding
    judge_model();
    first_ = parts_.rung(ladder_.baseline); // at the angle that the pair has now
    angle_left_ = keep_for_last_look(scene_, out_.extended, floor());
    look_at_leftovers();
    conclude();
  }

  /// The model as it stands now, beside what has no name.
  void judge_model() {
    if (processes_.empty())
      first_ = ladder_.first;
    if (scene_.radius_only) { // the angle is that of the pair as the model has it now
      for (Observations *o : {&scene_.all, &parts_.train, &parts_.heldout})
        *o = at_own_angle(std::move(*o), out_.extended);
      last_ = parts_.rung(out_.extended);
    }
    compare_with_anonymous();
    if (spikes())
      compare_with_anonymous();
  }

  bool zeros_moved() {
    return move_zeros(scene_, worked_on(), found_.fit.model,
                      std::max(noise_, found_.residual_rms_v));
  }

  /// What a given model carries without a name is no cause: it is looked for anew, so that a model
  /// is judged alike whether it was just found or is given.
  static std::optional<Model> named_part(const Model *model, double supply_v) {
    if (!model)
      return std::nullopt;
    Model out = model->at_supply(supply_v);
    out.remainder.reset();
    return out;
  }

  const Model *baseline() const { return named_before_ ? &*named_before_ : nullptr; }

  /// `model` with what the given model carries without a name; nothing: it carries nothing.
  std::optional<Model> with_given_remainder(Model model) const {
    if (!options_.baseline || !options_.baseline->remainder)
      return std::nullopt;
    model.remainder = options_.baseline->remainder;
    return model;
  }

  /// Without a reference the motion is read off the pair as the given model corrects it, as it is
  /// off what was found; where that leaves nothing to judge, off the pair as it is.
  Scene scene_of(const Capture &capture, bool needs_split) const {
    if (baseline() && !capture.has_reference()) {
      const Model known = baseline()->at_supply(capture.meta.supply_v);
      if (Scene scene = prepare(capture, needs_split, &known, vdd_level_v());
          scene.insufficient.empty())
        return scene;
    }
    return prepare(capture, needs_split, nullptr, vdd_level_v());
  }

  /// Where the supply counts from, V: one level for all captures, that of the given model if it has
  /// one. Nothing: the supply is not recorded.
  std::optional<double> vdd_level_v() const {
    if (!given_.has_vdd())
      return std::nullopt;
    if (named_before_ && named_before_->vdd_reference_v)
      return named_before_->vdd_reference_v;
    return SupplyOverTime(given_).mean_v;
  }

  const Capture &worked_on() const { return freed_ ? *freed_ : given_; }

  /// With a reference the search itself sees a supply that is not recorded; where VTEMP follows it
  /// every temperature effect would.
  void free_vtemp() {
    if (!scene_.has_reference || given_.has_vdd() || !scene_.why_no_temperature.empty())
      return;
    search_causes(false);
    if (found_.disturbed != Direction::supply)
      return;
    auto freed = with_free_vtemp(worked_on(), scene_, found_.fit.model);
    if (!freed)
      return;
    freed_ = std::move(freed);
    scene_ = prepare(*freed_, options_.heldout == nullptr);
  }

  const Scene &judge() const { return options_.heldout ? *judge_ : scene_; }
  double floor() const { return std::max(noise_, scene_.white_noise_v); }

  void choose_parts() {
    parts_.has_reference = scene_.has_reference;
    parts_.own_angle = scene_.radius_only;
    parts_.second_capture = judge_.has_value();
    parts_.recent = std::make_shared<RecentAnonymous>();
    parts_.train = scene_.all.select(thin(scene_.train, kFitTrain));
    parts_.heldout =
        options_.heldout ? judge_->all : scene_.all.select(thin(scene_.heldout, kFitHeldout));
  }

  void search_causes(bool thorough) {
    choose_parts();
    Model start = first_model(scene_, baseline());
    // Without a reference the angle is the pair's own, lag and all: a common delay is free.
    // So it is where each of several captures has its own zero angle and one speed.
    const bool own = scene_.has_reference ? scene_.lag_in_zeros : !scene_.radius_only;
    free_lag_ =
        own && (scene_.several_speeds || scene_.both_directions) && !has(start, is_common_delay);
    if (free_lag_)
      start.effects.push_back({&the_effect(is_common_delay), {0.0}, {}});
    const auto search = [&] {
      return Search(
          {&scene_, scene_.all.select(thin(scene_.train, kSearchTrain)),
           options_.heldout ? judge_->all : scene_.all.select(thin(scene_.heldout, kSearchHeldout)),
           &judge()},
          start, noise_, options_.progress);
    };
    found_ = search().run(false);
    if (!thorough)
      return;
    const Model physical = found_.fit.model;
    const Unnamed unnamed =
        unnamed_beside(scene_, parts_, physical, anonymous_of(scene_, parts_, physical), noise_);
    // What is left over is looked at against what has no name: second thoughts come there.
    found_ = search().run(false, &physical, unnamed);
    if (!anonymous_of(scene_, parts_, found_.fit.model).any()) {
      const Model known = found_.fit.model;
      found_ = search().run(true, &known, unnamed);
    }
  }

  /// Whether the second capture has other offsets than what was found accounts for. They would hide
  /// everything that the two captures have in common.
  bool offsets_moved() const {
    constexpr double kMuch = 0.75; // of the sum of squares stays with offsets of its own
    if (!judge_)
      return false;
    Observations own = parts_.heldout;
    own.own_offsets = true;
    const Model &model = found_.fit.model;
    return sum_of_squares(own, as_seen_by(own, model)) <
           kMuch * sum_of_squares(parts_.heldout, as_seen_by(parts_.heldout, model));
  }

  /// What no cause within one capture can explain.
  void report_moved_offsets() {
    if (!judge_ || !judge_->all.own_offsets)
      return;
    const Baseline &first = out_.extended.baseline;
    const Baseline second = as_seen_by(parts_.heldout, out_.extended).baseline;
    const double sin = second.offset_sin_v - first.offset_sin_v;
    const double cos = second.offset_cos_v - first.offset_cos_v;
    out_.structure.push_back(
        {"time",
         fmt::format("between the two captures the offsets move by {:+.3g} mV (VSIN) and {:+.3g} "
                     "mV (VCOS); the second is judged with its own",
                     1e3 * sin, 1e3 * cos),
         std::hypot(sin, cos) / std::sqrt(2.0)});
  }

  bool usable() {
    out_.reason = scene_.insufficient;
    if (out_.reason.empty() && judge_ && !judge_->insufficient.empty())
      out_.reason = "the held-out capture: " + judge_->insufficient;
    if (out_.reason.empty() && judge_ &&
        (judge_->has_reference != scene_.has_reference || judge_->periods != scene_.periods))
      out_.reason = "the two captures differ in reference or periods per turn";
    out_.verdict = Verdict::insufficient_data;
    return out_.reason.empty();
  }

  /// A channel that died leaves little to judge; that it died is known all the same.
  void name_dead_channel() {
    for (Finding &f : screened_findings())
      if (f.effect->info().spoils == Spoils::channel) {
        out_.reason = f.explanation + " Beyond that: " + out_.reason;
        out_.findings.push_back(std::move(f));
      }
  }

  bool given(const Effect *effect) const {
    return named_before_ &&
           std::any_of(named_before_->effects.begin(), named_before_->effects.end(),
                       [&](const EffectInstance &e) { return e.effect == effect; });
  }

  /// What the first look found, before any fit.
  std::vector<Finding> screened_findings() {
    std::vector<Finding> out;
    for (const ScreenFinding &f : scene_.screened) {
      // Spikes are measured against the final model.
      if (f.effect->info().spoils == Spoils::readings)
        continue;
      if (given(f.effect)) {
        given_seen_ = true;
        continue;
      }
      // Without a reference the ends of a burst jump as well.
      if (in_bursts_ && !scene_.has_reference && is_jump(f.effect->info()))
        continue;
      const bool correctable = f.effect->info().correctable;
      out.push_back(
          {f.effect, f.values, f.std_errors, f.alternatives, {}, {}, first_, first_, correctable});
      put_in_words(out.back());
      if (!correctable)
        recorded_.push_back({f.effect, f.values, f.std_errors});
    }
    return out;
  }

  /// A cause that the extended model names and no conversion corrects.
  Finding recorded(Finding finding) {
    put_in_words(finding);
    recorded_.push_back({finding.effect, finding.values, finding.std_errors});
    return finding;
  }

  /// What the search began with: the model without its findings.
  Model found_baseline() const {
    Model out = first_model(scene_, baseline());
    if (free_lag_)
      out.effects.push_back({&the_effect(is_common_delay), {0.0}, {}});
    return out;
  }

  /// No finding makes held-out data worse: where all together do, the one that harms most goes.
  bool drop_what_harms() {
    const Quality &first = ladder_.first.heldout, &last = ladder_.last.heldout;
    const bool likelier = last.log_likelihood >= first.log_likelihood;
    const bool closer =
        !last.angle_error_rms_deg ||
        *last.angle_error_rms_deg <= criteria::kNoWorse * *first.angle_error_rms_deg;
    if (found_.order.empty() || (likelier && closer))
      return false;
    std::size_t worst = 0;
    double most = -kInfinite;
    for (std::size_t i = 0; i < ladder_.findings.size(); ++i) {
      const Quality &before = ladder_.findings[i].before.heldout;
      const Quality &after = ladder_.findings[i].after.heldout;
      const double harm = likelier ? *after.angle_error_rms_deg - *before.angle_error_rms_deg
                                   : before.log_likelihood - after.log_likelihood;
      if (harm > most) {
        most = harm;
        worst = i;
      }
    }
    found_.forget(worst);
    return true;
  }

  /// A cause that the last fit, with all of the data and what has no name, leaves outside of what
  /// it can be (a delay below zero) stands for something else.
  bool drop_what_is_impossible() {
    const auto &f = ladder_.findings;
    const auto impossible = std::find_if(f.begin(), f.end(), [](const Finding &of) {
      return !in_range({of.effect, of.values, {}});
    });
    if (impossible == f.end())
      return false;
    found_.forget(static_cast<std::size_t>(impossible - f.begin()));
    return true;
  }

  /// A cause whose own standard error, beside what has no name, does not exclude that it is absent
  /// is no finding, whatever the held-out data gained by it: something else is there that it stands
  /// for. Unless it takes most of what is left without it, and is likelier there than not: what has
  /// no name could do that as well, with many columns in its place.
  bool drop_what_is_unclear() {
    std::vector<std::size_t> places(ladder_.clearness.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    std::sort(places.begin(), places.end(),
              [&](auto a, auto b) { return ladder_.clearness[a] < ladder_.clearness[b]; });
    for (const std::size_t place : places) {
      if (ladder_.clearness[place] >= criteria::kClear)
        return false;
      if (ladder_.clearness[place] >= criteria::kUnclear &&
          takes_most(scene_, parts_, found_.fit.model, found_.order[place]))
        continue;
      found_.forget(place);
      return true;
    }
    return false;
  }

  /// The budget, the best model that names nothing, and what is carried without a name.
  void compare_with_anonymous() {
    Parts white = parts_;
    white.train.coloured.reset();
    unnamed_ = anonymous_of(scene_, white, out_.extended);
    if (processes_.empty()) {
      const Anonymous whole = anonymous_of(scene_, white, ladder_.baseline);
      out_.budget = budget_of(whole, unnamed_);
      out_.anonymous = quality_with(whole, white, ladder_.baseline);
    } else {
      name_in_budget();
    }
    out_.noise = noise_shape(unnamed_, white, out_.extended);
    named_ = last_;
    carry_remainder(white);
  }

  /// What repeats with the angle and has no name, where held-out data confirm it: what this capture
  /// shows, or what the given model brought along where that tells more.
  void carry_remainder(const Parts &white) {
    const auto likelier = [&](const Rung &rung) {
      return rung.heldout.log_likelihood > last_.heldout.log_likelihood;
    };
    out_.remainder_rms_v = out_.remainder_angle_rms_deg = 0.0;
    std::optional<Model> carried;
    if (const Model judged = with_remainder(scene_, unnamed_, white.train, out_.extended);
        judged.remainder)
      if (const Rung after = white.rung(judged); likelier(after)) {
        carried = with_remainder(scene_, unnamed_, everything(), out_.extended);
        last_ = after;
      }
    if (auto kept = with_given_remainder(out_.extended))
      if (const Rung after = white.rung(*kept); likelier(after)) {
        carried = std::move(kept);
        last_ = after;
      }
    if (!carried)
      return;
    out_.extended = std::move(*carried);
    out_.remainder_rms_v = out_.extended.remainder->rms() * out_.extended.baseline.amplitude_v;
    if (parts_.has_reference)
      out_.remainder_angle_rms_deg = remainder_angle_rms(parts_.heldout, out_.extended);
  }

  /// All usable samples: the numbers of a remainder that held-out data have confirmed are taken
  /// from them, too.
  Observations everything() const {
    if (judge_)
      return parts_.train;
    std::vector<std::uint32_t> all(scene_.all.size());
    std::iota(all.begin(), all.end(), 0u);
    Observations out = scene_.all.select(thin(all, criteria::kRemainderSamples));
    return out;
  }

  /// Isolated spikes stand out of the noise that there is, whatever was stated. False: none.
  bool spikes() {
    const double noise = std::max({floor(), std::sqrt(unnamed_.selection.noise_v2),
                                   loudest_noise(parts_.train, out_.extended)});
    const Spikes spikes = spikes_against(scene_, out_.extended, scene_.heldout, noise);
    no_spikes_ = spikes.no_spikes;
    if (!spikes.found)
      return false;
    // Those that no first look took out have bent the fits.
    const Rung with = ladder_.first;
    leave_out(spikes.hit);
    take(build_ladder(parts_, found_));
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
                    ladder_.first,
                    false};
    finding.before.heldout.log_likelihood = spikes.before;
    finding.after.heldout.log_likelihood = spikes.after;
    spikes_ = recorded(std::move(finding));
    return true;
  }

  void take(Ladder ladder) {
    ladder_ = std::move(ladder);
    out_.extended = ladder_.extended;
    last_ = ladder_.last;
  }

  /// Takes samples out of everything that is judged from here on.
  void leave_out(const std::vector<char> &hit) {
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
    parts_.train = select(parts_.train, rest(thin(scene_.train, kFitTrain)));
    if (!judge_)
      parts_.heldout = select(parts_.heldout, rest(thin(scene_.heldout, kFitHeldout)));
  }

  static bool has(const Model &model, bool (*is)(const EffectInfo &)) {
    return std::any_of(model.effects.begin(), model.effects.end(),
                       [&](const EffectInstance &e) { return is(e.effect->info()); });
  }

  /// Slow processes, read off what everything else leaves over; their courses are taken out of the
  /// data. Whether they moved the pair by more than its noise, and so may have hidden something.
  bool take_out_processes() {
    if (found_.disturbed == Direction::supply) // what goes on slowly along it is the supply's
      return false;
    Parts white = parts_;
    white.train.coloured.reset();
    // What is carried without a name is a part of what the anonymous model holds.
    Model named = out_.extended;
    named.remainder.reset();
    // A slow process goes along with speed and temperature by chance. It is named where it alone
    // explains most of what changes with any of them, unless the speed alone does so as well: what
    // wanders is not expected to follow its few functions.
    Anonymous slow = anonymous_of(scene_, white, named, {.speed = false, .others = false});
    const double whole =
        slow.from.heldout(slow.from.heldout.rows() - 1, slow.from.heldout.rows() - 1) /
        slow.from.n_heldout;
    if (slow.selection.noise_v2 - unnamed_.selection.noise_v2 >=
        criteria::kLittle * (whole - unnamed_.selection.noise_v2))
      return false;
    std::vector<RandomCause> found = slow_causes(slow, white, named, periods_in_all());
    std::erase_if(found, [&](const RandomCause &c) { return goes_on(c); });
    if (found.empty() || goes_with_speed(slow, whole, white, named))
      return false;
    const int waves = slow.selection.orders[static_cast<std::size_t>(Axis::time)];
    if (!take_out_courses(std::move(slow), found))
      return false;
    slow_waves_ = std::max(slow_waves_, waves);
    double moved_v2 = 0.0;
    for (const RandomCause &c : found)
      moved_v2 += c.slow_v2;
    std::move(found.begin(), found.end(), std::back_inserter(processes_));
    return moved_v2 > unnamed_.selection.noise_v2;
  }

  /// Whether a process has a name already, and this is more of it.
  bool goes_on(const RandomCause &c) const {
    return std::any_of(processes_.begin(), processes_.end(),
                       [&](const RandomCause &old) { return old.effect == c.effect; });
  }

  /// What the first half waves leave of a course is seen where nothing else is left beside it.
  void take_out_rest_of_courses() {
    if (processes_.empty())
      return;
    Parts white = parts_;
    white.train.coloured.reset();
    Model named = out_.extended;
    named.remainder.reset();
    Anonymous slow = anonymous_of(scene_, white, named, {.speed = false, .others = false});
    std::vector<RandomCause> rest = slow_causes(slow, white, named, periods_in_all());
    std::erase_if(rest, [&](const RandomCause &c) { return !goes_on(c); });
    if (!rest.empty())
      take_out_courses(std::move(slow), rest);
  }

  double periods_in_all() const { return scene_.turns * scene_.periods; }

  /// Names slow processes and the shape of the noise.
  void name_random_causes() {
    Parts white = parts_;
    white.train.coloured.reset();
    Model named = out_.extended;
    named.remainder.reset();
    // A converter's steps are no noise.
    const bool reads_noise = !supply_is_inferred() && scene_.coarse_step_v <= 0.0;
    const double stated = !noise_stated_ ? 0.0
                          : named_before_ && named_before_->noise_rms_v
                              ? std::max(noise_, *named_before_->noise_rms_v)
                              : noise_;
    const std::vector<double> &t = scene_.all.time;
    std::vector<RandomCause> noise;
    if (reads_noise)
      noise = noise_causes(unnamed_, white, named, stated, reference_step_rad(),
                           even_clock() ? &scene_.all : nullptr);
    leave_to_flicker(processes_, noise, slow_waves_, t.back() - t.front());
    for (const std::vector<RandomCause> *causes : {&processes_, &noise})
      for (const RandomCause &c : *causes)
        name_process(c);
    if (!reads_noise)
      return;
    // Without a reference the motion has taken in what lies along the circle.
    const double left = std::max(std::sqrt(unnamed_.selection.noise_v2),
                                 scene_.has_reference ? 0.0 : out_.noise.along_v);
    if (!random_.empty() || !noise.empty())
      explained_noise_ = std::max(noise_, left);
  }

  /// Whether the speed, with fewer functions, explains as well what a slow process would, up to
  /// what chance lets them follow. `whole_v2`: what there is without either.
  bool goes_with_speed(const Anonymous &slow, double whole_v2, const Parts &white,
                       const Model &named) const {
    if (!scene_.several_speeds && !scene_.both_directions)
      return false;
    const Anonymous speed =
        anonymous_of(scene_, white, named, {.over_time = false, .others = false});
    const double of_slow = whole_v2 - slow.selection.noise_v2;
    return speed.selection.noise_v2 - slow.selection.noise_v2 < criteria::kNearlyAll * of_slow;
  }

  /// Whether a spectrum over time means anything: an even clock, and a motion that is known.
  bool even_clock() const {
    const std::vector<double> &t = scene_.all.time;
    const double mean = (t.back() - t.front()) / static_cast<double>(t.size());
    return t.size() >= criteria::kFewestForLines && !scene_.radius_only && !scene_.stops &&
           mean < criteria::kUneven * scene_.all.frame_period_s;
  }

  void name_process(const RandomCause &c) {
    // What the functions of a larger process leave of it is faster, and passes for noise.
    if (c.effect->info().evidence == Evidence::noise && c.slow_v2 > 0.0 &&
        c.slow_v2 < criteria::kLittle * slow_v2_)
      return;
    slow_v2_ = std::max(slow_v2_, c.slow_v2);
    seen_random_.push_back({c.effect, c.values, c.std_errors});
    if (given(c.effect))
      return;
    Rung before = last_;
    const double samples = static_cast<double>(std::max<std::size_t>(1, parts_.heldout.size()));
    before.heldout.log_likelihood = last_.heldout.log_likelihood - c.nats / samples;
    random_.push_back(
        recorded({c.effect, c.values, c.std_errors, c.alternatives, {}, {}, before, last_, false}));
  }

  /// A slow process that has a name is taken out of what is looked at from now on: its course is
  /// known. Offsets are subtracted; a gain divides what turns, so that what goes in proportion to
  /// it is constant again. False, and nothing is taken out, where less than half of what goes on
  /// slowly goes with it: then that was something else, which the course went along with.
  bool take_out_courses(Anonymous slow, const std::vector<RandomCause> &processes) {
    const double before_v2 = left_v2(parts_, out_.extended);
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
      out.values = Eigen::Map<const Eigen::VectorXd>(values.data(),
                                                     static_cast<Eigen::Index>(values.size()));
      return out;
    };
    const Selection offsets = courses_of(Pattern::offset), gain = courses_of(Pattern::gain);
    const Baseline &b = out_.extended.baseline;
    const double middle_v = 0.5 * scene_.supply_v;
    for (Observations *data : all_data()) {
      if (judge_ && data == &parts_.heldout)
        continue;
      ResidualColumns pair, turning;
      pair.sin = data->vsin;
      pair.cos = data->vcos;
      subtract(unnamed_.basis, offsets, *data, pair);
      turning.sin.assign(data->size(), 0.0);
      turning.cos = turning.sin;
      subtract(unnamed_.basis, gain, *data, turning);
      for (std::size_t i = 0; i < data->size(); ++i) {
        const double sin_v = b.offset_sin_v + middle_v, cos_v = b.offset_cos_v + middle_v;
        const double s = pair.sin[i] - sin_v, c = pair.cos[i] - cos_v;
        // What the gain adds lies along the vector that it was read off.
        const double more = std::hypot(turning.sin[i], turning.cos[i]);
        const double sign = s * turning.sin[i] + c * turning.cos[i] > 0.0 ? -1.0 : 1.0;
        const double by = std::max(1.0 + sign * more / b.amplitude_v, kLeastGain);
        data->vsin[i] = sin_v + s / by;
        data->vcos[i] = cos_v + c / by;
      }
    }
    if (before_v2 - left_v2(parts_, out_.extended) < criteria::kOfCourse * goes_on_v2) {
      as_they_were.put_back(*this);
      unnamed_ = std::move(unnamed);
      return false;
    }
    look_anew();
    return true;
  }

  std::array<Observations *, 3> all_data() { return {&scene_.all, &parts_.train, &parts_.heldout}; }

  /// The outputs before something is taken out of them that may not be there.
  struct Outputs {
    std::array<std::array<std::vector<double>, 2>, 3> pairs;
    explicit Outputs(Work &of) {
      for (std::size_t k = 0; k < pairs.size(); ++k)
        pairs[k] = {of.all_data()[k]->vsin, of.all_data()[k]->vcos};
    }
    void put_back(Work &to) const {
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        to.all_data()[k]->vsin = pairs[k][0];
        to.all_data()[k]->vcos = pairs[k][1];
      }
    }
  };

  /// What has no name beside the model, and what the model is worth, with a course taken out.
  void look_anew() {
    parts_.courses_taken_out = true;
    Parts white = parts_;
    white.train.coloured.reset();
    Model named = out_.extended;
    named.remainder.reset();
    unnamed_ = anonymous_of(scene_, white, named);
    name_in_budget();
    out_.noise = noise_shape(unnamed_, white, named);
    last_ = white.rung(out_.extended);
  }

  /// Several records may each have a pair of its own length: between them a magnet, an air gap or a
  /// gain was changed. That goes with the time and with the speed of each, and no half waves follow
  /// it. Taken out where that takes most of what goes with either.
  bool take_out_record_gains() {
    const auto share = [&](Axis axis) {
      return std::max(0.0, unnamed_.selection.share_v2[static_cast<std::size_t>(axis)]);
    };
    const double goes_on_v2 = share(Axis::time) + share(Axis::speed);
    if (worked_on().starts.size() < 2 || judge_ || found_.disturbed == Direction::supply ||
        goes_on_v2 < unnamed_.selection.noise_v2)
      return false;
    const double before_v2 = left_v2(parts_, out_.extended);
    const Outputs as_they_were(*this);
    const RecordGains gains(worked_on(), scene_, out_.extended);
    for (Observations *data : all_data())
      for (std::size_t i = 0; i < data->size(); ++i)
        gains.take_out(data->time[i], data->vsin[i], data->vcos[i]);
    const Model alike = fit(parts_.train, gains.common(), 5).model;
    const double after_v2 = left_v2(parts_, alike);
    if (before_v2 - after_v2 < criteria::kOfCourse * goes_on_v2 || after_v2 > goes_on_v2) {
      as_they_were.put_back(*this);
      return false;
    }
    const double samples = static_cast<double>(parts_.heldout.size());
    const double nats =
        samples * std::log(before_v2 / std::max(after_v2, criteria::kLeastMeanSquare));
    look_anew();
    processes_.push_back(gains.as_cause(nats, before_v2 - after_v2));
    return true;
  }

  /// What the courses of processes and the causes beside them account for of each axis.
  void name_in_budget() {
    for (BudgetLine &line : out_.budget) {
      if (line.axis == Axis::noise) {
        line.rms_v = line.unnamed_rms_v = std::sqrt(unnamed_.selection.noise_v2);
        continue;
      }
      const double left =
          std::max(0.0, unnamed_.selection.share_v2[static_cast<std::size_t>(line.axis)]);
      line.unnamed_rms_v = std::min(line.rms_v, std::sqrt(left));
      line.named_rms_v = std::sqrt(
          std::max(0.0, line.rms_v * line.rms_v - line.unnamed_rms_v * line.unnamed_rms_v));
    }
  }

  void look_at_leftovers() {
    const Explained explained{explained_noise_ > 0.0 ? explained_noise_ : noise_,
                              second_order_floor(out_.extended, found_), noise_stated_,
                              supply_is_inferred()};
    note_unnamed();
    note_what_stands_out();
    LeftOver left = left_over(scene_, parts_, out_.extended, explained, last_, angle_left_);
    std::move(left.structure.begin(), left.structure.end(), std::back_inserter(out_.structure));
    drop_what_is_random();
    note_what_the_anonymous_model_does_better();
    std::stable_sort(out_.structure.begin(), out_.structure.end(),
                     [](const Structure &a, const Structure &b) { return a.rms_v > b.rms_v; });
    double unnamed2 = left.unexplained_rms_v * left.unexplained_rms_v;
    for (const BudgetLine &line : out_.budget)
      if (line.axis != Axis::noise)
        unnamed2 += line.unnamed_rms_v * line.unnamed_rms_v;
    out_.unexplained_rms_v = std::sqrt(unnamed2);
    in_bursts_ = left.bursts;
  }

  /// Where nothing is seen to be left over, and the best model that names nothing still leaves
  /// clearly less of held-out data, the named model does not explain the capture.
  void note_what_the_anonymous_model_does_better() {
    const double named2 = std::pow(last_.heldout.residual_rms_v, 2) - std::pow(random_v(), 2);
    const double anonymous2 = std::pow(out_.anonymous.residual_rms_v, 2);
    // Where the motion is read off the pair the anonymous model takes a part of it.
    const bool of_motion = !scene_.has_reference && !scene_.radius_only;
    if (!out_.structure.empty() || supply_is_inferred() || of_motion || !(anonymous2 > 0.0) ||
        named2 < criteria::kMoreVariance * anonymous2 ||
        static_cast<double>(parts_.heldout.size()) * std::log(named2 / anonymous2) <
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

  double channel_rms_v() const {
    return std::abs(out_.extended.baseline.amplitude_v) / std::numbers::sqrt2;
  }

  /// How much a process moves a channel, V rms.
  double process_v(const EffectInfo &info, const std::vector<double> &values) const {
    return info.pattern == Pattern::gain ? values[0] * channel_rms_v()
                                         : std::max(values[0], values[1]);
  }

  /// V rms of a channel that the random processes with a name and the steps of a reference or of a
  /// coarse converter leave over: what is smaller is of their kind. A slow process goes on above
  /// the half waves that its course was taken out by, and comes with what does not go on in time
  /// the less, the more periods lie in each of them.
  double random_v(bool in_time = true) const {
    const double waves = std::max(1, slow_waves_);
    const double alike = in_time ? 1.0 : crosstalk(periods_in_all(), waves) / criteria::kLittle;
    double sum = 0.0;
    for (const EffectInstance &e : seen_random_) {
      const EffectInfo &info = e.effect->info();
      if (info.evidence == Evidence::noise && info.character == Character::process)
        sum += e.values[0] * e.values[0];        // what else is left over is not its own
      else if (info.evidence != Evidence::noise) // white noise has no structure of its own
        sum += std::pow(process_v(info, e.values), 2) / waves * alike;
    }
    sum += std::pow(reference_step_rad() * scene_.periods * channel_rms_v(), 2) / 12.0;
    // Steps that no noise blurs err by the place, and so with whatever the place goes with.
    sum += std::pow(scene_.coarse_step_v, 2) / 12.0;
    // A supply that is only inferred is weighed down to the noise along one of two directions, and
    // goes with whatever changes as slowly as it does.
    if (found_.disturbed == Direction::supply)
      sum += 0.5 * unnamed_.selection.noise_v2;
    return std::sqrt(sum);
  }

  static bool is_white(const EffectInfo &info) {
    return info.evidence == Evidence::noise && info.character != Character::process;
  }
  static bool is_white_noise(const EffectInstance &e) { return is_white(e.effect->info()); }
  static bool finds_white_noise(const Finding &f) { return is_white(f.effect->info()); }
  /// V rms of a channel above the expected noise, where a white noise has a name.
  double white_v() const {
    const bool any = std::any_of(seen_random_.begin(), seen_random_.end(), is_white_noise);
    const double left = last_.heldout.residual_rms_v;
    return any ? std::sqrt(std::max(0.0, left * left - noise_ * noise_)) : 0.0;
  }

  /// V rms of a channel that a motion without a reference leaves over: it was found as a smooth
  /// curve through the pair's own angles, and what it misses lies across the vector only.
  double motion_v() const {
    if (scene_.has_reference || scene_.radius_only)
      return 0.0;
    const NoiseShape &n = out_.noise;
    return std::sqrt(0.5 * std::max(0.0, n.across_v * n.across_v - n.along_v * n.along_v));
  }

  /// Takes out what the named random causes account for. White noise is what has no structure:
  /// where much of it has, it is no cause of its own.
  void drop_what_is_random() {
    const double accounted = std::hypot(random_v(), white_v());
    const bool noise_only = white_v() > 0.0;
    const auto too_much = [&](const Structure &s) {
      return (s.along == "angle" || s.along == "frequency") &&
             s.rms_v > criteria::kOfRandom * accounted;
    };
    if (noise_only && std::any_of(out_.structure.begin(), out_.structure.end(), too_much)) {
      std::erase_if(recorded_, is_white_noise);
      std::erase_if(random_, finds_white_noise);
      std::erase_if(seen_random_, is_white_noise);
    }
    drop_processes_that_leave_more();
    std::erase_if(out_.structure, [&](const Structure &s) {
      const bool in_time =
          s.along == axis_name(Axis::time) || s.along == axis_name(Axis::frequency);
      return s.rms_v < criteria::kOfProcess * random_v(in_time);
    });
  }

  /// A process that accounts for less than what goes on in time beside it, its own half waves
  /// aside, is no cause: what switches between two states, say, has a slow part, too.
  void drop_processes_that_leave_more() {
    const auto leaves_more = [&](const auto &named) {
      const EffectInfo &info = named.effect->info();
      if (info.character != Character::process || info.evidence == Evidence::noise)
        return false;
      const double v = process_v(info, named.values);
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

  /// Step of the reference, rad; 0: none was seen.
  double reference_step_rad() const {
    double step = 0.0;
    for (const ScreenFinding &f : scene_.screened)
      step = std::max(step, f.effect->reference_step_rad(f.values));
    return step;
  }

  /// What the named model leaves of the axes, where held-out data confirm it and it is worth a
  /// word.
  void note_unnamed() {
    const double noise = std::sqrt(unnamed_.selection.noise_v2);
    const double steps_v2 = std::max(0.0, unnamed_.selection.steps_v2);
    for (Structure &step : unnamed_steps(unnamed_, out_.extended))
      if (step.rms_v > criteria::kWorthAWord * noise)
        out_.structure.push_back(std::move(step));
    const double least = std::max(criteria::kWorthAWord * noise, criteria::kOfProcess * motion_v());
    for (BudgetLine line : out_.budget) {
      // How a supply that is only inferred goes with the time is its own affair.
      if (found_.disturbed == Direction::supply &&
          (line.axis == Axis::time || line.axis == Axis::frequency))
        continue;
      if (line.axis == Axis::time) // the steps have sentences of their own
        line.unnamed_rms_v =
            std::sqrt(std::max(0.0, line.unnamed_rms_v * line.unnamed_rms_v - steps_v2));
      if (line.axis != Axis::noise && line.unnamed_rms_v > least)
        out_.structure.push_back({std::string(axis_name(line.axis)),
                                  unnamed_sentence(line, unnamed_.selection, scene_),
                                  line.unnamed_rms_v});
    }
  }

  void note_what_stands_out() {
    const auto n = static_cast<double>(scene_.all.size() + scene_.spiked.size());
    const double rms = no_spikes_.rms_v * std::sqrt(static_cast<double>(no_spikes_.count) / n);
    if (no_spikes_.count == 0 || rms < criteria::kWorthAWord * floor())
      return;
    out_.structure.push_back(
        {std::string(axis_name(no_spikes_.place_rad ? Axis::angle : Axis::time)),
         fmt::format(
             "{} of {:.0f} samples stand out of the noise by {:.3g} mV rms, {}", no_spikes_.count,
             n, 1e3 * no_spikes_.rms_v,
             no_spikes_.place_rad
                 ? fmt::format("at the same places in the turn, most of them about {:.0f} deg",
                               *no_spikes_.place_rad * kDegPerRad)
                 : "several in a row"),
         rms});
  }

  bool supply_is_inferred() const {
    return found_.supply_rms_fraction > 0.0 ||
           (freed_ && freed_->has_vdd() && !given_.has_vdd() && has(out_.extended, follows_supply));
  }

  void note_invisible(const Effect &effect) {
    const ResidualColumns none;
    const Residual facts =
        residual_view(scene_, scene_.all, none, noise_, out_.extended.baseline.amplitude_v);
    std::string why = effect.invisible(facts);
    if (why.empty() && scene_.lag_in_zeros && is_common_delay(effect.info()))
      why = "each capture has one speed and a zero angle of its own, which holds the delay";
    if (why.empty() && scene_.radius_only && needs_motion(effect))
      why = "without a reference, and with a shaft that turns unevenly, only the radius is judged";
    if (!why.empty())
      out_.invisible.push_back({std::string(effect.info().id), why});
  }

  /// Puts the parts together.
  void conclude() {
    out_.radius_only = scene_.radius_only;
    report_moved_offsets();
    out_.baseline = ladder_.baseline;
    const auto given = with_given_remainder(ladder_.baseline);
    out_.baseline_quality = given ? parts_.rung(*given) : first_;
    out_.extended_quality = last_;
    out_.ladder = std::move(ladder_.models);
    out_.findings = screened_findings();
    for (std::optional<Finding> *finding : {&spikes_, &ladder_.supply})
      if (*finding)
        out_.findings.push_back(std::move(**finding));
    std::move(ladder_.findings.begin(), ladder_.findings.end(), std::back_inserter(out_.findings));
    std::move(random_.begin(), random_.end(), std::back_inserter(out_.findings));
    if (free_lag_)
      for (Model *m : {&out_.baseline, &out_.extended})
        std::erase_if(m->effects,
                      [](const EffectInstance &e) { return is_common_delay(e.effect->info()); });
    for (EffectInstance &e : recorded_)
      out_.extended.effects.push_back(std::move(e));
    if (has(out_.extended, follows_supply))
      out_.extended.vdd_reference_v = vdd_level_v();
    out_.extended.noise_rms_v = last_.in_sample.residual_rms_v;
    out_.extended.provenance = provenance_of(worked_on(), last_);
    for (const Effect *effect : catalogue())
      note_invisible(*effect);
    out_.verdict = verdict();
  }

  /// The model of all that has a name against the best that names nothing. Structure is what of
  /// that the named model leaves over, and what a last look still sees. What a given model names
  /// counts as what was just found does.
  Verdict verdict() const {
    const bool named = !out_.findings.empty() || given_explains();
    if (out_.structure.empty())
      return named ? Verdict::explained : Verdict::no_discrepancy;
    return named ? Verdict::partly_explained : Verdict::unexplained;
  }

  /// Whether the given model's causes are at work here: one that changes what is random or recorded
  /// was seen, or those of the signal make held-out data likelier than a sensor without them.
  bool given_explains() const {
    if (!named_before_ || named_before_->effects.empty())
      return false;
    const bool random = std::any_of(seen_random_.begin(), seen_random_.end(),
                                    [&](const EffectInstance &e) { return given(e.effect); });
    if (given_seen_ || random)
      return true;
    const Model bare = fit(parts_.train, first_model(scene_, nullptr), 6).model;
    const double nats =
        (ladder_.first.heldout.log_likelihood - parts_.rung(bare).heldout.log_likelihood) *
        static_cast<double>(parts_.heldout.size());
    return nats > criteria::kAdmittedNats;
  }

  const Capture &given_;
  std::optional<Capture> freed_; ///< of a supply that was not recorded
  const DiagnosisOptions &options_;
  std::optional<Model> named_before_; ///< the given model, as far as it has names
  Scene scene_;
  std::optional<Scene> judge_;
  Diagnosis out_;
  Parts parts_;
  SearchResult found_;
  Ladder ladder_;
  Anonymous unnamed_; ///< what the named model leaves over
  Rung named_;        ///< of the model of all that has a name
  std::optional<Finding> spikes_;
  decltype(Spikes::no_spikes) no_spikes_;
  std::vector<RandomCause> processes_; ///< whose courses are out of the data
  std::vector<Finding> random_;
  std::vector<EffectInstance>
      seen_random_; ///< the causes of these, and those that the given model names
  Rung first_;      ///< of the baseline, spikes and all
  Rung last_;       ///< of the extended model, with what noise causes take out
  std::vector<EffectInstance>
      recorded_;                      ///< causes that the extended model names but never corrects
  std::vector<Structure> angle_left_; ///< what the last look kept of the angle
  double noise_ = 0.0, explained_noise_ = 0.0;
  bool noise_stated_ = false, free_lag_ = false;
  double slow_v2_ = 0.0;    ///< of the largest slow process that has a name, V^2
  int slow_waves_ = 0;      ///< half waves by which the course of a slow process was taken out
  bool in_bursts_ = false;  ///< samples in a row are left over
  bool given_seen_ = false; ///< a cause that the given model names was seen before any fit
};

bool is_of_motion(const Finding &f) {
  return f.effect->info().stage == Stage::motion && f.effect->info().evidence == Evidence::signal;
}

/// Whether a reading that names a ripple of the shaft and leaves something over says no more of the
/// sensor than one by the radius alone, which leaves nothing: then the shaft turns unevenly, and
/// not by that ripple.
bool is_the_shafts_alone(const Diagnosis &with_ripple, const Diagnosis &by_radius) {
  if (!by_radius.structure.empty() ||
      std::none_of(with_ripple.findings.begin(), with_ripple.findings.end(), is_of_motion))
    return false;
  return std::all_of(with_ripple.findings.begin(), with_ripple.findings.end(),
                     [&](const Finding &f) {
                       return is_of_motion(f) ||
                              std::any_of(by_radius.findings.begin(), by_radius.findings.end(),
                                          [&](const Finding &g) { return g.effect == f.effect; });
                     });
}

} // namespace

std::string_view verdict_name(Verdict verdict) {
  switch (verdict) {
  case Verdict::no_discrepancy:
    return "no-discrepancy";
  case Verdict::explained:
    return "explained";
  case Verdict::partly_explained:
    return "partly-explained";
  case Verdict::unexplained:
    return "unexplained";
  case Verdict::insufficient_data:
    break;
  }
  return "insufficient-data";
}

Diagnosis diagnose(const Capture &capture, const DiagnosisOptions &given) {
  // Rows that repeat a reading are none.
  if (const auto fresh = fresh_readings(capture)) {
    Diagnosis out = diagnose(fresh->capture, given);
    out.samples = capture.size();
    out.rows_a_reading = fresh->rows_a_reading;
    out.held_reference = fresh->of_reference;
    return out;
  }
  DiagnosisOptions options = given;
  std::optional<FreshReadings> judge;
  if (given.heldout && (judge = fresh_readings(*given.heldout)))
    options.heldout = &judge->capture;
  int steps = 0; // of all searches: their number is not known before the last
  if (given.progress)
    options.progress = [&](double, const char *what) {
      given.progress(1.0 - 1.0 / (1.0 + 0.05 * ++steps), what);
    };
  const auto run = [&](bool guess) {
    struct {
      Diagnosis out;
      bool in_vain, doubtful;
      RadiusLeft left;
    } result;
    Work work(capture, options, guess);
    result.out = work.run();
    result.in_vain = work.guessed_in_vain();
    result.doubtful = work.may_blame_the_sensor_for_the_motion();
    if (result.doubtful)
      result.left = work.radius_left();
    return result;
  };
  bool guess = true;
  auto first = run(guess);
  if (first.in_vain)
    first = run(guess = false);
  if (!first.doubtful)
    return std::move(first.out);
  // The motion gives nothing to the radius: that says which of the two readings is the better one.
  Work apart(capture, options, guess, &first.out.extended);
  Diagnosis out = apart.run();
  if (out.verdict == Verdict::insufficient_data)
    return std::move(first.out);
  const double left_v = apart.radius_left().rms_v;
  const bool better =
      criteria::kRadiusWorse * left_v < first.left.rms_v ||
      (left_v < criteria::kRadiusWorse * first.left.rms_v && is_the_shafts_alone(first.out, out));
  return better ? std::move(out) : std::move(first.out);
}

} // namespace ada

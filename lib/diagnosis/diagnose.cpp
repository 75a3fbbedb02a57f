// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/diagnose.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <iterator>
#include <limits>
#include <utility>

#include "base/angle.h"
#include "diagnosis/candidates.h"
#include "diagnosis/first_model.h"
#include "diagnosis/ladder.h"
#include "diagnosis/leftovers.h"
#include "diagnosis/moments.h"
#include "diagnosis/noise_causes.h"
#include "diagnosis/parts.h"
#include "diagnosis/search.h"
#include "diagnosis/unseen_supply.h"

namespace ada {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
/// A residual this far above the noise is worth a thorough search.
constexpr double kAboveNoise = 1.25;
constexpr std::size_t kSearchTrain = 30000, kSearchHeldout = 15000;
/// For the last fits; more only narrow errors that are far below anything physical.
constexpr std::size_t kFitTrain = 160000, kFitHeldout = 80000;

std::string now_utc() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(
                                                  std::chrono::system_clock::now())));
}

void describe_capture(const Capture &capture, const Scene &scene, Diagnosis &d) {
  d.samples = capture.size();
  d.duration_s = capture.size() > 1 ? capture.time_s.back() - capture.time_s.front() : 0.0;
  d.turns = scene.turns;
  d.periods_per_turn = scene.periods;
  d.channels = {"vsin_v", "vcos_v"};
  if (capture.has_vtemp())
    d.channels.push_back("vtemp_v");
  if (capture.has_vdd())
    d.channels.push_back("vdd_v");
  if (capture.has_reference())
    d.channels.push_back("reference_deg");
  d.has_reference = capture.has_reference();
}

/// The parts of a diagnosis that work on one pair of training and held-out data.
class Work {
public:
  /// `guess`: a supply that is not recorded may be read off the radius first.
  Work(const Capture &capture, const DiagnosisOptions &options, bool guess)
      : given_(capture), freed_(guess ? with_unseen_supply(capture) : std::nullopt),
        options_(options), scene_(prepare(worked_on(), options.heldout == nullptr)) {
    if (options.heldout)
      judge_ = prepare(*options.heldout, false);
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
    free_vtemp();
    search_causes(scene_.has_reference);
    if (offsets_moved()) {
      judge_->all.own_offsets = true;
      search_causes(scene_.has_reference);
    }
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
      const Model known = found_.fit.model;
      Scene again = prepare(worked_on(), options_.heldout == nullptr, &known);
      if (!again.insufficient.empty())
        break;
      if (scene_.radius_only)
        judge_radius_only(again);
      scene_ = std::move(again);
      search_causes(false);
    }
    if (!scene_.has_reference && (!found_.order.empty() || found_.supply_rms_fraction > 0.0))
      search_causes(true);
    if (!scene_.has_reference && found_.supply_rms_fraction > 0.0 && !supply_accounts_for_radius())
      found_.supply_rms_fraction = 0.0;
    for (Observations *o : {&scene_.all, &scene_.spiked}) {
      o->disturbed = found_.disturbed;
      o->weight_along = found_.weight_along;
    }
    found_.fit.model = with_exact_moments(scene_, found_.fit.model, 0);
    take(build_ladder(parts_, found_));
    first_ = ladder_.first;
    noise_causes();
    angle_left_ = keep_for_last_look(scene_, out_.extended, floor());
    look_at_leftovers();
    drop_doubtful();
    conclude();
    return out_;
  }

  /// Whether a supply was read off the radius that the search then did not confirm.
  bool guessed_in_vain() const {
    return freed_ && freed_->has_vdd() && !given_.has_vdd() &&
           !has(out_.extended, "supply-variation");
  }

private:
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

  double floor() const { return std::max(noise_, scene_.white_noise_v); }

  void search_causes(bool thorough) {
    const Scene &judge = options_.heldout ? *judge_ : scene_;
    parts_.has_reference = scene_.has_reference;
    parts_.second_capture = judge_.has_value();
    parts_.train = scene_.all.select(thin(scene_.train, kFitTrain));
    parts_.heldout =
        options_.heldout ? judge.all : scene_.all.select(thin(scene_.heldout, kFitHeldout));
    Model start = first_model(scene_, options_.baseline);
    // Without a reference the angle is the pair's own, lag and all: a common delay is free.
    free_lag_ = !scene_.has_reference && (scene_.several_speeds || scene_.both_directions) &&
                !has(start, "propagation-delay");
    if (free_lag_)
      start.effects.push_back({find_effect("propagation-delay"), {0.0}, {}});
    SearchData data{&scene_, scene_.all.select(thin(scene_.train, kSearchTrain)),
                    options_.heldout ? judge.all
                                     : scene_.all.select(thin(scene_.heldout, kSearchHeldout)),
                    &judge};
    Search search(std::move(data), start, noise_, options_.progress);
    found_ = search.run(thorough);
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
      if (f.effect == find_effect("stuck-channel")) {
        out_.reason = f.explanation + " Beyond that: " + out_.reason;
        out_.findings.push_back(std::move(f));
      }
  }

  bool given(const Effect *effect) const {
    return options_.baseline &&
           std::any_of(options_.baseline->effects.begin(), options_.baseline->effects.end(),
                       [&](const EffectInstance &e) { return e.effect == effect; });
  }

  /// What the first look found, before any fit.
  std::vector<Finding> screened_findings() {
    std::vector<Finding> out;
    for (const ScreenFinding &f : scene_.screened) {
      // Spikes are measured against the final model.
      if (f.effect == find_effect("impulse-noise") || given(f.effect))
        continue;
      // Without a reference the ends of a burst jump as well.
      if (in_bursts_ && !scene_.has_reference &&
          (f.effect == find_effect("sample-loss") || f.effect == find_effect("angle-slip")))
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

  /// Whether a supply that only the radius shows accounts for what the radius does. Otherwise it
  /// would hide what nothing explains.
  bool supply_accounts_for_radius() const {
    constexpr double kMore = 1.5;
    const Observations &data = parts_.heldout;
    const ResidualColumns r = residual_columns(data, found_.fit.model);
    double radial2 = 0.0, reach2 = 0.0;
    for (std::size_t i = 0; i < data.size(); ++i) {
      const double s = r.model_sin[i] - data.mid_v, c = r.model_cos[i] - data.mid_v;
      const double square = std::max(s * s + c * c, 1e-12);
      const double radial = r.sin[i] * s + r.cos[i] * c;
      const double reach = data.vsin[i] * s + data.vcos[i] * c;
      radial2 += radial * radial / square;
      reach2 += reach * reach / square;
    }
    const double n = static_cast<double>(std::max<std::size_t>(1, data.size()));
    const double f = found_.supply_rms_fraction;
    return radial2 / n < kMore * (floor() * floor() + f * f * reach2 / n);
  }

  void noise_causes() {
    spikes();
    excess_noise();
  }

  void spikes() {
    const Spikes spikes = spikes_against(scene_, out_.extended, scene_.heldout, floor());
    if (!spikes.found)
      return;
    // Those that no first look took out have bent the fits.
    const Rung with = ladder_.first;
    leave_out(spikes.hit);
    take(build_ladder(parts_, found_));
    if (given(find_effect("impulse-noise")))
      return;
    Finding finding{find_effect("impulse-noise"),
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

  static bool has(const Model &model, std::string_view id) {
    return std::any_of(model.effects.begin(), model.effects.end(),
                       [&](const EffectInstance &e) { return e.effect->info().id == id; });
  }

  /// Only white noise on both channels alike is called so.
  void excess_noise() {
    sigma_ = rms_in_any_direction(parts_.train, out_.extended, scene_.has_reference);
    if (!noise_stated_ || supply_is_inferred())
      return;
    const double white = scene_.white_noise_v;
    const double excess2 = sigma_ * sigma_ - noise_ * noise_;
    const double known =
        options_.baseline && options_.baseline->noise_rms_v ? *options_.baseline->noise_rms_v : 0.0;
    if (sigma_ < 1.06 * std::max(noise_, known) || white * white < noise_ * noise_ + 0.5 * excess2)
      return;
    const double excess = std::sqrt(excess2);
    if (excess < second_order_floor(out_.extended, found_))
      return;
    Rung before = last_;
    // Under the noise that was stated, against the noise that is there.
    const auto under = [&](const Observations &data) {
      const double n = static_cast<double>(data.size());
      return -std::log(kTwoPi * noise_ * noise_) -
             0.5 * sum_of_squares(data, out_.extended) / (n * noise_ * noise_);
    };
    before.in_sample.log_likelihood = under(parts_.train);
    before.heldout.log_likelihood = under(parts_.heldout);
    const double error =
        sigma_ * sigma_ / excess / std::sqrt(4.0 * static_cast<double>(parts_.train.size()));
    Finding finding{
        find_effect("excess-noise"), {excess}, {error}, {}, {}, {}, before, last_, false};
    excess_ = recorded(std::move(finding));
    explained_noise_ = sigma_;
  }

  void look_at_leftovers() {
    const Explained explained{explained_noise_ > 0.0 ? explained_noise_ : noise_,
                              second_order_floor(out_.extended, found_), noise_stated_,
                              supply_is_inferred()};
    LeftOver left = left_over(scene_, parts_, out_.extended, explained, last_, angle_left_);
    out_.structure = std::move(left.structure);
    out_.unexplained_rms_v = left.unexplained_rms_v;
    in_bursts_ = left.bursts;
  }

  /// Residual rms of a channel as it is, without what a supply that is not recorded does.
  double rms_of_all() const {
    Observations plain = parts_.heldout;
    if (plain.disturbed != Direction::supply)
      plain.weight_along = 1.0;
    const double n = static_cast<double>(std::max<std::size_t>(1, plain.size()));
    return std::sqrt(sum_of_squares(plain, out_.extended) / (2.0 * n));
  }

  bool supply_is_inferred() const {
    return found_.supply_rms_fraction > 0.0 || (freed_ && freed_->has_vdd() && !given_.has_vdd() &&
                                                has(out_.extended, "supply-variation"));
  }

  void note_invisible(const Effect &effect) {
    const ResidualColumns none;
    const Residual facts =
        residual_view(scene_, scene_.all, none, noise_, out_.extended.baseline.amplitude_v);
    std::string why = effect.invisible(facts);
    if (why.empty() && scene_.radius_only && moves_the_angle(effect))
      why = "without a reference, and with a shaft that turns unevenly, only the radius is judged";
    if (!why.empty())
      out_.invisible.push_back({std::string(effect.info().id), why});
  }

  void withdraw(std::optional<Finding> &finding) {
    if (!finding)
      return;
    std::erase_if(recorded_, [&](const EffectInstance &e) { return e.effect == finding->effect; });
    finding.reset();
  }

  /// Noise is not judged beside what nothing explains, nor spikes that hardly stand out of it, nor
  /// a cause that explains little beside it: what remains is fitted without them.
  void drop_doubtful() {
    if (!out_.structure.empty() || supply_is_inferred()) {
      withdraw(excess_);
      if (spikes_ && spikes_->values[1] < 15.0 * rms_of_all())
        withdraw(spikes_);
    }
    double left = supply_is_inferred() ? 2.0 * out_.unexplained_rms_v : 0.0;
    for (const Structure &s : out_.structure)
      left = std::max(left, s.rms_v);
    // What follows a supply is judged again with others gone. What is left over grows with each
    // that goes, and is no reason to give up the next.
    constexpr int kMost = 3;
    for (int pass = 0; pass < kMost && drop_little(pass == 0 ? left : 0.0); ++pass)
      ;
  }

  /// Drops what explains little beside what is `left`, or beside a supply; false when nothing does.
  bool drop_little(double left) {
    constexpr double kLeastOfNoise = 0.06;
    // What follows a supply a little way gains where it was looked for, and nowhere else.
    const double least = ladder_.supply ? kLeastOfNoise * floor() : 0.0;
    std::vector<std::size_t> small;
    for (std::size_t i = 0; i < ladder_.findings.size(); ++i) {
      const double before = ladder_.findings[i].before.heldout.residual_rms_v;
      const double after = ladder_.findings[i].after.heldout.residual_rms_v;
      const double gain = before * before - after * after;
      if ((ladder_.supply && gain < least * least) ||
          (left > 0.0 && before != after && gain < 4.0 * left * left))
        small.push_back(i);
    }
    if (small.empty())
      return false;
    for (std::size_t i : std::vector(small.rbegin(), small.rend()))
      found_.forget(i);
    take(build_ladder(parts_, found_));
    out_.structure.clear();
    look_at_leftovers();
    return true;
  }

  /// Puts the parts together.
  void conclude() {
    report_moved_offsets();
    out_.baseline = ladder_.baseline;
    out_.baseline_quality = first_;
    out_.extended_quality = last_;
    out_.ladder = std::move(ladder_.models);
    out_.findings = screened_findings();
    for (std::optional<Finding> *finding : {&spikes_, &ladder_.supply})
      if (*finding)
        out_.findings.push_back(std::move(**finding));
    std::move(ladder_.findings.begin(), ladder_.findings.end(), std::back_inserter(out_.findings));
    if (excess_)
      out_.findings.push_back(std::move(*excess_));
    if (free_lag_)
      for (Model *m : {&out_.baseline, &out_.extended})
        std::erase_if(m->effects, [](const EffectInstance &e) {
          return e.effect->info().id == "propagation-delay";
        });
    for (EffectInstance &e : recorded_)
      out_.extended.effects.push_back(std::move(e));
    out_.extended.noise_rms_v = last_.in_sample.residual_rms_v;
    add_provenance();
    for (const Effect *effect : catalogue())
      note_invisible(*effect);
    const bool unexplained = !out_.structure.empty(), found = !out_.findings.empty();
    out_.verdict = found ? (unexplained ? Verdict::partly_explained : Verdict::explained)
                         : (unexplained ? Verdict::unexplained : Verdict::no_discrepancy);
  }

  void add_provenance() {
    Provenance &p = out_.extended.provenance;
    const Capture &capture = worked_on();
    p.serial = capture.meta.serial;
    p.date = now_utc();
    p.method = "diagnose";
    p.capture_identity = capture.identity;
    p.generator = std::string("libada4571 ") + ADA4571_VERSION_STRING;
    p.gain_control = capture.meta.gain_control;
    p.fit_residual_rms_v = last_.in_sample.residual_rms_v;
    p.heldout_residual_rms_v = last_.heldout.residual_rms_v;
    if (capture.has_vtemp()) {
      p.vtemp_min_v = *std::min_element(capture.vtemp_v.begin(), capture.vtemp_v.end());
      p.vtemp_max_v = *std::max_element(capture.vtemp_v.begin(), capture.vtemp_v.end());
    }
  }

  const Capture &given_;
  std::optional<Capture> freed_; ///< of a supply that was not recorded
  const DiagnosisOptions &options_;
  Scene scene_;
  std::optional<Scene> judge_;
  Diagnosis out_;
  Parts parts_;
  SearchResult found_;
  Ladder ladder_;
  std::optional<Finding> spikes_, excess_;
  Rung first_; ///< of the baseline, spikes and all
  Rung last_;  ///< of the extended model, with what noise causes take out
  std::vector<EffectInstance>
      recorded_;                      ///< causes that the extended model names but never corrects
  std::vector<Structure> angle_left_; ///< what the last look kept of the angle
  double noise_ = 0.0, sigma_ = 0.0, explained_noise_ = 0.0;
  bool noise_stated_ = false, free_lag_ = false;
  bool in_bursts_ = false; ///< samples in a row are left over
};

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

Diagnosis diagnose(const Capture &capture, const DiagnosisOptions &options) {
  {
    Work work(capture, options, true);
    Diagnosis out = work.run();
    if (!work.guessed_in_vain())
      return out;
  }
  return Work(capture, options, false).run();
}

} // namespace ada

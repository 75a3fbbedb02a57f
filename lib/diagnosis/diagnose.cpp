// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/diagnose.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <limits>
#include <numeric>
#include <utility>

#include "base/angle.h"
#include "conversion/angle_solver.h"
#include "diagnosis/candidates.h"
#include "diagnosis/explain.h"
#include "diagnosis/moments.h"
#include "diagnosis/noise_causes.h"
#include "diagnosis/robust.h"
#include "diagnosis/search.h"
#include "diagnosis/unseen_supply.h"
#include "diagnosis/whiteness.h"
#include "model/effect_text.h"
#include "model/forward.h"

namespace ada {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr std::size_t kSearchTrain = 30000, kSearchHeldout = 15000;
/// For the last fits; more only narrow errors that are far below anything physical.
constexpr std::size_t kFitTrain = 160000, kFitHeldout = 80000;
/// For the last look at what is left over: a few long runs.
constexpr std::size_t kLookedAt = 300000, kLookedAtRun = 25000;

/// Noise that the capture should have: what it states, with the converter's steps on top; without
/// a statement what the data show from sample to sample.
double expected_noise(const Capture &capture, const Scene &scene, bool &stated) {
  stated = capture.meta.noise_rms_v.has_value();
  if (!stated)
    return scene.white_noise_v;
  double variance = *capture.meta.noise_rms_v * *capture.meta.noise_rms_v;
  if (capture.meta.adc_bits && capture.meta.adc_reference_v) {
    const double lsb = *capture.meta.adc_reference_v / std::exp2(*capture.meta.adc_bits);
    variance += lsb * lsb / 12.0;
  }
  return std::max(std::sqrt(variance), 1e-9);
}

/// Amplitude, offsets and zero angle that start the fit.
Model first_model(const Scene &scene, const Model *given) {
  Model model;
  if (given) {
    model = given->at_supply(scene.supply_v);
    model.baseline_std_error = {0, 0, 0, 0};
  }
  model.periods_per_turn = scene.periods;
  model.supply_v = scene.supply_v;
  if (!given)
    model.vtemp_reference_v = scene.vtemp_mean_v;
  bool turned = false;
  for (const EffectInstance &e : model.effects)
    turned = turned || e.effect->info().evidence == Evidence::screening;
  // Wiring is settled before any fit; a screened effect without action on the pair does nothing.
  for (const ScreenFinding &f : scene.screened)
    if (f.effect->info().correctable && !turned)
      model.effects.insert(model.effects.begin(), {f.effect, f.values, f.std_errors});

  const auto span_of = [](const std::vector<double> &v) {
    return std::pair(quantile(v, 0.005), quantile(v, 0.995));
  };
  const auto [slow, shigh] = span_of(scene.all.vsin);
  const auto [clow, chigh] = span_of(scene.all.vcos);
  Baseline &b = model.baseline;
  if (!given) {
    b.amplitude_v = 0.25 * (shigh - slow + chigh - clow);
    b.offset_sin_v = 0.5 * (shigh + slow - scene.supply_v);
    b.offset_cos_v = 0.5 * (chigh + clow - scene.supply_v);
  }
  // The zero angle by the mean turn from the model without it to the data.
  b.angle_zero_deg = 0.0;
  Model plain = model;
  std::erase_if(plain.effects, [](const EffectInstance &e) {
    return e.effect->info().evidence == Evidence::signal;
  });
  const auto some = scene.all.select(thin(scene.train, 5000));
  const ResidualColumns r = residual_columns(some, plain);
  double c = 0.0, s = 0.0;
  const double ms = 0.5 * scene.supply_v + b.offset_sin_v,
               mc = 0.5 * scene.supply_v + b.offset_cos_v;
  for (std::size_t i = 0; i < some.size(); ++i) {
    const double x = r.model_cos[i] - mc, y = r.model_sin[i] - ms;
    const double u = some.vcos[i] - mc, v = some.vsin[i] - ms;
    c += u * x + v * y;
    s += v * x - u * y;
  }
  double turn = std::atan2(s, c);
  for (const EffectInstance &e : plain.effects) // a reversed pair turns the other way
    if (e.effect->info().correctable)
      turn = -turn;
  b.angle_zero_deg = turn * kDegPerRad / scene.periods;
  return model;
}

/// RMS error of the corrected angle on these samples against the magnet's angle: the reference,
/// with what the model knows to be wrong with the reference and the drive.
std::optional<double> angle_error(const Scene &scene, const Observations &data,
                                  const Model &model) {
  if (!scene.has_reference || data.size() == 0)
    return std::nullopt;
  const AngleSolver solver(model);
  Conditions at = data.conditions();
  std::vector<double> alpha = data.alpha, radius(data.size());
  std::vector<double> magnet(data.size());
  ForwardModel(model, AlphaIs::reference).magnet_angle(at, magnet.data());
  solver.start(data.vsin, data.vcos, alpha);
  const double period = kTwoPi / scene.periods;
  for (std::size_t i = 0; i < alpha.size(); ++i)
    alpha[i] += period * std::round((magnet[i] - alpha[i]) / period);
  solver.solve(at, data.vsin, data.vcos, alpha, radius);
  double sum = 0.0;
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    const double e = wrap_centred(alpha[i] - magnet[i], period);
    sum += e * e;
  }
  return std::sqrt(sum / static_cast<double>(alpha.size())) * kDegPerRad;
}

Quality quality(const Scene &scene, const Observations &data, const Model &model, double train_rms,
                bool with_angle) {
  Quality q;
  const double n = static_cast<double>(data.size());
  if (n == 0.0)
    return q;
  const double rss = sum_of_squares(data, model);
  q.residual_rms_v = std::sqrt(rss / (2.0 * n));
  const double sigma = train_rms > 0.0 ? train_rms : q.residual_rms_v;
  q.log_likelihood = std::log(data.weight_along) - std::log(kTwoPi * sigma * sigma) -
                     0.5 * rss / (n * sigma * sigma);
  if (with_angle)
    q.angle_error_rms_deg = angle_error(scene, data, model);
  return q;
}

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
  Work(const Capture &capture, const DiagnosisOptions &options)
      : given_(capture), with_supply_(with_unseen_supply(capture)),
        capture_(with_supply_ ? *with_supply_ : capture), options_(options),
        scene_(prepare(capture_, options.heldout == nullptr)) {
    if (options.heldout)
      judge_ = prepare(*options.heldout, false);
  }

  Diagnosis run() {
    describe_capture(given_, scene_, out_);
    out_.baseline_name = options_.baseline_name;
    if (!usable())
      return std::move(out_);
    noise_ = expected_noise(capture_, scene_, noise_stated_);
    out_.noise_rms_v = noise_;
    search_causes();
    // Without a reference what was found bent the motion as well: with it taken out look again, as
    // long as that leaves less over.
    constexpr int kMostLooks = 4;
    double before = kInfinite;
    for (int look = 1; !scene_.has_reference && look < kMostLooks; ++look) {
      const double now = found_.residual_rms_v;
      if (found_.order.empty() || now > 0.97 * std::exchange(before, now))
        break;
      const Model known = found_.fit.model;
      Scene again = prepare(capture_, options_.heldout == nullptr, &known);
      if (!again.insufficient.empty())
        break;
      scene_ = std::move(again);
      search_causes();
    }
    weigh_as(found_);
    ladder();
    noise_causes();
    leftovers();
    verdict();
    return std::move(out_);
  }

private:
  void search_causes() {
    const Scene &judge = options_.heldout ? *judge_ : scene_;
    train_ = scene_.all.select(thin(scene_.train, kFitTrain));
    heldout_ = options_.heldout ? judge.all : scene_.all.select(thin(scene_.heldout, kFitHeldout));
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
    found_ = search.run();
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

  /// A disturbance that is not recorded changes how residuals are weighed from here on; a supply
  /// counts as a finding and so only from its own rung on.
  void weigh_as(const SearchResult &found) {
    for (Observations *o : {&train_, &heldout_, &scene_.all}) {
      o->disturbed = found.disturbed;
      o->weight_along = found.disturbed == Direction::supply ? 1.0 : found.weight_along;
    }
  }

  Rung rung(const Model &model) {
    Rung r;
    r.in_sample = quality(scene_, train_, model, 0.0, true);
    const Scene &judge = judge_ ? *judge_ : scene_;
    r.heldout = quality(judge, heldout_, judge_ ? with_own_zero(heldout_, model) : model,
                        r.in_sample.residual_rms_v, true);
    return r;
  }

  void add_screened(const Rung &at) {
    for (const ScreenFinding &f : scene_.screened) {
      if (f.effect == find_effect("impulse-noise")) // measured against the final model
        continue;
      const bool given =
          options_.baseline &&
          std::any_of(options_.baseline->effects.begin(), options_.baseline->effects.end(),
                      [&](const EffectInstance &e) { return e.effect == f.effect; });
      if (given)
        continue;
      Finding finding{f.effect,
                      f.values,
                      f.std_errors,
                      f.alternatives,
                      {},
                      {},
                      at,
                      at,
                      f.effect->info().correctable};
      if (!f.effect->info().correctable)
        recorded_.push_back({f.effect, f.values, f.std_errors});
      finish(finding);
    }
  }

  void finish(Finding &finding) {
    finding.separate_by = separation(*finding.effect, finding.alternatives);
    finding.explanation = explanation(finding);
    out_.findings.push_back(std::move(finding));
  }

  /// The effect of a fitted model that this is a less fitted version of.
  static const EffectInstance *same_instance(const Model &model, const EffectInstance &e) {
    for (const EffectInstance &o : model.effects)
      if (repeats(o, e))
        return &o;
    return nullptr;
  }

  /// From the baseline up, one finding at a time in the order of their size, each rung fitted to
  /// the training part and judged on the rest.
  void ladder() {
    FitResult final_fit = fit(train_, with_exact_moments(scene_, found_.fit.model, 0), 5);
    attach_errors(final_fit);
    Model model = final_fit.model;
    Model bare = model;
    std::vector<std::size_t> drop = found_.order;
    std::sort(drop.rbegin(), drop.rend());
    for (std::size_t k : drop)
      bare.effects.erase(bare.effects.begin() + static_cast<std::ptrdiff_t>(k));
    Model step = fit(train_, bare, 6).model;
    out_.baseline = step;
    out_.ladder.push_back(step);
    Rung before = rung(step);
    out_.baseline_quality = before;
    add_screened(before);
    for (std::size_t i = 0; i < found_.order.size(); ++i) {
      const EffectInstance &e = model.effects[found_.order[i]];
      step.effects.push_back(e);
      // Everything else starts where the whole model has it: a clipping bends the baseline far.
      step.baseline = model.baseline;
      for (std::size_t k = 0; k < step.effects.size(); ++k)
        if (const EffectInstance *last = same_instance(model, step.effects[k]))
          step.effects[k].values = last->values;
      step = i + 1 == found_.order.size() ? model : fit(train_, step, 5).model;
      const Rung after = rung(step);
      out_.ladder.push_back(step);
      Finding finding{e.effect, e.values, e.std_errors, found_.alternatives[i],      {},
                      {},       before,   after,        e.effect->info().correctable};
      finish(finding);
      before = after;
    }
    last_ = before;
    out_.extended = model;
  }

  void noise_causes() {
    if (found_.supply_rms_fraction > 0.0) {
      const Effect *effect = find_effect("supply-variation");
      const double f = found_.supply_rms_fraction;
      Rung after = last_;
      if (found_.disturbed == Direction::supply)
        train_.weight_along = heldout_.weight_along = found_.weight_along;
      after = rung(out_.extended);
      Finding finding{effect, {f},   {f / std::sqrt(2.0 * static_cast<double>(train_.size()))},
                      {},     {},    {},
                      last_,  after, false};
      last_ = after;
      finish(finding);
    }
    spikes();
    excess_noise();
  }

  void spikes() {
    const double floor = std::max(noise_, scene_.white_noise_v);
    const Spikes spikes = spikes_against(scene_, out_.extended, scene_.heldout, floor);
    if (!spikes.found)
      return;
    leave_out(spikes.hit);
    const Rung clean = rung(out_.extended);
    Finding finding{find_effect("impulse-noise"),
                    {spikes.rate, spikes.amplitude_v},
                    {spikes.rate_error, spikes.amplitude_error_v},
                    {},
                    {},
                    {},
                    last_,
                    clean,
                    false};
    last_ = clean;
    if (options_.baseline && has(*options_.baseline, "impulse-noise"))
      return;
    finding.before.heldout.log_likelihood = spikes.before;
    finding.after.heldout.log_likelihood = spikes.after;
    recorded_.push_back({finding.effect, finding.values, finding.std_errors});
    finish(finding);
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
    train_ = select(train_, rest(thin(scene_.train, kFitTrain)));
    if (!judge_)
      heldout_ = select(heldout_, rest(thin(scene_.heldout, kFitHeldout)));
  }

  static bool has(const Model &model, std::string_view id) {
    return std::any_of(model.effects.begin(), model.effects.end(),
                       [&](const EffectInstance &e) { return e.effect->info().id == id; });
  }

  /// Only white noise on both channels alike is called so.
  void excess_noise() {
    sigma_ = rms_in_any_direction(train_, out_.extended, scene_.has_reference);
    if (!noise_stated_ || supply_is_inferred())
      return;
    const double white = scene_.white_noise_v;
    const double excess2 = sigma_ * sigma_ - noise_ * noise_;
    const double known =
        options_.baseline && options_.baseline->noise_rms_v ? *options_.baseline->noise_rms_v : 0.0;
    if (sigma_ < 1.06 * std::max(noise_, known) || white * white < noise_ * noise_ + 0.5 * excess2)
      return;
    const double excess = std::sqrt(excess2);
    Rung before = last_;
    // Under the noise that was stated, against the noise that is there.
    const auto under = [&](const Observations &data) {
      const double n = static_cast<double>(data.size());
      return -std::log(kTwoPi * noise_ * noise_) -
             0.5 * sum_of_squares(data, out_.extended) / (n * noise_ * noise_);
    };
    before.in_sample.log_likelihood = under(train_);
    before.heldout.log_likelihood = under(heldout_);
    const double error =
        sigma_ * sigma_ / excess / std::sqrt(4.0 * static_cast<double>(train_.size()));
    Finding finding{
        find_effect("excess-noise"), {excess}, {error}, {}, {}, {}, before, last_, false};
    recorded_.push_back({finding.effect, finding.values, finding.std_errors});
    finish(finding);
    explained_noise_ = sigma_;
  }

  void leftovers() {
    out_.extended_quality = last_;
    drop_spikes();
    const ResidualColumns residual = residual_columns(scene_.all, out_.extended);
    if (free_lag_)
      for (Model *m : {&out_.baseline, &out_.extended})
        std::erase_if(m->effects, [](const EffectInstance &e) {
          return e.effect->info().id == "propagation-delay";
        });
    out_.extended.noise_rms_v = last_.in_sample.residual_rms_v;
    for (EffectInstance &e : recorded_)
      out_.extended.effects.push_back(std::move(e));
    Provenance &p = out_.extended.provenance;
    p.serial = capture_.meta.serial;
    p.date = now_utc();
    p.method = "diagnose";
    p.capture_identity = capture_.identity;
    p.generator = std::string("libada4571 ") + ADA4571_VERSION_STRING;
    p.gain_control = capture_.meta.gain_control;
    p.fit_residual_rms_v = last_.in_sample.residual_rms_v;
    p.heldout_residual_rms_v = last_.heldout.residual_rms_v;
    if (capture_.has_vtemp()) {
      p.vtemp_min_v = *std::min_element(capture_.vtemp_v.begin(), capture_.vtemp_v.end());
      p.vtemp_max_v = *std::max_element(capture_.vtemp_v.begin(), capture_.vtemp_v.end());
    }
    for (const Effect *effect : catalogue())
      note_invisible(*effect);

    // Whiteness is judged on everything that no cause took out, held out or not.
    const double floor = explained_noise_ > 0.0 ? explained_noise_ : noise_;
    const double sigma =
        std::min(last_.in_sample.residual_rms_v, std::max(floor, scene_.white_noise_v));
    // A supply that is only inferred leaves its fast part over.
    const bool inferred = supply_is_inferred();
    if (!inferred)
      out_.structure =
          find_structure(scene_, scene_.all, residual, sigma, 0.12 * sigma + second_order_floor());
    const double rest2 =
        last_.heldout.residual_rms_v * last_.heldout.residual_rms_v - floor * floor;
    out_.unexplained_rms_v = rest2 > 0.0 ? std::sqrt(rest2) : 0.0;
    if (out_.structure.empty() && !inferred && noise_stated_ &&
        (scene_.has_reference
             ? last_.heldout.residual_rms_v
             : rms_in_any_direction(heldout_, out_.extended, false)) > 1.15 * floor)
      out_.structure.push_back({"time",
                                "the residual is larger than the stated noise, yet not white "
                                "noise of both channels",
                                out_.unexplained_rms_v});
  }

  /// Residual rms of a channel as it is, however residuals are weighed.
  double rms_of_all() const {
    Observations plain = heldout_;
    plain.weight_along = 1.0;
    const double n = static_cast<double>(std::max<std::size_t>(1, plain.size()));
    return std::sqrt(sum_of_squares(plain, out_.extended) / (2.0 * n));
  }

  bool supply_is_inferred() const {
    return found_.supply_rms_fraction > 0.0 || (with_supply_ && with_supply_->has_vdd());
  }

  /// Leaves only the samples that no spike stands out of, for the last look.
  void drop_spikes() {
    std::vector<std::uint32_t> some(scene_.all.size());
    std::iota(some.begin(), some.end(), 0u);
    scene_.all.keep(thin(some, kLookedAt, kLookedAtRun));
    const ResidualColumns r = residual_columns(scene_.all, out_.extended);
    std::vector<char> hit(scene_.all.size(), 0);
    std::vector<std::size_t> places;
    for (const auto *v : {&r.sin, &r.cos}) {
      find_spikes(*v, 6.0, std::max(noise_, scene_.white_noise_v), places);
      for (std::size_t i : places)
        hit[i] = 1;
    }
    std::vector<std::uint32_t> keep;
    for (std::size_t i = 0; i < hit.size(); ++i)
      if (!hit[i])
        keep.push_back(static_cast<std::uint32_t>(i));
    scene_.all.keep(keep);
    if (!scene_.has_reference)
      scene_.all = at_own_angle(std::move(scene_.all), out_.extended);
  }

  /// Products of what was found are not modelled to the last term.
  double second_order_floor() const {
    double largest =
        std::hypot(out_.extended.baseline.offset_sin_v, out_.extended.baseline.offset_cos_v);
    double sum = 0.0;
    for (double c : found_.contribution)
      sum += c;
    const double a = out_.extended.baseline.amplitude_v;
    return std::min(0.3 * sum * (sum + largest) / a, 5e-4 * a);
  }

  void note_invisible(const Effect &effect) {
    const ResidualColumns none;
    const Residual facts =
        residual_view(scene_, scene_.all, none, noise_, out_.extended.baseline.amplitude_v);
    const std::string why = effect.invisible(facts);
    if (!why.empty())
      out_.invisible.push_back({std::string(effect.info().id), why});
  }

  /// Takes a finding that is not believed out of a model.
  static void forget(const Finding &finding, Model &model) {
    for (std::size_t k = 0; k < model.effects.size(); ++k)
      if (model.effects[k].effect == finding.effect &&
          (finding.values.empty() || model.effects[k].values[0] == finding.values[0] ||
           finding.effect->info().parameters[0].role == Role::fitted)) {
        model.effects.erase(model.effects.begin() + static_cast<std::ptrdiff_t>(k));
        return;
      }
  }

  void verdict() {
    // Noise is not judged beside what nothing explains, nor spikes that hardly stand out of it,
    const bool open = !out_.structure.empty() || supply_is_inferred();
    const double rest = rms_of_all();
    if (open)
      std::erase_if(out_.findings, [&](const Finding &f) {
        const bool doubtful =
            f.effect == find_effect("excess-noise") ||
            (f.effect == find_effect("impulse-noise") && f.values[1] < 15.0 * rest);
        if (doubtful)
          forget(f, out_.extended);
        return doubtful;
      });
    // nor a cause that explains little beside it.
    double left = supply_is_inferred() ? 2.0 * out_.unexplained_rms_v : 0.0;
    for (const Structure &s : out_.structure)
      left = std::max(left, s.rms_v);
    if (left > 0.0)
      std::erase_if(out_.findings, [&](const Finding &f) {
        const double gain2 = f.before.heldout.residual_rms_v * f.before.heldout.residual_rms_v -
                             f.after.heldout.residual_rms_v * f.after.heldout.residual_rms_v;
        if (f.effect->info().evidence != Evidence::signal ||
            f.before.heldout.residual_rms_v == f.after.heldout.residual_rms_v ||
            gain2 >= 4.0 * left * left)
          return false;
        for (Model &m : out_.ladder)
          forget(f, m);
        forget(f, out_.extended);
        return true;
      });
    const bool unexplained = !out_.structure.empty(), found = !out_.findings.empty();
    out_.verdict = found ? (unexplained ? Verdict::partly_explained : Verdict::explained)
                         : (unexplained ? Verdict::unexplained : Verdict::no_discrepancy);
  }

  const Capture &given_;
  const std::optional<Capture> with_supply_;
  const Capture &capture_; ///< the one of both that is worked on
  const DiagnosisOptions &options_;
  Scene scene_;
  std::optional<Scene> judge_;
  Diagnosis out_;
  Observations train_, heldout_;
  SearchResult found_;
  Rung last_;
  std::vector<EffectInstance>
      recorded_; ///< causes that the extended model names but never corrects
  double noise_ = 0.0, sigma_ = 0.0, explained_noise_ = 0.0;
  bool noise_stated_ = false, free_lag_ = false;
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
  return Work(capture, options).run();
}

} // namespace ada

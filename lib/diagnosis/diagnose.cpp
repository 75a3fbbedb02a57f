// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/diagnose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/angle.h"
#include "base/parallel.h"
#include "base/plain_numbers.h"
#include "diagnosis/conditions/alternation.h"
#include "diagnosis/conditions/between_captures.h"
#include "diagnosis/conditions/episodes.h"
#include "diagnosis/conditions/held_rows.h"
#include "diagnosis/conditions/pair_alone.h"
#include "diagnosis/conditions/reference_course.h"
#include "diagnosis/conditions/stop_means.h"
#include "diagnosis/criteria.h"
#include "diagnosis/next_experiments.h"
#include "diagnosis/search/admission.h"
#include "diagnosis/search/fit.h"
#include "diagnosis/words/explain.h"
#include "diagnosis/work.h"
#include "health/even_rows.h"
#include "health/reference_share.h"

namespace ada {

namespace {

bool is_of_motion(const Finding &f) {
  return f.effect->info().stage == Stage::motion && f.effect->info().evidence == Evidence::signal;
}

/// What naming a cause took off, V rms.
double taken_off_v(const Finding &f) {
  const double before = f.before.in_sample.residual_rms_v, after = f.after.in_sample.residual_rms_v;
  return std::sqrt(std::max(0.0, before * before - after * after));
}

/// Whether a reading that leaves something over says less of the sensor than one by the radius
/// alone: it names less, and no ripple of the shaft beside it; or the other leaves nothing, and
/// what more it says is a ripple of the shaft that is smaller than what is left. Then the shaft
/// turns unevenly, and not by that ripple. One that is larger is what the shaft does, and the rest
/// is what it does besides.
bool is_the_shafts_alone(const Diagnosis &with_motion, const Diagnosis &by_radius) {
  if (with_motion.structure.empty())
    return false;
  double left_v = 0.0;
  for (const Structure &s : with_motion.structure)
    left_v = std::max(left_v, s.rms_v);
  std::size_t ripples = 0;
  for (const Finding &f : with_motion.findings) {
    if (is_of_motion(f)) {
      if (taken_off_v(f) > left_v)
        return false;
      ++ripples;
    } else if (std::none_of(by_radius.findings.begin(), by_radius.findings.end(),
                            [&](const Finding &g) { return g.effect == f.effect; })) {
      return false;
    }
  }
  return ripples > 0 ? by_radius.structure.empty()
                     : by_radius.findings.size() > with_motion.findings.size();
}

bool holds_tone(const Model *model) {
  return model && std::any_of(model->effects.begin(), model->effects.end(),
                              [](const EffectInstance &e) { return is_tone(e.effect->info()); });
}

/// A result without an alternation of the rows, and the tone that this is, named first.
Diagnosis with_alternation(const Alternation &seen, Diagnosis out) {
  const Effect &tone = the_effect(is_tone);
  Finding f;
  f.effect = &tone;
  f.values = {seen.frequency_hz, seen.sin_v, seen.cos_v, 0.0, seen.opposed ? 180.0 : 0.0};
  f.std_errors = {seen.frequency_error_hz, seen.sin_error_v, seen.cos_error_v, 0.0, 0.0};
  f.before = f.after = out.baseline_quality;
  put_in_words(f);
  out.findings.insert(out.findings.begin(), std::move(f));
  if (out.verdict == Verdict::no_discrepancy)
    out.verdict = Verdict::explained;
  return out;
}

/// A diagnosis of readings whose reference has the degrees of the pair.
Diagnosis diagnose_readings(const Capture &capture, const DiagnosisOptions &given) {
  DiagnosisOptions options = given;
  // A model that has such a tone says what the rows are displaced by.
  if (!holds_tone(given.baseline))
    if (const auto seen = large_alternation(capture)) {
      std::optional<Alternation> of_judge;
      if (given.heldout && (of_judge = large_alternation(*given.heldout)))
        options.heldout = &of_judge->without;
      return with_alternation(*seen, diagnose_readings(seen->without, options));
    }
  const auto run = [&](bool guess) {
    struct {
      Diagnosis out;
      bool in_vain, followed, doubtful;
      RadiusLeft left;
    } result;
    Work work(capture, options, guess);
    result.out = work.run();
    result.in_vain = work.guessed_in_vain();
    result.followed = work.names_what_the_motion_follows();
    result.doubtful = result.followed || work.may_blame_the_sensor_for_the_motion();
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
      first.followed || criteria::kRadiusWorse * left_v < first.left.rms_v ||
      (left_v < criteria::kRadiusWorse * first.left.rms_v && is_the_shafts_alone(first.out, out));
  return better ? std::move(out) : std::move(first.out);
}

/// What no cause has a name for is left over.
Diagnosis left_over(Structure what, Diagnosis out) {
  if (out.verdict == Verdict::no_discrepancy)
    out.verdict = Verdict::unexplained;
  else if (out.verdict == Verdict::explained)
    out.verdict = Verdict::partly_explained;
  out.structure.push_back(std::move(what));
  std::stable_sort(out.structure.begin(), out.structure.end(),
                   [](const Structure &a, const Structure &b) { return a.rms_v > b.rms_v; });
  return out;
}

/// A result without a course of the reference, and the course.
Diagnosis with_course(const ReferenceCourse &course, Diagnosis out) {
  out.reference_course = course;
  const double left_v = course.rms_rad * out.periods_per_turn *
                        std::abs(out.extended.baseline.amplitude_v) / std::numbers::sqrt2;
  out.unexplained_rms_v = std::hypot(out.unexplained_rms_v, left_v);
  return left_over({std::string(axis_name(Axis::time)), in_words(course), left_v}, std::move(out));
}

/// A result of the pair by itself, and why a reference is none: that of the capture, which had one,
/// or of the second one. `left_v`: what it leaves over of each channel.
Diagnosis with_reference_aside(const std::string &why, bool has_reference, double left_v,
                               Diagnosis out) {
  out.reference_aside = why;
  out.has_reference = has_reference;
  if (has_reference)
    out.channels.push_back("reference_deg");
  if (out.verdict == Verdict::insufficient_data)
    return out;
  return left_over({std::string(axis_name(Axis::angle)), why, left_v}, std::move(out));
}

/// Nats of a diagnosis on held-out data, less the price of the causes that it names; of data that
/// say nothing, less than any.
double worth(const Diagnosis &d) {
  if (d.verdict == Verdict::insufficient_data)
    return -std::numeric_limits<double>::infinity();
  constexpr double kHeldOut = 1.0 / 3.0; // of the samples, or a second capture as long
  double out =
      kHeldOut * static_cast<double>(d.samples) * d.extended_quality.heldout.log_likelihood;
  for (const EffectInstance &e : d.extended.effects)
    out -= penalty(e);
  return out;
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

namespace {

/// A diagnosis of rows that are readings, whose reference is that of the shaft where there is one.
Diagnosis diagnose_by_reference(const Capture &capture, const DiagnosisOptions &given) {
  DiagnosisOptions options = given;
  // What each stop has for itself no other stop confirms; the same ones in a second capture may.
  const auto stops = means_of_stops(capture);
  if (stops && !options.heldout) {
    options.reference_errs = true;
    Diagnosis out = diagnose_by_reference(stops->means, options);
    options.reference_errs = given.reference_errs;
    out.samples = capture.size();
    out.readings_a_stop =
        static_cast<double>(capture.size()) / static_cast<double>(stops->means.size());
    if (out.verdict != Verdict::insufficient_data)
      return with_stops(*stops, stops->errs_v, std::move(out));
  }
  int steps = 0; // of all searches: their number is not known before the last
  if (given.progress)
    options.progress = [&](double, const char *what) {
      given.progress(1.0 - 1.0 / (1.0 + 0.05 * ++steps), what);
    };
  std::optional<FollowedReference> followed_of_judge;
  if (options.heldout && (followed_of_judge = followed_reference(*options.heldout)))
    options.heldout = &followed_of_judge->mended;
  const auto followed = followed_reference(capture);
  if (!followed) {
    Diagnosis out = diagnose_readings(capture, options);
    if (!stops)
      return out;
    const double left_v = left_at_stops(*stops, out.extended_quality.heldout.residual_rms_v);
    return with_stops(*stops, left_v, std::move(out));
  }
  // What has a name may say the same, or more: a slip, a lag, an error once a turn.
  Diagnosis as_read = diagnose_readings(capture, options);
  Diagnosis mended = diagnose_readings(followed->mended, options);
  // What they explain down to the noise needs no course beside them, unless with it fewer do.
  const bool enough =
      as_read.structure.empty() && as_read.findings.size() <= mended.findings.size();
  const double course = criteria::kNatsPerCoordinate * followed->course.numbers;
  if (mended.verdict == Verdict::insufficient_data ||
      (enough && as_read.verdict != Verdict::insufficient_data) ||
      worth(mended) - course <= worth(as_read))
    return as_read;
  return with_course(followed->course, std::move(mended));
}

} // namespace

namespace {

/// What the stamps of rows that were read evenly are off by.
Structure of_stamps(const EvenRows &even) {
  return {std::string(axis_name(Axis::time)),
          fmt::format("the time stamps scatter by {:.3g} s rms about an even clock, and the pair "
                      "goes on evenly from row to row: they say when a row was delivered, and not "
                      "when it was read; its time is taken from its number",
                      even.rms_s),
          even.rms_v};
}

/// By how much the angle of a model departs from a reference, rms, rad of the shaft. The model gets
/// the zero angle that suits it best.
double off_reference_rad(const Observations &data, Model &model) {
  model = as_seen_by(data, std::move(model));
  const ResidualColumns r = residual_columns(data, model);
  double squares = 0.0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double s = r.model_sin[i] - data.centre_sin_v, c = r.model_cos[i] - data.centre_cos_v;
    squares += std::pow((r.sin[i] * c - r.cos[i] * s) / std::max(s * s + c * c, 1e-12), 2);
  }
  return std::sqrt(squares / static_cast<double>(data.size())) / model.periods_per_turn;
}

/// Whether all that every pair has is named, and clear of its error.
bool names_what_every_pair_has(const Diagnosis &d) {
  return std::ranges::all_of(catalogue(), [&](const Effect *effect) {
    return effect->info().prior_rank != 0 || std::ranges::any_of(d.findings, [&](const Finding &f) {
             return f.effect == effect && !f.std_errors.empty() &&
                    std::abs(f.values[0]) > 2.0 * f.std_errors[0];
           });
  });
}

/// Whether something else is named.
bool names_more(const Diagnosis &d) {
  return std::ranges::any_of(d.findings,
                             [](const Finding &f) { return f.effect->info().prior_rank != 0; });
}

/// The pair by itself, where a reference that wanders hides what the length of the vector shows:
/// what is left lies along the figure, what every pair has is not found beside it, and the pair
/// alone tells it, without an angle that departs from the reference any further.
std::optional<Diagnosis> beside_wandering_reference(const Capture &capture,
                                                    const DiagnosisOptions &options,
                                                    const Diagnosis &by_reference) {
  constexpr double kAlongFigure = 4.0; // what is left, over what lies off the figure
  if (!capture.has_reference() || options.heldout || options.baseline ||
      by_reference.verdict == Verdict::insufficient_data ||
      by_reference.verdict == Verdict::no_discrepancy ||
      by_reference.verdict == Verdict::explained || names_more(by_reference) ||
      names_what_every_pair_has(by_reference))
    return std::nullopt;
  const double off_figure_v = off_own_figure_v(capture);
  if (!(by_reference.extended_quality.heldout.residual_rms_v > kAlongFigure * off_figure_v))
    return std::nullopt;
  Diagnosis alone = diagnose_by_reference(without_reference(capture), options);
  if (alone.verdict == Verdict::insufficient_data || !names_what_every_pair_has(alone))
    return std::nullopt;
  const Scene scene = prepare(capture, false);
  if (!scene.insufficient.empty())
    return std::nullopt;
  const Observations data = scene.all.select(thin(scene.train, criteria::kRemainderSamples));
  Model other = by_reference.extended;
  const double off = off_reference_rad(data, alone.extended);
  if (!(off < criteria::kNoWorse * off_reference_rad(data, other)))
    return std::nullopt;
  alone.turns = by_reference.turns;
  const double left_v = off * capture.meta.periods_per_turn *
                        std::abs(alone.extended.baseline.amplitude_v) / std::numbers::sqrt2;
  const std::string why =
      fmt::format("the reference departs from the pair by {:.3g} deg rms, which nothing that "
                  "repeats with the angle takes off, while the pair keeps to its ellipse to {:.3g} "
                  "mV: the reference "
                  "wanders, or a coupling or the magnet moves on the shaft",
                  off * kDegPerRad, 1e3 * off_figure_v);
  return with_reference_aside(why, true, left_v, std::move(alone));
}

/// The same as why_of_no_shaft(), whatever the pair does in episodes that are not the sensor's.
std::string why_of_no_shaft_beside_episodes(const Capture &capture) {
  std::string why = why_of_no_shaft(capture);
  std::vector<char> usable(why.empty() ? 0 : capture.size(), 1);
  if (why.empty() || leave_out_episodes(capture, usable).samples == 0)
    return why;
  Capture rest = capture;
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (!usable[i])
      rest.vsin_v[i] = rest.vcos_v[i] = std::numeric_limits<double>::quiet_NaN();
  return why_of_no_shaft(rest);
}

Diagnosis diagnose_rows(const Capture &capture, const DiagnosisOptions &given) {
  DiagnosisOptions options = given;
  std::optional<FreshReadings> judge;
  if (options.heldout && (judge = fresh_readings(*options.heldout)))
    options.heldout = &judge->capture;
  // Rows that repeat a reading are none.
  if (const auto fresh = fresh_readings(capture)) {
    Diagnosis out = diagnose_rows(fresh->capture, options);
    out.samples = capture.size();
    out.rows_a_reading = fresh->rows_a_reading;
    out.held_reference = fresh->of_reference;
    return out;
  }
  // The two are judged alike.
  const std::string why = why_of_no_shaft_beside_episodes(capture),
                    of_judge = options.heldout ? why_of_no_shaft_beside_episodes(*options.heldout)
                                               : std::string();
  if (why.empty() && of_judge.empty()) {
    Diagnosis out = diagnose_by_reference(capture, options);
    const auto alone = beside_wandering_reference(capture, options, out);
    return alone ? *alone : out;
  }
  if (!draws_its_circle(capture)) // that may be the pair's fault, and is then said
    if (Diagnosis out = diagnose_by_reference(capture, options);
        why.empty() || out.verdict == Verdict::insufficient_data)
      return out;
  const Capture pair = without_reference(capture);
  std::optional<Capture> judging;
  if (options.heldout)
    options.heldout = &judging.emplace(without_reference(*options.heldout));
  Diagnosis out = diagnose_by_reference(pair, options);
  // Of two vectors that know nothing of each other each channel differs by the amplitude.
  const double left_v = std::abs(out.extended.baseline.amplitude_v);
  return with_reference_aside(!why.empty() ? why : "in the second capture " + of_judge,
                              capture.has_reference(), left_v, std::move(out));
}

} // namespace

namespace {

void write_numbers_plainly(Diagnosis &d) {
  const auto plainly = [](std::string &sentence) { sentence = in_plain_numbers(sentence); };
  plainly(d.reason);
  for (Finding &f : d.findings) {
    plainly(f.explanation);
    plainly(f.separate_by);
  }
  for (Structure &s : d.structure)
    plainly(s.description);
  for (Experiment &e : d.next_experiments)
    plainly(e.sentence);
}

} // namespace

Diagnosis diagnose(const Capture &given, const DiagnosisOptions &asked) {
  const Helpers helpers; // for the thousands of loops below
  const auto moved = in_step(given, asked.heldout);
  const Capture &read = moved ? moved->capture : given;
  DiagnosisOptions options = asked;
  if (moved && moved->heldout)
    options.heldout = &*moved->heldout;
  const std::optional<EvenRows> even = even_rows(read),
                                even_judge =
                                    options.heldout ? even_rows(*options.heldout) : std::nullopt;
  if (even_judge)
    options.heldout = &even_judge->capture;
  const Capture &capture = even ? even->capture : read;
  Diagnosis out = diagnose_rows(capture, options);
  if (even && out.verdict != Verdict::insufficient_data)
    out = left_over(of_stamps(*even), std::move(out));
  out.next_experiments = next_experiments(out, capture, [&] {
    if (options.progress)
      options.progress(1.0, "what to record next");
  });
  write_numbers_plainly(out);
  return out;
}

} // namespace ada

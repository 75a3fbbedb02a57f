// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Which calibration is enough: each is tried on captures that it has not seen, of the same sensor
// and of sensors that it has not seen either.

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "base/angle.h"
#include "study/summary.h"

namespace ada::study {

namespace {

constexpr std::size_t kFolds = 5, kLeastSensors = 10, kLeastCaptures = 5;
constexpr double kAsGood = 0.05; ///< a simpler one may be worse by this part
constexpr double kCommon = 0.5;  ///< a cause belongs to the model when so many captures have it

struct Try {
  const char *name;
  Calibration use;
  std::vector<std::string> effects;
};

const std::vector<Try> &tries() {
  static const std::vector<Try> all = {
      {"none", Calibration::none, {}},
      {"offsets", Calibration::offsets, {}},
      {"ellipse", Calibration::ellipse, {"amplitude-mismatch", "quadrature-error"}},
      {"ellipse and table to order 4",
       Calibration::table4,
       {"amplitude-mismatch", "quadrature-error", "periodic-remainder"}},
      {"ellipse and table to order 8",
       Calibration::table8,
       {"amplitude-mismatch", "quadrature-error", "periodic-remainder"}}};
  return all;
}

/// Angle errors of one kind of trial, a capture each; NaN where it was not tried.
using Errors = std::vector<double>;

double judged(const Member &row, const Signature &judge, int half, const Learned &learned,
              Calibration use) {
  return std::hypot(angle_rms_deg(judge, half, learned, use), row.noise_angle_deg);
}

Learned median_of(const std::vector<Learned> &all) {
  Learned out{};
  for (std::size_t k = 0; k < out.size(); ++k) {
    std::vector<double> x;
    for (const Learned &l : all)
      x.push_back(l[k]);
    out[k] = median(std::move(x));
  }
  return out;
}

/// Captures with a signature, by sensor.
struct Judges {
  std::vector<std::size_t> rows;
  std::map<std::size_t, std::vector<std::size_t>> of_sensor; ///< places in rows
  std::vector<Learned> learned;                              ///< from the whole capture
};

Judges judges_of(const Fleet &f) {
  Judges j;
  for (const std::size_t row : f.done)
    if (f.rows[row].has_signature()) {
      j.of_sensor[f.sensor[row]].push_back(j.rows.size());
      j.rows.push_back(row);
      j.learned.push_back(learn(f.rows[row].signature(), 2));
    }
  return j;
}

Errors on_other_half(const Fleet &f, const Judges &j, Calibration use) {
  Errors out;
  for (const std::size_t row : j.rows) {
    const Member &r = f.rows[row];
    const Signature s = r.signature();
    const double a = judged(r, s, 1, learn(s, 0), use);
    const double b = judged(r, s, 0, learn(s, 1), use);
    out.push_back(std::hypot(a, b) / std::numbers::sqrt2);
  }
  return out;
}

Errors on_other_capture(const Fleet &f, const Judges &j, Calibration use) {
  Errors out;
  for (const auto &[sensor, places] : j.of_sensor)
    for (std::size_t k = 0; places.size() > 1 && k < places.size(); ++k) {
      const Member &judge = f.rows[j.rows[places[(k + 1) % places.size()]]];
      out.push_back(judged(judge, judge.signature(), 2, j.learned[places[k]], use));
    }
  return out;
}

Errors on_new_sensors(const Fleet &f, const Judges &j, Calibration use) {
  Errors out;
  if (j.of_sensor.size() < kLeastSensors)
    return out;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    std::vector<Learned> seen;
    std::vector<std::size_t> unseen;
    std::size_t number = 0;
    for (const auto &[sensor, places] : j.of_sensor) {
      const bool out_of_fold = number++ % kFolds != fold;
      for (const std::size_t place : places)
        if (out_of_fold)
          seen.push_back(j.learned[place]);
        else
          unseen.push_back(place);
    }
    const Learned mean = median_of(seen);
    for (const std::size_t place : unseen) {
      const Member &judge = f.rows[j.rows[place]];
      out.push_back(judged(judge, judge.signature(), 2, mean, use));
    }
  }
  return out;
}

std::optional<double> typical(const Errors &e) {
  return e.empty() ? std::nullopt : std::optional(median(e));
}

/// The simplest that is as good as the best: within a part of it, or within one standard error of
/// the difference (Breiman et al. 1984, 3.4.3), which is taken capture by capture.
std::optional<std::size_t> simplest(const std::vector<Errors> &all) {
  if (all.empty() || all.front().size() < kLeastCaptures)
    return std::nullopt;
  std::size_t best = 0;
  for (std::size_t k = 1; k < all.size(); ++k)
    if (median(all[k]) < median(all[best]))
      best = k;
  for (std::size_t k = 0; k < best; ++k) {
    std::vector<double> worse;
    for (std::size_t i = 0; i < all[k].size(); ++i)
      worse.push_back(all[k][i] - all[best][i]);
    const double error =
        1.2533 * median_deviation(worse) / std::sqrt(static_cast<double>(worse.size()));
    if (median(worse) <= std::max(kAsGood * median(all[best]), error))
      return k;
  }
  return best;
}

/// The model of the diagnosis, each capture its own: judged on turns of the same capture that its fit
/// has not seen.
Candidate diagnosed(const Fleet &f, const std::vector<CauseSummary> &causes) {
  Candidate c{"diagnosis", {}, {}, {}, {}, {}};
  std::map<std::string, bool> correctable;
  Errors e;
  for (const std::size_t row : f.done) {
    if (std::isfinite(f.rows[row].extended_angle_rms_deg))
      e.push_back(f.rows[row].extended_angle_rms_deg);
    for (const MemberFinding &found : f.rows[row].findings)
      correctable[f.names[found.cause]] = found.correctable;
  }
  for (const CauseSummary &cause : causes)
    if (cause.share >= kCommon && correctable[cause.cause])
      c.effects.push_back(cause.cause);
  c.same_capture = typical(e);
  return c;
}

std::string sentence_of(const Sufficient &s) {
  if (!s.chosen)
    return fmt::format(
        "Which calibration is enough cannot be told: it takes {} captures or more "
        "with a reference angle, in each half of which the shaft makes a whole turn.",
        kLeastCaptures);
  const Candidate &c = s.candidates[*s.chosen];
  std::string out = fmt::format("Enough is: {}, learned for each sensor: it leaves {} deg rms.",
                                c.name, digits(*c.heldout));
  const Candidate &last = s.candidates.back();
  if (!last.heldout && last.same_capture && c.same_capture &&
      *last.same_capture < (1.0 - kAsGood) * *c.same_capture)
    out += fmt::format(" Within one capture the model of the {} leaves {} deg rms where this leaves "
                       "{}; it was not tried on another capture of the sensor.",
                       last.name, digits(*last.same_capture), digits(*c.same_capture));
  if (s.chosen_new) {
    const Candidate &n = s.candidates[*s.chosen_new];
    out += fmt::format(" One calibration for all sensors ({}) leaves {} deg rms on sensors that it "
                       "has not seen.",
                       n.name, digits(*n.new_sensor));
  }
  return out;
}

} // namespace

Sufficient find_sufficient(const Fleet &f, const std::vector<CauseSummary> &causes) {
  Sufficient out;
  const Judges j = judges_of(f);
  std::vector<Errors> own, fresh;
  bool across = false; // judged on another capture of the sensor
  for (const Try &t : tries()) {
    const Errors half = on_other_half(f, j, t.use), capture = on_other_capture(f, j, t.use);
    across = capture.size() >= kLeastCaptures;
    own.push_back(across ? capture : half);
    fresh.push_back(on_new_sensors(f, j, t.use));
    out.candidates.push_back({t.name, t.effects, typical(half), typical(capture),
                              typical(fresh.back()), typical(own.back())});
  }
  out.chosen = simplest(own);
  out.chosen_new = simplest(fresh);
  // Like is compared with like: what one capture says of itself is no match for a calibration that
  // was carried over to another.
  Candidate whole = diagnosed(f, causes);
  if (f.diagnosed && whole.same_capture) {
    if (!across)
      whole.heldout = whole.same_capture;
    if (out.chosen && whole.heldout &&
        *whole.heldout < (1.0 - kAsGood) * *out.candidates[*out.chosen].heldout)
      out.chosen = out.candidates.size();
    out.candidates.push_back(whole);
  }
  out.sentence = sentence_of(out);
  return out;
}

} // namespace ada::study

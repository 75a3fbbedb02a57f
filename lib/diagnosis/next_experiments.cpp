// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/next_experiments.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "base/angle.h"
#include "base/error.h"
#include "base/robust.h"
#include "diagnosis/admission.h"
#include "diagnosis/candidates.h"
#include "diagnosis/criteria.h"
#include "diagnosis/doubt.h"
#include "diagnosis/fit.h"
#include "diagnosis/search.h"
#include "simulation/simulation.h"

namespace ada {

namespace {

/// Whether the simulation can show it again: what happened once, or at random, it cannot.
bool comes_again(const EffectInfo &info) {
  return info.evidence == Evidence::signal && info.character != Character::event &&
         info.character != Character::process;
}

/// Two digits: nobody sets a motor to more.
double two_digits(double x) {
  const double unit = std::pow(10.0, std::floor(std::log10(x)) - 1.0);
  return std::round(x / unit) * unit;
}

/// What the bench of a capture can do.
struct Bench {
  double rate_hz, top_rpm, noise_v;
  bool vtemp, vdd, reference;
};

std::optional<Bench> bench_of(const Diagnosis &d, const Capture &capture) {
  constexpr double kSlowest = 1.0;        // rpm
  constexpr double kASample = 1.0 / 16.0; // of an electrical period
  const std::size_t n = capture.size();
  const double span_s = n > 1 ? capture.time_s.back() - capture.time_s.front() : 0.0;
  if (!(span_s > 0.0) || !(d.fastest_rad_s > 0.0))
    return {};
  Bench out{static_cast<double>(n - 1) / span_s,
            0.0,
            d.extended_quality.heldout.residual_rms_v,
            capture.has_vtemp(),
            capture.has_vdd(),
            d.by_reference()};
  const double seen = 60.0 * d.fastest_rad_s / kTwoPi,
               followed = 60.0 * out.rate_hz * kASample / d.periods_per_turn;
  out.top_rpm = two_digits(std::min(seen, followed));
  if (!(out.noise_v > 0.0) || !(out.top_rpm >= kSlowest))
    return {};
  return out;
}

struct Program {
  std::string motion, temperature;
  double duration_s;
  std::string words; ///< what one does to the shaft
};

/// The simplest first.
std::vector<Program> programs_for(double top_rpm, int periods, bool heat) {
  constexpr double kSlower = 3.0; // speeds that are told apart, and that the same drive makes
  constexpr double kPeriods = 12.0, kShortest_s = 2.0, kLongest_s = 120.0;
  constexpr double kSteadyTurns = 60.0; // of which even time tells the ripples of a reference
  const double v = top_rpm, u = two_digits(v / kSlower);
  // Each leg at the slower speed shows a turn, and some periods.
  const double leg_s = 60.0 / u * std::max(1.0, kPeriods / periods);
  const auto program = [&](double legs, std::string motion, std::string words) {
    const double s = std::clamp(std::ceil(leg_s * legs), kShortest_s, kLongest_s);
    return Program{std::move(motion), "constant:deg_c=25", s, std::move(words)};
  };
  const double steady_legs = std::max(2.0, kSteadyTurns * 60.0 / v / leg_s);
  std::vector<Program> out = {
      program(steady_legs, fmt::format("constant:rpm={:g}", v),
              fmt::format("steadily at {:g} rpm", v)),
      program(2, fmt::format("steps:rpm={:g}/{:g}", v, -v),
              fmt::format("at {:g} rpm in one direction, then in the other", v)),
      program(2, fmt::format("steps:rpm={:g}/{:g}", u, v),
              fmt::format("at {:g} rpm, then at {:g} rpm", u, v)),
      program(4, fmt::format("steps:rpm={0:g}/{1:g}/{3:g}/{2:g}", u, v, -u, -v),
              fmt::format("at {:g} rpm and at {:g} rpm in both directions", u, v)),
  };
  if (heat) {
    out.push_back(out.back());
    out.back().temperature = "ramp:from=0,to=60";
    out.back().words += ", while it warms by tens of degrees";
  }
  return out;
}

/// Its rows by simulation, and how many rows of the real one stand for each.
struct Imagined {
  Capture capture;
  double rows_each;
};

Imagined imagine(const Program &program, const Bench &bench, const Model &truth) {
  constexpr double kRows = 2400.0; // shapes are known by fewer than sizes are
  SimulationOptions o;
  o.duration_s = program.duration_s;
  o.sample_rate_hz = std::min(bench.rate_hz, kRows / program.duration_s);
  o.noise_rms_v = bench.noise_v;
  o.adc_bits = 0;
  o.motion = program.motion;
  o.temperature = program.temperature;
  o.has_vtemp = bench.vtemp;
  o.has_vdd = bench.vdd;
  o.has_reference = bench.reference;
  constexpr std::uint64_t kSeed = 1; // the same answer at each call
  return {Simulation(truth, o, kSeed).run(), bench.rate_hz / o.sample_rate_hz};
}

/// Nats by which such a capture speaks for the cause at `place` of the truth rather than for each
/// of its rivals; nothing: it would not tell anything.
std::vector<double> nats_against(const Imagined &imagined, const Model &truth, std::size_t place,
                                 const std::vector<const Effect *> &rivals) {
  const Scene scene = prepare(imagined.capture, false);
  if (!scene.insufficient.empty())
    return {};
  const FitResult self = fit(scene.all, truth);
  const FitResult less = fit(scene.all, truth.without(place));
  if (!self.determined || !less.determined || !(self.rss > 0.0))
    return {};
  const std::vector<Candidate> list = candidates(scene, scene.all, less.model, true);
  const SearchData aside{&scene, scene.all, scene.all, &scene};
  const double rows = static_cast<double>(scene.all.size()),
               beside_self = side_evidence(aside, self.model);
  const auto apart_v = [&](double rss) {
    return std::sqrt(std::max(0.0, rss - self.rss) / (2.0 * rows));
  };
  const Blur blur(scene, scene.all, self.model, place);
  std::vector<double> out;
  for (const Effect *rival : rivals) {
    double least = rows * imagined.rows_each * std::log(less.rss / self.rss) + beside_self -
                   side_evidence(aside, less.model);
    const auto take = [&](const Model &start) {
      const FitResult other = fit(scene.all, start);
      if (!other.determined || !in_range(other.model))
        return;
      const bool blurred =
          apart_v(other.rss) <= blur.left_by(other.model.effects.back(), apart_v(less.rss));
      const double by_pair =
          blurred ? 0.0 : rows * imagined.rows_each * std::log(other.rss / self.rss);
      least = std::min(least, by_pair + beside_self - side_evidence(aside, other.model));
    };
    for (const Candidate &c : list)
      if (c.effect == rival) {
        take(c.start);
        for (const auto &[gain, start] : c.others)
          take(start);
      }
    out.push_back(least);
  }
  return out;
}

/// What of the extended model the simulation can show again.
Model shown_again(const Model &extended) {
  Model out = extended;
  std::erase_if(out.effects,
                [](const EffectInstance &e) { return !comes_again(e.effect->info()); });
  out.remainder.reset();
  return out;
}

std::string in_words(const Experiment &e, const std::string &what_to_do) {
  return fmt::format(
      "turn the shaft {} for {:g} s{}: if it is {}, {} will describe that capture worse by some "
      "{:.0f} nats",
      what_to_do, e.duration_s,
      e.record.empty() ? "" : fmt::format(", and record {} as well", fmt::join(e.record, " and ")),
      e.separates.front(), fmt::join(e.separates.begin() + 1, e.separates.end(), " or "),
      two_digits(e.expected_nats));
}

/// Which program tells most rivals apart; of those, the first that does it half as clearly as the
/// best. Takes them out of `rivals`.
std::optional<Experiment> best_of(const std::vector<Program> &programs, const Bench &bench,
                                  const std::vector<std::string> &record, const Model &truth,
                                  std::size_t place, std::vector<const Effect *> &rivals) {
  constexpr double kAsClear = 0.5;
  // As much again as what is rejected: the next capture has a noise of its own.
  constexpr double kTellsApart = 2.0 * criteria::kRivalNats;
  struct Told {
    const Program *by = nullptr;
    std::vector<std::size_t> which;
    double least = 0.0;
  };
  std::vector<Told> all;
  for (const Program &p : programs) {
    Told told{&p, {}, 0.0};
    std::vector<double> nats;
    try {
      nats = nats_against(imagine(p, bench, truth), truth, place, rivals);
    } catch (const Error &) { // a model that says nothing of such a motion
      continue;
    }
    for (std::size_t k = 0; k < nats.size(); ++k)
      if (nats[k] >= kTellsApart) {
        told.least = told.which.empty() ? nats[k] : std::min(told.least, nats[k]);
        told.which.push_back(k);
      }
    all.push_back(std::move(told));
  }
  Told best;
  for (const Told &told : all)
    if (std::pair(told.which.size(), told.least) > std::pair(best.which.size(), best.least))
      best = told;
  if (best.which.empty())
    return {};
  for (const Told &told : all)
    if (told.which.size() == best.which.size() && told.least >= kAsClear * best.least) {
      best = told;
      break;
    }
  Experiment out{
      best.by->motion, best.by->temperature, best.by->duration_s, record, {}, best.least, {}};
  out.separates.emplace_back(truth.effects[place].effect->info().id);
  for (std::size_t k : best.which)
    out.separates.emplace_back(rivals[k]->info().id);
  for (auto k = best.which.rbegin(); k != best.which.rend(); ++k)
    rivals.erase(rivals.begin() + static_cast<std::ptrdiff_t>(*k));
  out.sentence = in_words(out, best.by->words);
  return out;
}

} // namespace

std::vector<Experiment> next_experiments(const Diagnosis &d, const Capture &capture) {
  constexpr std::size_t kMost = 3;
  std::vector<Experiment> out;
  const std::optional<Bench> bench = bench_of(d, capture);
  if (!bench)
    return out;
  const Model truth = shown_again(d.extended);
  for (const Finding &f : d.findings) {
    const auto self =
        std::find_if(truth.effects.begin(), truth.effects.end(), [&](const EffectInstance &e) {
          return e.effect == f.effect && e.values == f.values;
        });
    std::vector<const Effect *> rivals;
    for (const std::string &id : f.alternatives)
      if (const Effect *rival = find_effect(id); rival && comes_again(rival->info()))
        rivals.push_back(rival);
    if (self == truth.effects.end() || rivals.empty() || out.size() >= kMost)
      continue;
    const auto place = static_cast<std::size_t>(self - truth.effects.begin());
    const bool heat =
        f.effect->info().axis == "temperature" || std::ranges::any_of(rivals, [](const Effect *e) {
          return e->info().axis == "temperature";
        });
    const std::vector<Program> programs = programs_for(bench->top_rpm, d.periods_per_turn, heat);
    const auto add = [&](std::optional<Experiment> e) {
      if (e)
        out.push_back(std::move(*e));
    };
    add(best_of(programs, *bench, {}, truth, place, rivals));
    if (rivals.empty() || out.size() >= kMost)
      continue;
    Bench full = *bench;
    std::vector<std::string> record;
    const auto have = [&](bool &channel, const char *column) {
      if (!channel)
        record.emplace_back(column);
      channel = true;
    };
    have(full.reference, "reference_deg");
    have(full.vtemp, "vtemp_v");
    have(full.vdd, "vdd_v");
    if (!record.empty())
      add(best_of({programs.back()}, full, record, truth, place, rivals));
  }
  return out;
}

} // namespace ada

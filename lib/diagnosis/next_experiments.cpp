// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/next_experiments.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/criteria.h"
#include "diagnosis/search/admission.h"
#include "diagnosis/search/candidates.h"
#include "diagnosis/search/fit.h"
#include "diagnosis/search/identifiability.h"
#include "diagnosis/search/search.h"
#include "simulation/simulation.h"

namespace ada {

namespace {

/// Whether the simulation can show it again: what happened once, or at random, it cannot.
bool comes_again(const EffectInfo &info) {
  return info.evidence == Evidence::signal &&
         (is_tone(info) ||
          (info.character != Character::event && info.character != Character::process));
}

/// Two digits: nobody sets a motor to more.
double two_digits(
    double x, double (*whole)(double) = [](double y) { return std::round(y); }) {
  const double place = 1.0 - std::floor(std::log10(x)), unit = std::pow(10.0, std::abs(place));
  return place > 0.0 ? whole(x * unit) / unit : whole(x / unit) * unit;
}

/// Rows in which an electrical period must be seen to be followed.
constexpr double kRowsAPeriod = 16.0;

/// What the bench of a capture can do.
struct Bench {
  double rate_hz, top_rpm, noise_v, deg_c;
  bool vtemp, vdd, reference;
};

/// Of readings, not of rows that repeat them; a pause is none.
double rate_of(const Diagnosis &d, const Capture &capture) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < capture.size(); ++i)
    steps.push_back(capture.time_s[i] - capture.time_s[i - 1]);
  const double step = steps.empty() ? 0.0 : quantile(std::move(steps), 0.5);
  return step > 0.0 ? 1.0 / (step * d.rows_a_reading * d.readings_a_stop) : 0.0;
}

/// Temperature of a capture as the simulated VTEMP would have it.
double degrees_of(const Capture &capture) {
  constexpr double kRoom = 25.0, kColdest = -40.0, kHottest = 125.0; // of the simulated part
  if (!capture.has_vtemp())
    return kRoom;
  const double fraction = quantile(capture.vtemp_v, 0.5) / capture.meta.supply_v;
  const double deg_c = (fraction - kVtempFractionAtZero) / kVtempFractionPerDegree;
  return std::isfinite(deg_c) ? std::clamp(std::round(deg_c), kColdest, kHottest) : kRoom;
}

std::optional<Bench> bench_of(const Diagnosis &d, const Capture &capture) {
  constexpr double kSlowest = 1.0; // rpm
  const double rate_hz = rate_of(d, capture);
  if (!(rate_hz > 0.0) || !(d.fastest_rad_s > 0.0))
    return {};
  const double seen = 60.0 * d.fastest_rad_s / kTwoPi,
               followed = 60.0 * rate_hz / kRowsAPeriod / d.periods_per_turn,
               most = std::min(seen, followed);
  const Bench out{rate_hz,
                  two_digits(most, [](double x) { return std::floor(x); }),
                  d.extended_quality.heldout.residual_rms_v,
                  degrees_of(capture),
                  capture.has_vtemp(),
                  capture.has_vdd(),
                  d.by_reference()};
  if (!(out.noise_v > 0.0) || !(out.top_rpm >= kSlowest))
    return {};
  return out;
}

struct Program {
  std::string motion, temperature;
  double duration_s;
  double top_rpm;
  bool one_speed;
  std::string words; ///< what one does to the shaft
};

/// The simplest first.
std::vector<Program> programs_for(const Bench &bench, int periods, bool heat) {
  constexpr double kSlower = 3.0;  // speeds that are told apart, and that the same drive makes
  constexpr double kWarmer = 40.0; // degrees
  constexpr double kShortest_s = 0.1, kLongest_s = 120.0;
  // Electrical periods of a leg at the slower speed: a turn, unless that holds many. And of a
  // steady spin, whose even time tells the ripples of a reference.
  const double of_leg = std::max(12.0, std::min(1.0 * periods, 40.0)),
               of_spin = std::min(60.0 * periods, 600.0);
  const double v = bench.top_rpm, u = two_digits(v / kSlower);
  const auto seconds = [&](double electrical, double rpm) {
    const double s = 60.0 * electrical / periods / rpm;
    return std::clamp(two_digits(s, [](double x) { return std::ceil(x); }), kShortest_s,
                      kLongest_s);
  };
  const std::string at = fmt::format("constant:deg_c={:g}", bench.deg_c);
  const auto program = [&](double duration_s, std::string motion, std::string words) {
    const bool one_speed = motion.starts_with("constant");
    return Program{std::move(motion), at, duration_s, v, one_speed, std::move(words)};
  };
  std::vector<Program> out = {
      program(seconds(of_spin, v), fmt::format("constant:rpm={:g}", v),
              fmt::format("steadily at {:g} rpm", v)),
      program(seconds(2.0 * of_leg, u), fmt::format("steps:rpm={:g}/{:g}", u, v),
              fmt::format("at {:g} rpm, then at {:g} rpm", u, v)),
      program(seconds(2.0 * of_leg, u), fmt::format("steps:rpm={:g}/{:g}", v, -v),
              fmt::format("at {:g} rpm in one direction, then in the other", v)),
      program(seconds(4.0 * of_leg, u),
              fmt::format("steps:rpm={0:g}/{1:g}/{3:g}/{2:g}", u, v, -u, -v),
              fmt::format("at {:g} rpm and at {:g} rpm in both directions", u, v)),
  };
  if (heat) {
    out.push_back(out.back());
    out.back().temperature =
        fmt::format("ramp:from={:g},to={:g}", bench.deg_c, bench.deg_c + kWarmer);
    out.back().words += fmt::format(", while it warms by {:g} degrees", kWarmer);
  }
  return out;
}

/// Its rows by simulation, and how many rows of the real one stand for each; as the truth fits
/// them.
struct Imagined {
  Capture capture;
  double rows_each;
  Scene scene;
  FitResult self;
};

std::shared_ptr<const Imagined> imagine(const Program &program, const Bench &bench,
                                        const Model &truth) {
  constexpr double kRows = 2400.0; // shapes are known by fewer than sizes are
  // No whole number of rows a turn, which would show the same places only.
  constexpr double kUneven = 1.0137;
  const double enough =
      kUneven * std::max(kRows / program.duration_s,
                         kRowsAPeriod * truth.periods_per_turn * program.top_rpm / 60.0);
  SimulationOptions o;
  o.duration_s = program.duration_s;
  o.sample_rate_hz = std::min(bench.rate_hz, enough);
  o.noise_rms_v = bench.noise_v;
  o.adc_bits = 0;
  o.motion = program.motion;
  o.temperature = program.temperature;
  o.has_vtemp = bench.vtemp;
  o.has_vdd = bench.vdd;
  o.has_reference = bench.reference;
  constexpr std::uint64_t kSeed = 1; // the same answer at each call
  const auto out = std::make_shared<Imagined>();
  out->capture = Simulation(truth, o, kSeed).run();
  out->rows_each = bench.rate_hz / o.sample_rate_hz;
  out->scene = prepare(out->capture, false);
  if (!out->scene.insufficient.empty())
    return {};
  out->self = fit(out->scene.all, truth);
  return out->self.determined && out->self.rss > 0.0 ? out : nullptr;
}

/// The captures of one truth: several findings, and a channel more, ask for the same again.
class Imagination {
public:
  explicit Imagination(const Model &truth) : truth_(truth) {}

  /// None of a motion that shows nothing of the model.
  std::shared_ptr<const Imagined> of(const Program &program, const Bench &bench) {
    auto &out = known_[std::tuple(program.motion, program.temperature, program.duration_s,
                                  bench.vtemp, bench.vdd, bench.reference)];
    if (!out)
      out = imagine(program, bench, truth_);
    return *out;
  }

private:
  const Model &truth_;
  std::map<std::tuple<std::string, std::string, double, bool, bool, bool>,
           std::optional<std::shared_ptr<const Imagined>>>
      known_;
};

/// Nats by which such a capture speaks for the cause at `place` of the truth rather than for each
/// of its rivals; nothing: it would not tell anything.
std::vector<double> nats_against(const Imagined &imagined, bool one_speed, const Model &truth,
                                 std::size_t place, const std::vector<const Effect *> &rivals) {
  const Scene &scene = imagined.scene;
  const FitResult &self = imagined.self, less = fit(scene.all, truth.without(place));
  if (!less.determined)
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
    const EffectInfo &one = truth.effects[place].effect->info(), &other = rival->info();
    // What holds a part of another reading does so by the time between two; and at one speed a tone
    // and an order are one, whatever tone that was at the speed of the capture.
    const bool told = (imagined.rows_each <= 1.0 || !(one.remembers || other.remembers)) &&
                      !(one_speed && is_tone(one) != is_tone(other));
    std::optional<double> least;
    const auto take = [&](const Model &start) {
      const FitResult fitted = fit(scene.all, start);
      if (!fitted.determined)
        return;
      double nats = rows * imagined.rows_each * std::log(less.rss / self.rss) + beside_self -
                    side_evidence(aside, less.model);
      if (in_range(fitted.model)) {
        const bool blurred =
            apart_v(fitted.rss) <= blur.left_by(fitted.model.effects.back(), apart_v(less.rss));
        const double by_pair =
            blurred ? 0.0 : rows * imagined.rows_each * std::log(fitted.rss / self.rss);
        nats = std::min(nats, by_pair + beside_self - side_evidence(aside, fitted.model));
      }
      least = std::min(nats, least.value_or(nats));
    };
    for (const Candidate &c : list) {
      if (c.effect != rival || !told)
        continue;
      std::vector<Model> starts{c.start};
      for (const auto &[gain, start] : c.others)
        starts.push_back(start);
      const EffectInstance &first = c.start.effects.back();
      for (auto &values : rival->choices(first.values)) {
        starts.push_back(c.start);
        starts.back().effects.back().values = std::move(values);
      }
      for (const Model &start : starts)
        take(start);
    }
    // Of one that the motion does not tell from what the model holds nothing is known.
    out.push_back(least.value_or(0.0));
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
  constexpr double kPlain = 1000.0; // above it what the model lacks counts, and not the noise
  std::string rivals = e.separates.at(1);
  for (std::size_t k = 2; k < e.separates.size(); ++k)
    rivals += (k + 1 == e.separates.size() ? " and " : ", ") + e.separates[k];
  return fmt::format(
      "turn the shaft {}, for {:g} s in all{}: if it is {}, {} will {}describe that capture worse "
      "by {}",
      what_to_do, e.duration_s,
      e.record.empty() ? "" : fmt::format(", and record {} as well", fmt::join(e.record, " and ")),
      e.separates.front(), rivals, e.separates.size() > 2 ? "each " : "",
      e.expected_nats > kPlain ? fmt::format("more than {:g} nats", kPlain)
                               : fmt::format("some {:g} nats", two_digits(e.expected_nats)));
}

using GoesOn = std::function<void()>;

/// Which program tells most rivals apart; of those, the first that does it half as clearly as the
/// best. Takes them out of `rivals`.
std::optional<Experiment> best_of(const std::vector<Program> &programs, const Bench &bench,
                                  const std::vector<std::string> &record, Imagination &imagination,
                                  const Model &truth, std::size_t place,
                                  std::vector<const Effect *> &rivals, const GoesOn &goes_on) {
  constexpr double kAsClear = 0.5;
  // As much again as what is rejected: the next capture has a noise of its own.
  constexpr double kTellsApart = 2.0 * criteria::kRivalNats;
  struct Separated {
    const Program *by = nullptr;
    std::vector<std::size_t> which;
    double least = 0.0;
  };
  std::vector<Separated> all;
  for (const Program &p : programs) {
    goes_on();
    Separated told{&p, {}, 0.0};
    std::vector<double> nats;
    try {
      if (const auto imagined = imagination.of(p, bench))
        nats = nats_against(*imagined, p.one_speed, truth, place, rivals);
    } catch (const std::exception &) { // a model that says nothing of such a motion
      continue;
    }
    for (std::size_t k = 0; k < nats.size(); ++k)
      if (nats[k] >= kTellsApart) {
        told.least = told.which.empty() ? nats[k] : std::min(told.least, nats[k]);
        told.which.push_back(k);
      }
    all.push_back(std::move(told));
  }
  Separated best;
  for (const Separated &told : all)
    if (std::pair(told.which.size(), told.least) > std::pair(best.which.size(), best.least))
      best = told;
  if (best.which.empty())
    return {};
  for (const Separated &told : all)
    if (told.which.size() == best.which.size() && told.least >= kAsClear * best.least) {
      best = told;
      break;
    }
  Experiment out;
  out.motion = best.by->motion;
  out.temperature = best.by->temperature;
  out.duration_s = best.by->duration_s;
  out.record = record;
  out.expected_nats = best.least;
  out.separates.emplace_back(truth.effects[place].effect->info().id);
  for (std::size_t k : best.which)
    out.separates.emplace_back(rivals[k]->info().id);
  for (auto k = best.which.rbegin(); k != best.which.rend(); ++k)
    rivals.erase(rivals.begin() + static_cast<std::ptrdiff_t>(*k));
  out.sentence = in_words(out, best.by->words);
  return out;
}

} // namespace

std::vector<Experiment> next_experiments(const Diagnosis &d, const Capture &capture,
                                         const std::function<void()> &goes_on) {
  constexpr std::size_t kMost = 3;
  std::vector<Experiment> out;
  const std::optional<Bench> bench = bench_of(d, capture);
  if (!bench)
    return out;
  const Model truth = shown_again(d.extended);
  Imagination imagination(truth);
  for (std::size_t k = 0; k < d.findings.size() && out.size() < kMost; ++k) {
    const Finding &f = d.findings[k];
    const auto self =
        std::find_if(truth.effects.begin(), truth.effects.end(), [&](const EffectInstance &e) {
          return e.effect == f.effect && e.values == f.values;
        });
    std::vector<const Effect *> rivals;
    for (const std::string &id : f.alternatives)
      if (const Effect *rival = find_effect(id); rival && comes_again(rival->info()))
        rivals.push_back(rival);
    if (self == truth.effects.end() || rivals.empty())
      continue;
    const auto place = static_cast<std::size_t>(self - truth.effects.begin());
    const bool heat =
        f.effect->info().axis == "temperature" || std::ranges::any_of(rivals, [](const Effect *e) {
          return e->info().axis == "temperature";
        });
    const std::vector<Program> programs = programs_for(*bench, d.periods_per_turn, heat);
    const auto add = [&](const std::vector<Program> &of, const Bench &with,
                         const std::vector<std::string> &record) {
      if (rivals.empty() || out.size() >= kMost)
        return;
      if (auto e = best_of(of, with, record, imagination, truth, place, rivals, goes_on)) {
        e->finding = k;
        out.push_back(std::move(*e));
      }
    };
    add(programs, *bench, {});
    // Of the channels that are missing one by one, beside the simplest motion and the richest.
    for (const auto &[channel, column] :
         {std::pair(&Bench::vtemp, "vtemp_v"), std::pair(&Bench::vdd, "vdd_v"),
          std::pair(&Bench::reference, "reference_deg")}) {
      Bench more = *bench;
      if (more.*channel || (channel == &Bench::reference && capture.has_reference()))
        continue;
      more.*channel = true;
      add({programs.front(), programs.back()}, more, {column});
    }
  }
  return out;
}

} // namespace ada

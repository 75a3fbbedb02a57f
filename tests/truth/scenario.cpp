// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "scenario.h"
#include "conditions.h"
#include "hidden_effects.h"
#include "outside.h"
#include "random.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <stdexcept>

namespace truth {
namespace {

using enum MotionKind;

bool contains(const std::vector<std::string> &list, const std::string &name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

const HiddenEffect &effect_or_throw(const std::string &cause) {
  const HiddenEffect *effect = find_effect(cause);
  if (effect == nullptr)
    throw std::invalid_argument("no such cause: " + cause);
  return *effect;
}

/// A condition on the data and a hidden effect, under which the data cannot name one cause.
struct AmbiguousCase {
  std::string name;
  std::vector<std::string> hidden; // one of these is drawn
  Needs needs;
  double scale;                     // of the effect's size: small enough to stay ambiguous
  std::vector<std::string> require; // the finding must hold these, as cause or alternative
  std::vector<std::string> accept;  // may stand as its cause
  std::vector<std::string> tolerated;
};

Needs needs_of(std::vector<MotionKind> motions, Wanted reference, Wanted vtemp) {
  Needs needs;
  needs.motions = std::move(motions);
  needs.reference = reference;
  needs.vtemp = vtemp;
  return needs;
}

std::vector<AmbiguousCase> make_cases() {
  const Wanted yes = Wanted::yes;
  const Wanted no = Wanted::no;
  const Wanted maybe = Wanted::maybe;
  Needs two_periods;
  two_periods.periods = 2;
  Needs one_speed_fast = needs_of({one_speed}, maybe, yes);
  one_speed_fast.fast = true;
  Needs one_speed_no_vtemp = needs_of({one_speed}, maybe, no);
  one_speed_no_vtemp.fast = true;
  // At a high rate and hence short: over many turns the drive would average out.
  Needs by_hand = needs_of({ragged}, yes, maybe);
  by_hand.fast = true;
  Needs flip = needs_of({step_reversal}, yes, maybe);
  flip.fast = true;
  Needs no_vdd;
  no_vdd.vdd = no;
  return {
      {"third-harmonic",
       {"weak-field", "cubic-nonlinearity"},
       two_periods,
       0.2,
       {"weak-field", "cubic-nonlinearity"},
       {"weak-field", "cubic-nonlinearity"},
       {}},
      {"wiring",
       {"channel-swap", "channel-inverted"},
       needs_of({}, yes, maybe),
       1,
       {"channel-swap", "channel-inverted"},
       {"channel-swap", "channel-inverted"},
       {}},
      {"one-speed",
       {"quadrature-error", "channel-skew"},
       one_speed_fast,
       1,
       {"quadrature-error", "channel-skew"},
       {"quadrature-error", "channel-skew"},
       {}},
      {"one-speed-no-vtemp",
       {"quadrature-error", "channel-skew", "multiplexer-memory"},
       one_speed_no_vtemp,
       1,
       {"quadrature-error", "channel-skew"},
       {"quadrature-error", "channel-skew", "multiplexer-memory"},
       {"amplitude-mismatch"}},
      {"no-vtemp",
       {"quadrature-error", "multiplexer-memory"},
       needs_of({speeds, speed_reversals}, maybe, no),
       1,
       {},
       {"quadrature-error", "multiplexer-memory"},
       {"amplitude-mismatch"}},
      {"one-absolute-speed",
       {"hysteresis", "propagation-delay"},
       flip,
       1,
       {"hysteresis", "propagation-delay"},
       {"hysteresis", "propagation-delay"},
       {}},
      {"ragged-speed",
       {"stray-field", "reference-eccentricity"},
       by_hand,
       0.5,
       {"stray-field", "reference-eccentricity"},
       {"stray-field", "reference-eccentricity"},
       {}},
      {"ragged-speed-order-n",
       {"reference-harmonic", "field-direction-error"},
       by_hand,
       1,
       {"reference-harmonic", "field-direction-error"},
       {"reference-harmonic", "field-direction-error"},
       {}},
      {"no-reference-order-1",
       {"rotation-nonuniformity", "stray-field"},
       needs_of({one_speed}, no, maybe),
       0.15,
       {"rotation-nonuniformity", "stray-field"},
       {"rotation-nonuniformity"},
       {}},
      {"no-reference-order-2",
       {"rotation-nonuniformity", "sensor-off-axis"},
       needs_of({one_speed}, no, maybe),
       0.3,
       {"rotation-nonuniformity", "sensor-off-axis"},
       {"rotation-nonuniformity"},
       {}},
      {"no-reference-order-n",
       {"rotation-nonuniformity", "field-direction-error"},
       needs_of({one_speed}, no, maybe),
       0.3,
       {"rotation-nonuniformity", "field-direction-error"},
       {"rotation-nonuniformity"},
       {}},
      {"no-vdd", {"supply-variation"}, no_vdd, 1, {"supply-variation"}, {}, {}},
  };
}

const std::vector<AmbiguousCase> &cases() {
  static const std::vector<AmbiguousCase> table = make_cases();
  return table;
}

class Builder {
public:
  Builder(std::uint64_t seed, const Options &options)
      : random_(seed, 1), scenario_{seed, options, {}, {}, {}} {}

  Scenario build() {
    const std::string &category = scenario_.options.category;
    if (category == "single")
      combined(1);
    else if (category == "two")
      combined(2);
    else if (category == "three")
      combined(3);
    else if (category == "four")
      combined(4);
    else if (category == "bench")
      combined(1);
    else if (category == "outside")
      outside();
    else if (category == "ambiguous")
      ambiguous();
    else if (category == "null")
      null();
    else if (category == "unknown")
      unknown();
    else if (category == "tiny")
      tiny();
    else if (category == "short")
      too_short();
    else
      throw std::invalid_argument("no such category: " + category);
    finish();
    return std::move(scenario_);
  }

private:
  Expectation &expectation() { return scenario_.expectation; }

  void hide(const HiddenEffect &effect, double scale = 1.0) {
    effect.hide(random_, conditions_, scale, expectation().effects);
    hidden_ += (hidden_.empty() ? "" : " + ") + effect.cause;
  }

  void combined(std::size_t count) {
    expectation().verdicts = {"explained"};
    const bool bench = scenario_.options.category == "bench";
    std::vector<const HiddenEffect *> all;
    for (const HiddenEffect &effect : hidden_effects())
      if (effect.bench == bench)
        all.push_back(&effect);
    for (int attempt = 0; attempt < 10000; ++attempt) {
      Needs needs;
      std::vector<const HiddenEffect *> chosen;
      std::set<std::string> groups;
      auto take = [&](const HiddenEffect &effect) {
        if ((effect.alone && count > 1) ||
            std::any_of(effect.groups.begin(), effect.groups.end(),
                        [&](const std::string &group) { return groups.contains(group); }))
          return false;
        Needs merged = needs;
        if (!merge(merged, effect.needs))
          return false;
        needs = merged;
        chosen.push_back(&effect);
        groups.insert(effect.groups.begin(), effect.groups.end());
        return true;
      };
      if (!scenario_.options.effect.empty() && !take(effect_or_throw(scenario_.options.effect)))
        throw std::invalid_argument(scenario_.options.effect + " does not go with others");
      for (int draw = 0; draw < 50 && chosen.size() < count; ++draw)
        take(*all[random_.index(all.size())]);
      if (chosen.size() != count)
        continue;
      conditions_ = draw_conditions(random_, needs);
      // In the catalogue's order, whatever the order of drawing.
      std::sort(chosen.begin(), chosen.end());
      for (const HiddenEffect *effect : chosen)
        hide(*effect, scenario_.options.scale);
      return;
    }
    throw std::logic_error("no combination found");
  }

  void ambiguous() {
    const std::string &wanted = scenario_.options.effect;
    const AmbiguousCase *found = nullptr;
    if (wanted.empty())
      found = &random_.pick(cases());
    for (const AmbiguousCase &candidate : cases())
      if (candidate.name == wanted)
        found = &candidate;
    if (found == nullptr)
      throw std::invalid_argument("no such ambiguous case: " + wanted);
    conditions_ = draw_conditions(random_, found->needs);
    expectation().verdicts = {"explained"};
    expectation().tolerated = found->tolerated;
    if (found->name == "third-harmonic") {
      // An offset gives the transfer error a second harmonic that the field does not have.
      conditions_.bench.chain.sine.offset = random_.uniform(-5e-5, 5e-5);
      conditions_.bench.chain.cosine.offset = random_.uniform(-5e-5, 5e-5);
    }
    const bool ripple_of_given_order = found->name.starts_with("no-reference-order-");
    do {
      hidden_.clear();
      expectation().effects.clear();
      const Motion clean = conditions_.bench.motion;
      hide(effect_or_throw(random_.pick(found->hidden)), found->scale);
      const Truth &truth = expectation().effects.front();
      if (!ripple_of_given_order || truth.cause != "rotation-nonuniformity")
        break;
      const double order = truth.parameters.at("order").value;
      const char which = found->name.back();
      if (which == 'n' ? order > 2 : static_cast<int>(order) == which - '0')
        break;
      conditions_.bench.motion = clean;
    } while (true);
    Truth &truth = expectation().effects.front();
    truth.require = found->require;
    // The multiplexer's trace of the previous sample may show, and then it alone is right.
    if (truth.cause == "multiplexer-memory")
      truth.require.clear();
    truth.accept = found->accept;
    hidden_ += " (" + found->name + ")";
  }

  void null() {
    expectation().verdicts = {"no-discrepancy"};
    Needs needs;
    const double kind = random_.unit();
    if (kind < 0.1) {
      needs.motions = {ragged};
      needs.reference = Wanted::yes;
    } else if (kind < 0.2) {
      needs.motions = {restless};
    } else if (kind < 0.4) {
      needs.sweep = true;
    } else if (kind < 0.55) {
      // There, but invisible: a lag at one speed in one direction is a zero angle.
      needs.motions = {one_speed};
      needs.reference = Wanted::yes;
      conditions_ = draw_conditions(random_, needs);
      const std::vector<std::string> lags = {"propagation-delay", "hysteresis"};
      hide(effect_or_throw(random_.pick(lags)));
      expectation().effects.clear();
      hidden_ += " (invisible)";
      return;
    } else if (kind < 0.65) {
      // Likewise drift at a constant temperature.
      needs.vtemp = Wanted::yes;
      conditions_ = draw_conditions(random_, needs);
      hide(effect_or_throw("offset-temperature-drift"));
      expectation().effects.clear();
      hidden_ += " (invisible)";
      return;
    }
    conditions_ = draw_conditions(random_, needs);
    hidden_ = "nothing";
  }

  void unknown() {
    std::string name = scenario_.options.effect;
    if (name.empty())
      name = random_.pick(unknown_kinds()).name;
    const UnknownKind *kind = nullptr;
    for (const UnknownKind &candidate : unknown_kinds())
      if (candidate.name == name)
        kind = &candidate;
    if (kind == nullptr)
      throw std::invalid_argument("no such unknown effect: " + name);
    Needs needs;
    needs.motions = kind->needs.accelerating ? std::vector{restless}
                                             : std::vector{one_speed, speeds, speed_reversals};
    if (kind->needs.reference)
      needs.reference = Wanted::yes;
    if (name == "gain-wander") // or the supply could have done it
      needs.vdd = Wanted::yes;
    needs.noise = Wanted::yes;
    conditions_ = draw_conditions(random_, needs);
    Bench &bench = conditions_.bench;
    bench.unknown = make_unknown(name, scenario_.seed, bench.motion, bench.sampler.rate,
                                 bench.duration(), bench.converter.noise);
    expectation().tolerated = kind->tolerated;
    expectation().verdicts = {"unexplained", "partly-explained"};
    expectation().unexplained = true;
    expectation().named_instead = kind->instead;
    if (!kind->instead.empty()) {
      expectation().verdicts.push_back("explained");
      expectation().tolerated.insert(expectation().tolerated.end(), kind->instead.begin(),
                                     kind->instead.end());
    }
    hidden_ = name;
  }

  void outside() {
    std::string name = scenario_.options.effect;
    if (name.empty())
      name = random_.pick(outside_kinds());
    if (!contains(outside_kinds(), name))
      throw std::invalid_argument("no such bench: " + name);
    conditions_ = draw_outside(name, random_, expectation());
    hidden_ = name;
  }

  void tiny() {
    static const std::vector<std::string> scalable = {"amplitude-mismatch",
                                                      "quadrature-error",
                                                      "offset-temperature-drift",
                                                      "quadratic-nonlinearity",
                                                      "cubic-nonlinearity",
                                                      "weak-field",
                                                      "harmonic-distortion",
                                                      "propagation-delay",
                                                      "stray-field",
                                                      "sensor-off-axis",
                                                      "field-direction-error",
                                                      "hysteresis",
                                                      "reference-eccentricity",
                                                      "channel-skew",
                                                      "periodic-interference",
                                                      "offset-step",
                                                      "multiplexer-memory"};
    std::string name = scenario_.options.effect;
    if (name.empty())
      name = random_.pick(scalable);
    if (!contains(scalable, name))
      throw std::invalid_argument("cannot be made tiny: " + name);
    const HiddenEffect &effect = effect_or_throw(name);
    conditions_ = draw_conditions(random_, effect.needs);
    hide(effect, 1.0 / 3000);
    hidden_ += " (below what can be seen)";
    expectation().tolerated.push_back(name);
    expectation().effects.clear();
    expectation().verdicts = {"no-discrepancy"};
  }

  void too_short() {
    Needs needs;
    needs.motions = {one_speed};
    conditions_ = draw_conditions(random_, needs);
    Bench &bench = conditions_.bench;
    expectation().verdicts = {"insufficient-data"};
    if (random_.chance(0.3)) {
      Motion still;
      still.start_at(random_.uniform(0, kTurn));
      still.hold(bench.duration(), 0.0);
      bench.motion = still;
      hidden_ = "standstill";
      return;
    }
    const double turns = random_.uniform(0.05, 0.35) * 2 / bench.bridge.periods_per_turn;
    const double seconds = turns * 60.0 / conditions_.highest_rpm;
    bench.samples =
        std::max<std::size_t>(12, static_cast<std::size_t>(seconds * bench.sampler.rate));
    hidden_ = "too short";
  }

  void finish() {
    Bench &bench = conditions_.bench;
    bench.noise_seed = scenario_.seed;
    bench.chain.vtemp_centre = mean_vtemp(bench);
    expectation().noise_rms_v = bench.converter.noise;
    expectation().amplitude_v = bench.chain.amplitude;
    expectation().periods_per_turn = bench.bridge.periods_per_turn;
    bench.record.serial = "T" + std::to_string(scenario_.seed);
    char text[200];
    std::snprintf(
        text, sizeof text,
        "%zu samples at %g S/s, p=%d, %s %.0f..%.0f rpm, %.0f..%.0f degC, %s%s%s%s", bench.samples,
        bench.sampler.rate, bench.bridge.periods_per_turn, to_string(conditions_.motion).c_str(),
        conditions_.lowest_rpm, conditions_.highest_rpm, bench.thermal.start,
        bench.thermal.start + bench.thermal.swing, bench.record.has_reference ? "reference " : "",
        bench.record.has_vtemp ? "vtemp " : "", bench.record.has_vdd ? "vdd " : "",
        bench.record.states_noise ? "" : "(noise not stated) ");
    scenario_.description = std::string(text) + "| " + hidden_;
    scenario_.bench = std::move(bench);
  }

  Random random_;
  Scenario scenario_;
  Conditions conditions_{};
  std::string hidden_;
};

} // namespace

const std::vector<std::string> &categories() {
  static const std::vector<std::string> list = {"single",    "two",   "three",   "four",
                                                "ambiguous", "null",  "unknown", "tiny",
                                                "short",     "bench", "outside"};
  return list;
}

const std::vector<std::string> &causes() {
  static const std::vector<std::string> list = [] {
    std::vector<std::string> names;
    for (const HiddenEffect &effect : hidden_effects())
      if (!effect.bench)
        names.push_back(effect.cause);
    return names;
  }();
  return list;
}

const std::vector<std::string> &bench_causes() {
  static const std::vector<std::string> list = [] {
    std::vector<std::string> names;
    for (const HiddenEffect &effect : bench_effects())
      names.push_back(effect.cause);
    return names;
  }();
  return list;
}

const std::vector<std::string> &ambiguous_cases() {
  static const std::vector<std::string> list = [] {
    std::vector<std::string> names;
    for (const AmbiguousCase &entry : cases())
      names.push_back(entry.name);
    return names;
  }();
  return list;
}

Scenario random_scenario(std::uint64_t seed, const Options &options) {
  return Builder(seed, options).build();
}

Bench second_capture(const Scenario &scenario) {
  Random random(scenario.seed, 2);
  Bench bench = scenario.bench;
  const std::vector<MotionKind> kinds = {one_speed, speeds, speed_reversals};
  bench.motion = draw_motion(random, random.pick(kinds), bench, random.chance(0.5));
  bench.noise_seed = scenario.seed + 0x5ec0d;
  Thermal &thermal = bench.thermal;
  if (thermal.swing != 0.0) {
    // The other way, and not quite as far: a calibration holds inside its range.
    thermal.start += 0.95 * thermal.swing;
    thermal.swing *= -0.9;
    thermal.cycles = random.chance(0.5) ? 1.0 : 0.5;
  }
  bench.field.slip_step = 0.0;
  bench.chain.sine.step = bench.chain.cosine.step = 0.0;
  bench.supply.lines.clear();
  bench.converter.excess_noise = 0.0;
  bench.converter.tones.clear();
  bench.converter.spikes.clear();
  bench.converter.stuck = {};
  bench.record.losses.clear();
  bench.record.reference_eccentricity = 0.0;
  bench.record.reference_lines.clear();
  bench.record.reference_delay = bench.record.reference_jitter = bench.record.reference_step = 0.0;
  bench.record.reference_noise = Record{}.reference_noise;
  bench.wander = {};
  bench.gain_noise = 0.0;
  bench.unknown = {};
  return bench;
}

} // namespace truth

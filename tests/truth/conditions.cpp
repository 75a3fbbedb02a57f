// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "conditions.h"

#include <algorithm>
#include <cmath>

namespace truth {
namespace {

bool merge_wanted(Wanted &into, Wanted other) {
  if (into == Wanted::maybe)
    into = other;
  return other == Wanted::maybe || into == other;
}

/// Plateaus and what lies between them; \p count pieces of equal length fill the capture.
struct Plan {
  Motion motion;
  double total;
  double transition; // s
};

void run_plateaus(Plan &plan, const std::vector<double> &speeds) {
  const auto count = static_cast<double>(speeds.size());
  const double hold = (plan.total - (count - 1) * plan.transition) / count;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    if (i > 0)
      plan.motion.change(plan.transition, speeds[i]);
    plan.motion.hold(hold, speeds[i]);
  }
}

/// An irregular drive: the speed wanders by a good tenth within an eighth of a turn, so that
/// over the turns of a capture nothing of the rotation's own order can be told from the drive.
void run_ragged(Random &random, Plan &plan, double speed) {
  const double step = kTurn / std::abs(speed) / 8;
  double deviation = 0.0;
  plan.motion.hold(step, speed);
  while (plan.motion.duration() < plan.total) {
    deviation = std::clamp(0.6 * deviation + 0.12 * random.normal(), -0.4, 0.4);
    plan.motion.ramp(step, speed * (1 + deviation));
  }
}

} // namespace

std::string to_string(MotionKind kind) {
  switch (kind) {
  case MotionKind::one_speed:
    return "one-speed";
  case MotionKind::speeds:
    return "speeds";
  case MotionKind::reversals:
    return "reversals";
  case MotionKind::speed_reversals:
    return "speed-reversals";
  case MotionKind::ramps:
    return "ramps";
  case MotionKind::coast:
    return "coast";
  case MotionKind::dwell:
    return "dwell";
  case MotionKind::restless:
    return "restless";
  case MotionKind::step_reversal:
    return "step-reversal";
  case MotionKind::ragged:
    return "ragged";
  }
  return "";
}

bool merge(Needs &into, const Needs &other) {
  if (!other.motions.empty()) {
    if (into.motions.empty()) {
      into.motions = other.motions;
    } else {
      std::erase_if(into.motions, [&](MotionKind kind) {
        return std::find(other.motions.begin(), other.motions.end(), kind) == other.motions.end();
      });
      if (into.motions.empty())
        return false;
    }
  }
  into.sweep |= other.sweep;
  into.slow |= other.slow;
  into.fast |= other.fast;
  into.gain_off |= other.gain_off;
  if (into.periods == 0)
    into.periods = other.periods;
  return merge_wanted(into.reference, other.reference) && merge_wanted(into.vtemp, other.vtemp) &&
         merge_wanted(into.vdd, other.vdd) && merge_wanted(into.noise, other.noise) &&
         (other.periods == 0 || into.periods == other.periods) && !(into.slow && into.fast);
}

Motion draw_motion(Random &random, MotionKind kind, const Bench &bench, bool fast,
                   Conditions *conditions) {
  const double total = bench.duration();
  // At least 20 samples in each electrical period, and at least some turns on each plateau.
  const double limit =
      std::min(3000.0, bench.sampler.rate * 60.0 / (21.0 * bench.bridge.periods_per_turn));
  const double pieces = kind == MotionKind::one_speed || kind == MotionKind::coast ? 1.0 : 4.0;
  const double least = std::min(std::max(60.0, 4.0 * 60.0 * pieces / total), limit / 2.2);
  const double high = fast ? random.uniform(std::max(0.6 * limit, std::min(900.0, limit)), limit)
                           : random.log_uniform(std::max(2.2 * least, 0.15 * limit), limit);
  const double low = std::max(least, high / random.uniform(2.2, 5.0));
  const double direction = random.sign();
  const double top = direction * high * kRpm;
  const double bottom = direction * low * kRpm;
  const double one = kind == MotionKind::one_speed && !fast
                         ? direction * random.log_uniform(least, limit) * kRpm
                         : top;

  const double hand_rpm = std::min(random.uniform(60, 90), limit / 1.5);

  Plan plan{{}, total, total * random.uniform(0.03, 0.06)};
  plan.motion.start_at(random.uniform(0, kTurn));
  switch (kind) {
  case MotionKind::one_speed:
    plan.motion.hold(total, one);
    break;
  case MotionKind::speeds: {
    const double middle = bottom + (top - bottom) * random.uniform(0.3, 0.7);
    std::vector<std::vector<double>> orders = {{bottom, top},
                                               {top, bottom},
                                               {bottom, middle, top},
                                               {top, bottom, middle},
                                               {bottom, top, middle, bottom}};
    run_plateaus(plan, random.pick(orders));
    break;
  }
  case MotionKind::reversals: {
    std::vector<std::vector<double>> orders = {
        {top, -top}, {top, -top, top}, {top, -top, top, -top}};
    run_plateaus(plan, random.pick(orders));
    break;
  }
  case MotionKind::speed_reversals: {
    std::vector<std::vector<double>> orders = {{bottom, top, -bottom, -top},
                                               {top, bottom, -bottom, -top},
                                               {top, -top, bottom, -bottom},
                                               {bottom, -bottom, -top, top}};
    run_plateaus(plan, random.pick(orders));
    break;
  }
  case MotionKind::ramps:
    plan.motion.hold(0.1 * total, bottom);
    plan.motion.ramp(0.35 * total, top);
    plan.motion.hold(0.1 * total, top);
    plan.motion.ramp(0.35 * total, bottom);
    plan.motion.hold(0.1 * total, bottom);
    break;
  case MotionKind::coast:
    plan.motion.hold(0.2 * total, top);
    plan.motion.coast(0.8 * total, 0.8 * total / std::log(high / low));
    break;
  case MotionKind::dwell: {
    plan.motion.hold(0.3 * total, top);
    plan.motion.change(plan.transition, 0.0);
    plan.motion.hold(0.12 * total, 0.0);
    plan.motion.change(plan.transition, bottom);
    plan.motion.hold(0.58 * total - 2 * plan.transition, bottom);
    break;
  }
  case MotionKind::restless: {
    plan.motion.hold(0.02 * total, bottom);
    const int changes = 4 + 2 * static_cast<int>(random.index(3));
    for (int i = 0; i < changes; ++i)
      plan.motion.change(0.98 * total / changes, i % 2 == 0 ? top : bottom);
    break;
  }
  case MotionKind::step_reversal: {
    const double flip = 0.8 / bench.sampler.rate;
    plan.transition = flip;
    run_plateaus(plan, {top, -top, top, -top});
    break;
  }
  case MotionKind::ragged:
    run_ragged(random, plan, direction * hand_rpm * kRpm);
    break;
  }
  if (conditions != nullptr) {
    conditions->highest_rpm = kind == MotionKind::one_speed ? std::abs(one) / kRpm : high;
    conditions->lowest_rpm = low;
    if (kind == MotionKind::one_speed || kind == MotionKind::reversals ||
        kind == MotionKind::step_reversal)
      conditions->lowest_rpm = conditions->highest_rpm;
    if (kind == MotionKind::ragged)
      conditions->lowest_rpm = conditions->highest_rpm = hand_rpm;
  }
  return plan.motion;
}

Conditions draw_conditions(Random &random, const Needs &needs) {
  auto decide = [&](Wanted wanted, double probability) {
    const bool drawn = random.chance(probability);
    return wanted == Wanted::maybe ? drawn : wanted == Wanted::yes;
  };
  Conditions conditions{};
  Bench &bench = conditions.bench;
  bench.bridge.periods_per_turn =
      needs.periods != 0 ? needs.periods : (random.chance(0.75) ? 2 : 1);
  bench.samples = 60000 + random.index(15001);
  std::vector<double> rates = {100, 200, 250, 500, 1000, 2000, 2500, 4000, 5000, 8000, 10000};
  if (needs.slow)
    rates = {100, 125, 200};
  else if (needs.fast)
    rates = {2000, 2500, 4000, 5000, 8000, 10000};
  else if (needs.sweep)
    rates = {100, 200, 250, 500, 1000, 2000};
  bench.sampler.rate = random.pick(rates);
  bench.sampler.clock_error = random.uniform(-20e-6, 20e-6);

  std::vector<MotionKind> motions = needs.motions;
  if (motions.empty())
    motions = {MotionKind::one_speed, MotionKind::speeds,
               MotionKind::reversals, MotionKind::speed_reversals,
               MotionKind::ramps,     MotionKind::coast,
               MotionKind::dwell};
  conditions.motion = random.pick(motions);
  bench.motion = draw_motion(random, conditions.motion, bench, needs.fast, &conditions);

  Record &record = bench.record;
  record.has_reference = decide(needs.reference, 0.65);
  record.has_vtemp = decide(needs.vtemp, 0.7) || needs.sweep;
  record.has_vdd = decide(needs.vdd, 0.5);
  record.states_noise = decide(needs.noise, 0.85);
  record.gain_control = !needs.gain_off && random.chance(0.8);
  // Within the sensor's own period, so that a fitted zero cannot land in the next one.
  record.reference_zero = random.uniform(-160, 160) / bench.bridge.periods_per_turn * kDegree;
  bench.sampler.scans_vtemp = record.has_vtemp;

  bench.thermal.duration = bench.duration();
  bench.thermal.start = random.uniform(0, 60);
  if (needs.sweep) {
    bench.thermal.start = random.uniform(-30, 30);
    bench.thermal.swing = random.uniform(50, 95);
    const std::vector<double> cycles =
        needs.slow ? std::vector<double>{1.0, 1.5, 2.0} : std::vector<double>{0.5, 1.0, 1.5};
    bench.thermal.cycles = random.pick(cycles);
    if (random.chance(0.3)) { // from hot to cold
      bench.thermal.start += bench.thermal.swing;
      bench.thermal.swing = -bench.thermal.swing;
    }
  }

  Chain &chain = bench.chain;
  chain.amplitude = chain.supply * random.uniform(0.28, 0.30);
  chain.sine.offset = chain.supply * random.uniform(-0.015, 0.015);
  chain.cosine.offset = chain.supply * random.uniform(-0.015, 0.015);
  bench.supply.ratio = 1 + random.uniform(-2e-4, 2e-4);
  bench.converter.noise = random.uniform(0.35e-3, 0.7e-3);
  return conditions;
}

} // namespace truth

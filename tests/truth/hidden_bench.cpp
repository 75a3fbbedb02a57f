// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// What real benches add: a reference that errs, wander, and noise that is not alike in all
/// directions.

#include "hidden_effects.h"
#include "hidden_parameters.h"

#include <memory>

namespace truth {
namespace {

using enum MotionKind;

using Truths = std::vector<Truth>;

Wander::Course course(Track track) {
  auto kept = std::make_shared<Track>(std::move(track));
  return [kept](double t) { return (*kept)(t); };
}

void reference_harmonic(Random &random, Conditions &c, double scale, Truths &truths) {
  // Whole orders of lines and poles; now and then a gear.
  static const std::vector<double> whole = {3, 4, 5, 6, 7, 8, 16, 32, 64};
  const bool gear = random.chance(0.3);
  const double order =
      gear ? 0.01 * std::round(100 * random.uniform(3.1, 11.9)) : random.pick(whole);
  const double degrees = scale * random.uniform(0.08, 0.4);
  const double phase = random.uniform(0, kTurn);
  Record &record = c.bench.record;
  record.reference_lines.push_back({order, degrees * kDegree, phase});
  Parameter seen = direction(c.bench, phase, 360, 0);
  // Counted from where the reference's own angle begins, in its first turn.
  const double first = c.bench.motion.angle(0.0) + record.reference_zero;
  const double turns = kTurn * std::floor(first / kTurn);
  seen.has_other = true;
  seen.other = (phase - order * (record.reference_zero - turns)) / kDegree;
  // A gear's order is known to a part of a turn's resolution, and its phase with it.
  const double resolution = kTurn / std::abs(c.bench.motion.angle(c.bench.duration()) - first);
  Parameter n = within(order, "1", gear ? 0.25 * std::min(resolution, 0.1) : 1e-9);
  seen.tolerance = gear ? 45.0 : seen.tolerance;
  truths.push_back({"reference-harmonic",
                    {{"order", n}, {"e_deg", sized(degrees, "deg", 0.005)}, {"phase_deg", seen}},
                    {},
                    {}});
}

void reference_delay(Random &random, Conditions &c, double scale, Truths &truths) {
  const double tau = scale * random.sign() * random.uniform(15e-6, 100e-6);
  c.bench.record.reference_delay = tau;
  Truth truth{"reference-delay", {{"tau_s", sized(tau, "s", 1e-6)}}, {}, {}};
  if (tau > 0.0) { // no data can tell; a negative delay of the signal is none
    truth.accept = {"propagation-delay"};
    truth.require = {"propagation-delay", "reference-delay"};
  }
  truths.push_back(truth);
}

void reference_resolution(Random &random, Conditions &c, double scale, Truths &truths) {
  static const std::vector<double> counts = {360, 400, 720, 1000, 1024, 2000};
  const double step = scale * 360.0 / random.pick(counts);
  c.bench.record.reference_step = step;
  truths.push_back(
      {"reference-resolution", {{"step_deg", within(step, "deg", 0.001 * step)}}, {}, {}});
}

void offset_wander(Random &random, Conditions &c, double scale, Truths &truths) {
  const double noise = scale * c.bench.converter.noise;
  const double sine = noise * random.uniform(3, 10), cosine = noise * random.uniform(3, 10);
  c.bench.wander.sine = course(smooth_walk(random, c.bench.duration(), sine));
  c.bench.wander.cosine = course(smooth_walk(random, c.bench.duration(), cosine));
  Truth truth{"offset-wander", {}, {}, {}};
  vector_pair(truth, "rms_sin_v", sine, "rms_cos_v", cosine, "V", 1e-4);
  truths.push_back(truth);
}

void gain_wander(Random &random, Conditions &c, double scale, Truths &truths) {
  const double rms = scale * random.uniform(0.002, 0.008);
  c.bench.wander.gain = course(smooth_walk(random, c.bench.duration(), rms));
  truths.push_back({"gain-wander", {{"rms_fraction", sized(rms, "1", 1e-4)}}, {}, {}});
}

void flicker_noise(Random &random, Conditions &c, double scale, Truths &truths) {
  const double rate = c.bench.sampler.rate, duration = c.bench.duration();
  const double corner = rate * random.log_uniform(0.05, 0.2);
  // As strong as the white noise there: density 2 noise^2/rate.
  const double strength =
      scale * corner * 2 * c.bench.converter.noise * c.bench.converter.noise / rate;
  const double whole = std::sqrt(strength * std::log(0.5 * rate * duration));
  // Finer than the samples, which lie between the points: the straight lines there would take away
  // what is fast.
  const auto points = static_cast<std::size_t>(4 * rate * duration) + 1;
  c.bench.wander.sine = course(flicker(random, duration, points, whole));
  c.bench.wander.cosine = course(flicker(random, duration, points, whole));
  const double below = std::sqrt(strength * std::log(corner * duration));
  // Half of the power lies in a few lines of the lowest octaves.
  truths.push_back({"flicker-noise",
                    {{"rms_v", within(below, "V", 0.3 * below)},
                     {"corner_hz", within(corner, "Hz", 0.5 * corner)}},
                    {},
                    {}});
}

void amplitude_noise(Random &random, Conditions &c, double scale, Truths &truths) {
  const double rms =
      scale * c.bench.converter.noise / c.bench.chain.amplitude * random.uniform(0.8, 3.0);
  c.bench.gain_noise = rms;
  truths.push_back({"amplitude-noise", {{"rms_fraction", sized(rms, "1", 2e-5)}}, {}, {}});
}

void angle_noise(Random &random, Conditions &c, double scale, Truths &truths) {
  const double white =
      c.bench.converter.noise / c.bench.chain.amplitude / c.bench.bridge.periods_per_turn / kDegree;
  const double degrees = scale * white * random.uniform(0.8, 3.0);
  c.bench.record.reference_noise = std::hypot(c.bench.record.reference_noise, degrees);
  truths.push_back({"angle-noise", {{"rms_deg", sized(degrees, "deg", 1e-3)}}, {}, {}});
}

void timing_jitter(Random &random, Conditions &c, double scale, Truths &truths) {
  const double white =
      c.bench.converter.noise / c.bench.chain.amplitude / c.bench.bridge.periods_per_turn;
  const double jitter = scale * white / (c.highest_rpm * kRpm) * random.uniform(1.5, 4.0);
  c.bench.record.reference_jitter = jitter;
  truths.push_back({"timing-jitter", {{"rms_s", sized(jitter, "s", 1e-8)}}, {}, {}});
}

} // namespace

std::vector<HiddenEffect> bench_effects() {
  Needs steady, changing, quiet, noise;
  steady.motions = {one_speed, speeds, reversals, speed_reversals};
  steady.reference = Wanted::yes;
  changing.motions = {speeds, speed_reversals, ramps, coast};
  changing.reference = Wanted::yes;
  changing.fast = true;
  quiet.motions = {one_speed, speeds, reversals, speed_reversals};
  quiet.vdd = Wanted::yes; // or the supply could have done it
  noise = steady;
  noise.noise = Wanted::yes;
  Needs gain = noise, jitter = changing;
  gain.vdd = Wanted::yes;
  jitter.motions = {speeds, speed_reversals};
  jitter.noise = Wanted::yes;
  return {
      {"reference-harmonic", steady, {"order-n"}, reference_harmonic, false, true},
      {"reference-delay", changing, {"lag"}, reference_delay, false, true},
      {"reference-resolution", steady, {"noise"}, reference_resolution, false, true},
      {"offset-wander", quiet, {"offset", "drift", "event"}, offset_wander, false, true},
      {"gain-wander", quiet, {"amplitude", "supply"}, gain_wander, false, true},
      {"flicker-noise", noise, {"noise", "offset", "drift"}, flicker_noise, false, true},
      {"amplitude-noise", gain, {"noise", "supply"}, amplitude_noise, false, true},
      {"angle-noise", noise, {"noise"}, angle_noise, false, true},
      {"timing-jitter", jitter, {"noise"}, timing_jitter, false, true},
  };
}

} // namespace truth

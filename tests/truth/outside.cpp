// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "outside.h"

#include "hidden_parameters.h"

#include <memory>

namespace truth {
namespace {

using enum MotionKind;

/// What every pair has, by its own names: no other cause makes an ellipse of this kind.
void ellipse(Random &random, Conditions &c, double k_most, double degrees_most,
             Expectation &expectation) {
  const double k = random.sign() * random.uniform(0.5, 1.0) * k_most;
  const double degrees = random.sign() * random.uniform(0.5, 1.0) * degrees_most;
  c.bench.chain.mismatch = k;
  c.bench.bridge.quadrature = degrees * kDegree;
  expectation.effects.push_back({"amplitude-mismatch", {{"k", sized(k, "1", 3e-4)}}, {}, {}});
  expectation.effects.push_back(
      {"quadrature-error", {{"delta_deg", sized(degrees, "deg", 0.02)}}, {}, {}});
}

/// Flaws of a magnet: direction errors of many orders, none of which is a cause by itself.
void magnet(Random &random, Bench &bench, double degrees, int lowest, int highest) {
  for (int order = lowest; order <= highest; ++order)
    bench.field.direction_errors.push_back(
        {order, degrees * kDegree * random.uniform(0.5, 1.0) / order, random.uniform(0, kTurn)});
}

/// Orders 1 and 2 of a magnet look like a stray field, a displaced sensor or a poor reference.
const std::vector<std::string> kShapes = {"field-direction-error", "harmonic-distortion",
                                          "stray-field", "sensor-off-axis"};
const std::vector<std::string> kNoise = {"excess-noise", "angle-noise", "amplitude-noise"};

Conditions steady(Random &random, std::vector<MotionKind> motions) {
  Needs needs;
  needs.motions = std::move(motions);
  needs.reference = Wanted::yes;
  needs.vtemp = Wanted::yes; // or the multiplexer's memory could have done it
  needs.vdd = Wanted::yes;
  return draw_conditions(random, needs);
}

Conditions magnet_harmonics(Random &random, Expectation &expectation) {
  Conditions c = steady(random, {speeds, speed_reversals});
  ellipse(random, c, 0.02, 0.8, expectation);
  magnet(random, c.bench, 1.0, 1, 9);
  const double white = c.bench.converter.noise / c.bench.chain.amplitude;
  c.bench.gain_noise = white * random.uniform(0.0, 2.0);
  c.bench.record.reference_noise =
      white / c.bench.bridge.periods_per_turn / kDegree * random.uniform(0.0, 2.0);
  expectation.tolerated.insert(expectation.tolerated.end(), kNoise.begin(), kNoise.end());
  expectation.axis = "angle";
  return c;
}

Conditions one_turn(Random &random, Expectation &expectation) {
  Conditions c = steady(random, {one_speed});
  Bench &bench = c.bench;
  bench.samples = 1000;
  bench.sampler.rate = 100.0;
  bench.thermal.duration = bench.duration();
  const double speed = random.sign() * kTurn / bench.duration();
  bench.motion = {};
  bench.motion.start_at(random.uniform(0, kTurn));
  bench.motion.hold(bench.duration(), speed);
  c.lowest_rpm = c.highest_rpm = std::abs(speed) / kRpm;
  ellipse(random, c, 0.05, 1.5, expectation);
  magnet(random, bench, 0.5, 1, 6);
  expectation.axis = "angle";
  return c;
}

Conditions wandering_gain(Random &random, Expectation &expectation) {
  Conditions c = steady(random, {one_speed, speeds, speed_reversals});
  ellipse(random, c, 0.01, 0.4, expectation);
  const double rms = random.uniform(0.015, 0.03);
  auto walk = std::make_shared<Track>(random_walk(random, c.bench.duration(), 300, rms));
  c.bench.wander.gain = [walk](double t) { return (*walk)(t); };
  expectation.tolerated.push_back("gain-wander");
  expectation.axis = "time";
  return c;
}

Conditions indexing_stops(Random &random, Expectation &expectation) {
  constexpr std::size_t kStops = 17, kReadings = 10;
  Conditions c = steady(random, {one_speed});
  Bench &bench = c.bench;
  bench.samples = kStops * kReadings;
  bench.sampler.rate = 10.0;
  bench.thermal.duration = bench.duration();
  const double period = 1.0 / bench.sampler.rate;
  const double step = random.sign() * kTurn / static_cast<double>(kStops);
  bench.motion = {};
  bench.motion.start_at(random.uniform(0, kTurn));
  const double move = 0.35 * period; // up, and down, between two readings
  for (std::size_t stop = 0; stop < kStops; ++stop) {
    bench.motion.hold((stop == 0 ? 9.15 : 9.3) * period, 0.0);
    bench.motion.ramp(move, step / move);
    bench.motion.ramp(move, 0.0);
  }
  bench.motion.hold(period, 0.0);
  c.lowest_rpm = c.highest_rpm = 0.0;
  ellipse(random, c, 0.05, 1.5, expectation);
  magnet(random, bench, 0.5, 1, 4);
  expectation.axis = "angle";
  return c;
}

} // namespace

const std::vector<std::string> &outside_kinds() {
  static const std::vector<std::string> kinds = {"magnet-harmonics", "one-turn", "wandering-gain",
                                                 "indexing-stops"};
  return kinds;
}

Conditions draw_outside(const std::string &kind, Random &random, Expectation &expectation) {
  expectation.verdicts = {"explained", "partly-explained", "unexplained"};
  expectation.unexplained_open = true;
  expectation.tolerated = kShapes;
  if (kind == "magnet-harmonics")
    return magnet_harmonics(random, expectation);
  if (kind == "one-turn")
    return one_turn(random, expectation);
  if (kind == "wandering-gain")
    return wandering_gain(random, expectation);
  return indexing_stops(random, expectation);
}

} // namespace truth

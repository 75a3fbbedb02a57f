// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "hidden_effects.h"

#include "hidden_parameters.h"

#include <algorithm>
#include <cmath>

namespace truth {
namespace {

std::string channel_name(bool sine) {
  return sine ? "vsin_v" : "vcos_v";
}

/// A moment away from the ends at which the shaft turns steadily: at a reversal or at rest
/// neither lost samples nor a stuck channel can be dated or counted.
double steady_moment(Random &random, const Motion &motion, double from, double to) {
  double t = 0.0;
  for (int attempt = 0; attempt < 1000; ++attempt) {
    t = random.uniform(from, to);
    const double margin = 0.02 * motion.duration();
    if (motion.acceleration(t - margin) == 0.0 && motion.acceleration(t) == 0.0 &&
        motion.acceleration(t + margin) == 0.0 && motion.speed(t) != 0.0)
      break;
  }
  return t;
}

double time_within(Random &random, const Bench &bench) {
  return steady_moment(random, bench.motion, 0.25 * bench.duration(), 0.75 * bench.duration());
}

// --- sensor and chain -----------------------------------------------------------------------

void amplitude_mismatch(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  const double k = scale * random.sign() * random.uniform(0.004, 0.015);
  c.bench.chain.mismatch = k;
  truths.push_back({"amplitude-mismatch", {{"k", sized(k, "1", 1e-4)}}, {}, {}});
}

void quadrature_error(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  const double degrees = scale * random.sign() * random.uniform(0.15, 0.8);
  c.bench.bridge.quadrature = degrees * kDegree;
  truths.push_back({"quadrature-error", {{"delta_deg", sized(degrees, "deg", 0.01)}}, {}, {}});
}

void draw_drift(Random &random, Bench &bench, double scale, double smallest,
                std::vector<Truth> &truths) {
  bench.chain.sine.drift = scale * random.sign() * random.log_uniform(smallest, 0.04);
  bench.chain.cosine.drift = scale * random.sign() * random.log_uniform(smallest, 0.04);
  Truth truth{"offset-temperature-drift", {}, {}, {}};
  vector_pair(truth, "tc_sin", bench.chain.sine.drift, "tc_cos", bench.chain.cosine.drift, "V/V",
              3e-4);
  truths.push_back(truth);
}

void offset_drift(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  draw_drift(random, c.bench, scale, 0.005, truths);
}

void offset_curvature(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  Bench &bench = c.bench;
  if (random.chance(0.7))
    draw_drift(random, bench, scale, 0.005, truths);
  bench.chain.sine.curvature = scale * random.sign() * random.uniform(0.01, 0.04);
  bench.chain.cosine.curvature = scale * random.sign() * random.uniform(0.01, 0.04);
  Truth truth{"offset-temperature-curvature", {}, {}, {}};
  vector_pair(truth, "c_sin", bench.chain.sine.curvature, "c_cos", bench.chain.cosine.curvature,
              "V/V^2", 5e-4);
  truths.push_back(truth);
}

void amplitude_drift(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  const double tc = scale * (random.chance(0.8) ? -1 : 1) * random.uniform(0.02, 0.18);
  // Per volt of VTEMP as the capture has it, which is ratiometric to the capture's own supply. Up to
  // 2e-4 of the number: several standard errors.
  c.bench.chain.amplitude_drift = tc * c.bench.supply.ratio;
  truths.push_back(
      {"amplitude-temperature-drift", {{"tc_amplitude", sized(tc, "1/V", 5e-4)}}, {}, {}});
}

void temperature_lag(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  Bench &bench = c.bench;
  // The lag shows only through what depends on temperature; keep that away from its small end.
  draw_drift(random, bench, scale, 0.012, truths);
  bench.thermal.lag = random.uniform(5, 30);
  truths.push_back({"temperature-lag", {{"tau_s", sized(bench.thermal.lag, "s", 0.5)}}, {}, {}});
}

void quadratic(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  const double q2 = scale * random.sign() * random.uniform(0.003, 0.02);
  c.bench.chain.quadratic = q2;
  c.bench.chain.offset_after_bend = random.chance(0.5);
  truths.push_back({"quadratic-nonlinearity", {{"q2", sized(q2, "1", 1.5e-4)}}, {}, {}});
}

void cubic(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  const double q3 = scale * random.sign() * random.uniform(0.003, 0.02);
  c.bench.chain.cubic = q3;
  c.bench.chain.offset_after_bend = random.chance(0.5);
  truths.push_back({"cubic-nonlinearity", {{"q3", sized(q3, "1", 2e-4)}}, {"weak-field"}, {}});
}

void weak_field(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  const double h = std::sqrt(scale) * random.uniform(0.1, 0.25);
  c.bench.bridge.anisotropy = h;
  truths.push_back(
      {"weak-field", {{"q", sized(3 * h * h / 8, "1", 1e-4)}}, {"cubic-nonlinearity"}, {}});
}

void harmonic(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  const bool sine = random.chance(0.5);
  const int order = 2 + static_cast<int>(random.index(4));
  const double amplitude = scale * random.uniform(0.003, 0.015);
  const double phase = random.uniform(0, kTurn);
  c.bench.chain.harmonics.push_back(
      {sine ? Channel::sine : Channel::cosine, order, amplitude, phase});
  truths.push_back({"harmonic-distortion",
                    {{"order", exact(order, "1")},
                     {"channel", text(channel_name(sine))},
                     {"amplitude", sized(amplitude, "1", 1e-4)},
                     {"phase_deg", direction(c.bench, phase, 360, 0)}},
                    {},
                    {}});
}

void clipping(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  Chain &chain = c.bench.chain;
  const bool low = random.chance(0.6);
  const bool high = !low || random.chance(0.6);
  // An output stage limits both channels alike; a fault limits one.
  const bool sine = random.chance(0.85);
  const bool cosine = !sine || random.chance(0.8);
  Truth truth{"clipping", {}, {}, {}};
  auto level = [&](double side) {
    const double peak_sine = sine ? chain.amplitude + side * chain.sine.offset : 0.0;
    const double peak_cosine = cosine ? chain.amplitude + side * chain.cosine.offset : 0.0;
    const double peak = std::max(peak_sine, peak_cosine);
    const double depth = scale * random.uniform(0.03, 0.10) * peak;
    const double volts = chain.supply / 2 + side * (peak - depth);
    truth.parameters[side > 0 ? "high_v" : "low_v"] =
        within(volts, "V", std::max(0.1 * depth, 3e-3));
    return volts;
  };
  const ClipLevels open;
  const ClipLevels levels{low ? level(-1) : open.low, high ? level(1) : open.high};
  if (sine)
    chain.clip_sine = levels;
  if (cosine)
    chain.clip_cosine = levels;
  truths.push_back(truth);
}

void low_pass(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  const double corner = random.uniform(300, 1200) / scale;
  c.bench.chain.low_pass_corner = corner;
  truths.push_back({"low-pass-rolloff", {{"corner_hz", sized(corner, "Hz", 5)}}, {}, {}});
}

void delay(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  c.bench.delay = scale * random.uniform(15e-6, 100e-6);
  truths.push_back({"propagation-delay",
                    {{"tau_s", sized(c.bench.delay, "s", 1e-6)}},
                    {"reference-delay"},
                    {"propagation-delay", "reference-delay"}});
}

// --- field and mechanics --------------------------------------------------------------------

void stray_field(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  Field &field = c.bench.field;
  field.stray = scale * random.uniform(0.002, 0.015);
  field.stray_direction = random.uniform(0, kTurn);
  truths.push_back({"stray-field",
                    {{"b", sized(field.stray, "1", 2e-4)},
                     {"direction_deg",
                      direction(c.bench, field.stray_direction, direction_period(c.bench, 1), 1)}},
                    {},
                    {}});
}

void off_axis(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  Field &field = c.bench.field;
  const double degrees = scale * random.uniform(0.08, 0.5);
  field.off_axis = degrees * kDegree;
  field.off_axis_direction = random.uniform(0, kTurn / 2);
  truths.push_back({"sensor-off-axis",
                    {{"a_deg", sized(degrees, "deg", 0.005)},
                     {"direction_deg", direction(c.bench, field.off_axis_direction, 180, 1)}},
                    {},
                    {}});
}

void direction_error(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  // Orders 1 and 2 are the stray field's and the misplaced sensor's.
  const int order = 3 + static_cast<int>(random.index(4));
  const double degrees = scale * random.uniform(0.08, 0.5);
  const double phase = random.uniform(0, kTurn);
  c.bench.field.direction_errors.push_back({order, degrees * kDegree, phase});
  truths.push_back({"field-direction-error",
                    {{"order", exact(order, "1")},
                     {"a_deg", sized(degrees, "deg", 0.005)},
                     {"phase_deg", direction(c.bench, phase, direction_period(c.bench, order),
                                             -static_cast<double>(order))}},
                    {},
                    {}});
}

void hysteresis(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  const double degrees = scale * random.uniform(0.06, 0.3);
  c.bench.bridge.hysteresis_width = degrees * kDegree;
  truths.push_back({"hysteresis", {{"width_deg", sized(degrees, "deg", 0.004)}}, {}, {}});
}

void slip(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  const double degrees = scale * random.sign() * random.log_uniform(0.3, 3.0);
  c.bench.field.slip_step = degrees * kDegree;
  c.bench.field.slip_time = time_within(random, c.bench);
  truths.push_back({"angle-slip",
                    {{"time_s", within(c.bench.field.slip_time, "s", 0.005 * c.bench.duration())},
                     {"step_deg", sized(degrees, "deg", 0.01)}},
                    {},
                    {}});
}

void nonuniformity(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  const std::vector<int> orders = {1, 2, 3, 4, 6};
  const int order = random.pick(orders);
  const double degrees = scale * random.uniform(0.1, 0.6);
  c.bench.motion.add_ripple({order, degrees * kDegree, random.uniform(0, kTurn)});
  const std::string rival = order == 1   ? "stray-field"
                            : order == 2 ? "sensor-off-axis"
                                         : "field-direction-error";
  truths.push_back({"rotation-nonuniformity",
                    {{"order", exact(order, "1")}, {"amplitude_deg", sized(degrees, "deg", 0.005)}},
                    {},
                    {"rotation-nonuniformity", rival}});
}

void eccentricity(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  Record &record = c.bench.record;
  const double degrees = scale * random.uniform(0.1, 0.8);
  record.reference_eccentricity = degrees * kDegree;
  record.reference_phase = random.uniform(0, kTurn);
  truths.push_back({"reference-eccentricity",
                    {{"e_deg", sized(degrees, "deg", 0.005)},
                     {"phase_deg", direction(c.bench, record.reference_phase,
                                             direction_period(c.bench, 1), -1)}},
                    {},
                    {}});
}

// --- acquisition ----------------------------------------------------------------------------

void skew(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  const double dt = scale * random.sign() * random.uniform(5e-6, 40e-6);
  c.bench.sampler.skew = dt;
  truths.push_back({"channel-skew", {{"dt_s", sized(dt, "s", 0.5e-6)}}, {}, {}});
}

void memory(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  c.bench.sampler.memory = scale * random.uniform(0.003, 0.015);
  truths.push_back(
      {"multiplexer-memory", {{"m", sized(c.bench.sampler.memory, "1", 1e-4)}}, {}, {}});
}

void supply_variation(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  Bench &bench = c.bench;
  const double rms = scale * random.uniform(0.004, 0.015);
  const int lines = 3 + static_cast<int>(random.index(4));
  const double low = 3.0 / bench.duration();
  const double high = std::max(4 * low, std::min(8.0, bench.sampler.rate / 50));
  double power = 0.0;
  for (int i = 0; i < lines; ++i) {
    bench.supply.lines.push_back({random.uniform(0.3, 1.0), kTurn * random.log_uniform(low, high),
                                  random.uniform(0, kTurn)});
    power += bench.supply.lines.back().amplitude * bench.supply.lines.back().amplitude / 2;
  }
  for (SupplyLine &line : bench.supply.lines)
    line.amplitude *= rms / std::sqrt(power);
  // Lines with few cycles in the capture do not have their long-term rms in it: take the actual.
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kPoints = 20000;
  for (int i = 0; i < kPoints; ++i) {
    const double v = bench.supply.at(bench.duration() * i / kPoints);
    sum += v;
    squares += v * v;
  }
  const double mean = sum / kPoints;
  const double actual = std::sqrt(squares / kPoints - mean * mean) / mean;
  truths.push_back({"supply-variation", {{"rms_fraction", sized(actual, "1", 1e-4)}}, {}, {}});
}

double distance_to_harmonic(double frequency, double rpm) {
  const double order = frequency / (rpm / 60.0);
  return std::abs(order - std::round(order));
}

void tone(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  Bench &bench = c.bench;
  const double low = std::max(2.0, 40.0 / bench.duration());
  const double high = 0.45 * bench.sampler.rate;
  auto clear = [&](double f) {
    for (double rpm : {c.lowest_rpm, c.highest_rpm})
      if (distance_to_harmonic(f, rpm) <
          std::min(0.3, std::max(0.1, 3.0 * 60.0 / (bench.duration() * rpm))))
        return false;
    return f > low && f < high;
  };
  double frequency = (random.chance(0.5) ? 50.0 : 60.0) * (1 + random.uniform(-5e-4, 5e-4));
  if (random.chance(0.6) || !clear(frequency)) {
    do
      frequency = random.log_uniform(low, high);
    while (!clear(frequency));
  }
  const double size = scale * random.uniform(1.5e-3, 6e-3);
  const double balance = random.uniform(0.25, 1.0);
  const bool sine_larger = random.chance(0.5);
  const double sine = sine_larger ? size : size * balance;
  const double cosine = sine_larger ? size * balance : size;
  bench.converter.tones.push_back(
      {frequency, sine, random.sign() * cosine, random.uniform(0, kTurn)});
  Truth truth{"periodic-interference", {}, {}, {}};
  truth.parameters["frequency_hz"] = within(frequency, "Hz", 0.5 / bench.duration());
  vector_pair(truth, "amplitude_sin_v", sine, "amplitude_cos_v", cosine, "V", 5e-5);
  truths.push_back(truth);
}

void impulses(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  const double rate = random.log_uniform(3e-4, 5e-3);
  const double size = scale * random.log_uniform(0.02, 0.3);
  double squares = 0.0;
  std::vector<Spike> &spikes = c.bench.converter.spikes;
  for (std::size_t k = 0; k < c.bench.samples; ++k) {
    if (!random.chance(rate))
      continue;
    const Spike spike{k, random.sign() * size * random.uniform(0.5, 1.4),
                      random.sign() * size * random.uniform(0.5, 1.4)};
    squares += spike.sine * spike.sine + spike.cosine * spike.cosine;
    spikes.push_back(spike);
  }
  const auto count = static_cast<double>(spikes.size());
  truths.push_back({"impulse-noise",
                    {{"rate", sized(count / static_cast<double>(c.bench.samples), "1", 1e-5)},
                     {"amplitude_v", sized(std::sqrt(squares / (2 * count)), "V", 1e-3)}},
                    {},
                    {}});
}

void excess_noise(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  Converter &converter = c.bench.converter;
  converter.excess_noise = scale * converter.noise * random.uniform(0.8, 3.0);
  Parameter rms = sized(converter.excess_noise, "V", 2e-5);
  // The name leaves open whether the excess or the whole is meant.
  rms.has_other = true;
  rms.other = std::hypot(converter.noise, converter.excess_noise);
  truths.push_back({"excess-noise", {{"rms_v", rms}}, {}, {}});
}

void sample_loss(Random &random, Conditions &c, double, std::vector<Truth> &truths) {
  Bench &bench = c.bench;
  // A gap of a turn and more is also one of less.
  const double turn = bench.sampler.rate * 60.0 / c.highest_rpm;
  const auto most = static_cast<std::size_t>(std::clamp(0.9 * turn, 5.0, 50.0));
  const std::size_t events = 1 + random.index(4);
  std::size_t total = 0;
  for (std::size_t i = 0; i < events; ++i) {
    // One event in each of as many stretches: apart from each other and from the ends.
    const double stretch = bench.duration() / static_cast<double>(events);
    const double begin = stretch * static_cast<double>(i);
    const double t =
        steady_moment(random, bench.motion, begin + 0.2 * stretch, begin + 0.8 * stretch);
    const std::size_t count = 5 + random.index(std::max<std::size_t>(5, most / events) - 4);
    bench.record.losses.push_back({static_cast<std::size_t>(t * bench.sampler.rate), count});
    total += count;
  }
  truths.push_back({"sample-loss",
                    {{"count", exact(static_cast<double>(events), "1")},
                     {"samples", sized(static_cast<double>(total), "1", 1.0)}},
                    {},
                    {}});
}

void offset_step(Random &random, Conditions &c, double scale, std::vector<Truth> &truths) {
  Chain &chain = c.bench.chain;
  const double size = scale * random.uniform(4e-3, 20e-3);
  const double angle = random.uniform(0, kTurn);
  chain.sine.step = size * std::cos(angle);
  chain.cosine.step = size * std::sin(angle);
  // A reference knows the angle at rest and in a ramp as well.
  chain.step_time = c.bench.record.has_reference ? random.uniform(0.25, 0.75) * c.bench.duration()
                                                 : time_within(random, c.bench);
  Truth truth{"offset-step", {}, {}, {}};
  truth.parameters["time_s"] = within(chain.step_time, "s", 0.005 * c.bench.duration());
  vector_pair(truth, "step_sin_v", chain.sine.step, "step_cos_v", chain.cosine.step, "V", 2e-4);
  truths.push_back(truth);
}

void stuck(Random &random, Conditions &c, double, std::vector<Truth> &truths) {
  const std::vector<StuckAt> levels = {StuckAt::last_value, StuckAt::low_rail, StuckAt::high_rail,
                                       StuckAt::middle};
  const double time =
      steady_moment(random, c.bench.motion, 0.35 * c.bench.duration(), 0.85 * c.bench.duration());
  c.bench.converter.stuck = {true, random.chance(0.5), time, random.pick(levels)};
  truths.push_back(
      {"stuck-channel",
       {{"channel", text(channel_name(c.bench.converter.stuck.sine))},
        {"time_s", within(c.bench.converter.stuck.time, "s", 0.005 * c.bench.duration())}},
       {},
       {}});
}

void swap(Random &, Conditions &c, double, std::vector<Truth> &truths) {
  c.bench.record.swapped = true;
  truths.push_back(
      {"channel-swap", {}, {"channel-inverted"}, {"channel-swap", "channel-inverted"}});
}

void inverted(Random &random, Conditions &c, double, std::vector<Truth> &truths) {
  const bool sine = random.chance(0.5);
  (sine ? c.bench.record.inverted_sine : c.bench.record.inverted_cosine) = true;
  // Which channel cannot be known either.
  truths.push_back(
      {"channel-inverted", {}, {"channel-swap"}, {"channel-swap", "channel-inverted"}});
}

using enum MotionKind;

const Wanted kYes = Wanted::yes;
const Wanted kNo = Wanted::no;

Needs anything() {
  return {};
}
Needs with_motion(std::vector<MotionKind> motions) {
  Needs needs;
  needs.motions = std::move(motions);
  return needs;
}
Needs with_reference(std::vector<MotionKind> motions = {}) {
  Needs needs = with_motion(std::move(motions));
  needs.reference = kYes;
  return needs;
}
Needs fast(Needs needs) {
  needs.fast = true;
  return needs;
}
Needs sweep() {
  Needs needs;
  needs.sweep = true;
  needs.vtemp = kYes;
  needs.motions = {one_speed, speeds, reversals, speed_reversals, ramps};
  return needs;
}

std::vector<HiddenEffect> make_table() {
  const std::vector<MotionKind> steady = {one_speed, speeds, reversals, speed_reversals};
  const std::vector<MotionKind> changing = {speeds, speed_reversals, ramps, coast};
  const std::vector<MotionKind> changing_or_both = {speeds, reversals, speed_reversals, ramps,
                                                    coast};
  Needs vtemp;
  vtemp.vtemp = kYes;
  Needs quadrature_needs = with_motion(changing_or_both);
  quadrature_needs.vtemp = kYes;
  Needs skew_needs = fast(quadrature_needs);
  Needs two_periods;
  two_periods.periods = 2;
  Needs gain_off = sweep();
  gain_off.gain_off = true;
  Needs slow = sweep();
  slow.slow = true;
  Needs low_pass_needs = fast(with_reference(changing));
  Needs noise_stated;
  noise_stated.noise = kYes;
  Needs no_reference = with_motion({one_speed});
  no_reference.reference = kNo;
  Needs vdd;
  vdd.vdd = kYes;
  std::vector<HiddenEffect> table = {
      {"amplitude-mismatch", anything(), {"mismatch"}, amplitude_mismatch},
      {"quadrature-error", quadrature_needs, {"quadrature"}, quadrature_error},
      {"offset-temperature-drift", sweep(), {"drift", "offset"}, offset_drift},
      {"offset-temperature-curvature", sweep(), {"drift", "offset"}, offset_curvature},
      {"amplitude-temperature-drift", gain_off, {"amplitude"}, amplitude_drift},
      {"temperature-lag", slow, {"drift", "offset"}, temperature_lag},
      {"quadratic-nonlinearity", anything(), {"quadratic", "harmonics"}, quadratic},
      {"cubic-nonlinearity", anything(), {"third"}, cubic},
      {"weak-field", two_periods, {"third"}, weak_field},
      {"harmonic-distortion", anything(), {"third", "harmonics"}, harmonic},
      {"clipping", anything(), {"third", "amplitude", "offset"}, clipping},
      {"low-pass-rolloff", low_pass_needs, {"lag"}, low_pass},
      {"propagation-delay", fast(with_reference(changing)), {"lag"}, delay},
      {"stray-field", with_reference(steady), {"order-1"}, stray_field},
      {"sensor-off-axis", with_reference(steady), {"order-2"}, off_axis},
      {"field-direction-error", with_reference(steady), {"order-n"}, direction_error},
      {"hysteresis", with_reference({speed_reversals}), {"lag"}, hysteresis},
      {"angle-slip", with_reference(steady), {"event"}, slip},
      {"rotation-nonuniformity", no_reference, {"order-1", "order-2", "order-n"}, nonuniformity},
      {"reference-eccentricity", with_reference(steady), {"order-1"}, eccentricity},
      {"channel-skew", skew_needs, {"quadrature"}, skew},
      {"multiplexer-memory", vtemp, {"quadrature"}, memory},
      {"supply-variation", vdd, {"amplitude", "supply"}, supply_variation},
      {"periodic-interference", with_motion(steady), {"tone"}, tone},
      {"impulse-noise", anything(), {"noise"}, impulses},
      {"excess-noise", noise_stated, {"noise"}, excess_noise},
      {"sample-loss", with_reference(steady), {"event"}, sample_loss},
      {"offset-step", anything(), {"event", "offset"}, offset_step},
      {"stuck-channel", with_motion(steady), {"event"}, stuck, true},
      {"channel-swap", with_reference(), {"wiring"}, swap, true},
      {"channel-inverted", with_reference(), {"wiring"}, inverted, true},
  };
  for (HiddenEffect &effect : bench_effects())
    table.push_back(std::move(effect));
  return table;
}

} // namespace

double direction_period(const Bench &bench, int order) {
  // Without a reference the shaft's angle is known modulo one electrical period.
  if (bench.record.has_reference || bench.bridge.periods_per_turn == 1)
    return 360.0;
  return order % 2 == 0 ? 360.0 : 180.0;
}

const std::vector<HiddenEffect> &hidden_effects() {
  static const std::vector<HiddenEffect> table = make_table();
  return table;
}

const HiddenEffect *find_effect(const std::string &cause) {
  for (const HiddenEffect &effect : hidden_effects())
    if (effect.cause == cause)
      return &effect;
  return nullptr;
}

} // namespace truth

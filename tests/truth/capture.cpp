// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "capture.h"
#include "random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace truth {
namespace {

/// V of VTEMP, as it is recorded, for each part of the supply: drifts are counted by it, and a
/// converter that keeps a part of VCOS there shows so much less of its changes.
double shown_vtemp(const Bench &bench) {
  return bench.chain.supply * (bench.sampler.scans_vtemp ? 1.0 - bench.sampler.memory : 1.0);
}

/// One output of the sensor as a function of time, asked for at rising times. Each channel owns
/// its memories (hysteresis, filter), so that skewed channels stay exact.
class AnalogOutput {
public:
  AnalogOutput(const Bench &bench, Channel channel, double first)
      : bench_(bench), channel_(channel), play_(make_play(bench, first)),
        time_constant_(
            bench.chain.low_pass_corner > 0.0 ? 1.0 / (kTurn * bench.chain.low_pass_corner) : 0.0),
        time_(first - run_in()), filter_(time_constant_, unfiltered(time_)) {
    if (time_constant_ > 0.0)
      advance(first, static_cast<int>(std::ceil((first - time_) * bench.sampler.rate)));
  }

  double gain_now = 1.0; ///< factor on the amplitude for the sample to come

  double operator()(double t) {
    if (time_constant_ <= 0.0)
      return unfiltered(t);
    advance(t, 1);
    return output_;
  }

private:
  static constexpr int kOversampling = 48;

  double run_in() const { return 15.0 * time_constant_; }

  static Play make_play(const Bench &bench, double first) {
    const double t =
        first - bench.delay -
        (bench.chain.low_pass_corner > 0.0 ? 15.0 / (kTurn * bench.chain.low_pass_corner) : 0.0);
    return Play(bench.bridge.hysteresis_width,
                bench.field.at(bench.field.magnet_angle(bench.motion.angle(t), t)).direction,
                bench.motion.speed(t));
  }

  void advance(double t, int samples) {
    const int steps = kOversampling * samples;
    const double from = time_;
    for (int i = 1; i <= steps; ++i) {
      const double next = from + (t - from) * i / steps;
      output_ = filter_(next - time_, unfiltered(next));
      time_ = next;
    }
  }

  double unfiltered(double t) {
    const double seen = t - bench_.delay;
    const double magnet = bench_.field.magnet_angle(bench_.motion.angle(seen), seen);
    FieldVector field = bench_.field.at(magnet);
    const Unknown &unknown = bench_.unknown;
    if (unknown.angle)
      field.direction += unknown.angle(seen, magnet);
    const double direction = play_(field.direction);
    Bridge bridge = bench_.bridge;
    if (unknown.quadrature)
      bridge.quadrature += unknown.quadrature(t);
    const double unit = bridge.signal(channel_, direction, field.strength);
    const double gain =
        gain_now * (unknown.gain ? unknown.gain(t) : 1.0) * (1.0 + bench_.wander.gain(t));
    const double extra = (unknown.offset ? unknown.offset(channel_, t) : 0.0) +
                         (channel_ == Channel::sine ? bench_.wander.sine : bench_.wander.cosine)(t);
    const double vtemp = shown_vtemp(bench_) * bench_.thermal.bridge_fraction(t);
    const double ratio = bench_.supply.at(t);
    double volts = bench_.chain.output(channel_, unit, bridge.periods_per_turn * direction, vtemp,
                                       t, gain, extra, ratio);
    if (unknown.transfer) {
      const double middle = ratio * bench_.chain.supply / 2;
      volts = middle + unknown.transfer(channel_, t, volts - middle);
    }
    return volts;
  }

  const Bench &bench_;
  Channel channel_;
  Play play_;
  double time_constant_;
  double time_;
  Lag filter_;
  double output_ = 0.0;
};

double wrapped_degrees(double radians) {
  const double degrees = std::fmod(radians / kDegree, 360.0);
  return degrees < 0.0 ? degrees + 360.0 : degrees;
}

/// What the reference shows at an angle of the shaft, degrees.
double reference_reading(const Record &record, double shaft, double noise) {
  double angle = shaft + record.reference_zero +
                 record.reference_eccentricity * std::sin(shaft + record.reference_phase) +
                 noise * kDegree;
  for (const ReferenceLine &line : record.reference_lines)
    angle += line.amplitude * std::sin(line.order * shaft + line.phase);
  const double degrees = wrapped_degrees(angle);
  if (record.reference_step <= 0.0)
    return degrees;
  return std::fmod(record.reference_step * std::floor(degrees / record.reference_step), 360.0);
}

/// A channel that has stopped follows nothing, but keeps its noise.
double stuck_level(const Bench &bench, double last) {
  switch (bench.converter.stuck.at) {
  case StuckAt::last_value:
    return last;
  case StuckAt::low_rail:
    return 0.02 * bench.chain.supply;
  case StuckAt::high_rail:
    return 0.98 * bench.chain.supply;
  case StuckAt::middle:
    return 0.5 * bench.chain.supply;
  }
  return last;
}

} // namespace

double mean_vtemp(const Bench &bench) {
  Lag lag(bench.thermal.lag, bench.thermal.bridge_fraction(0.0));
  double sum = 0.0;
  for (std::size_t k = 0; k < bench.samples; ++k) {
    const double t = static_cast<double>(k) / bench.sampler.rate;
    sum += k == 0 ? bench.thermal.bridge_fraction(0.0)
                  : lag(1.0 / bench.sampler.rate, bench.thermal.bridge_fraction(t));
  }
  return shown_vtemp(bench) * sum / static_cast<double>(bench.samples);
}

Capture simulate(const Bench &bench) {
  const Sampler &sampler = bench.sampler;
  const Converter &converter = bench.converter;
  Random noise(bench.noise_seed, 10);
  Random clock(bench.noise_seed, 11);
  Random gain(bench.noise_seed, 12);
  Random reading(bench.noise_seed, 13);
  const double noise_rms = std::hypot(converter.noise, converter.excess_noise);
  const double jitter = std::hypot(sampler.jitter, bench.unknown.jitter);

  AnalogOutput sine(bench, Channel::sine, 0.0);
  AnalogOutput cosine(bench, Channel::cosine, sampler.skew);
  Lag vtemp_lag(bench.thermal.lag, bench.thermal.bridge_fraction(0.0));
  Multiplexer multiplexer(sampler.memory, bench.chain.supply / 2);

  Capture capture;
  for (auto *column : {&capture.time, &capture.vsin, &capture.vcos, &capture.vtemp, &capture.vdd,
                       &capture.reference, &capture.shaft})
    column->reserve(bench.samples);

  double last_time = 0.0;
  double held_sine = 0.0;
  double held_cosine = 0.0;
  auto spike = converter.spikes.begin();
  auto loss = bench.record.losses.begin();
  for (std::size_t k = 0; k < bench.samples; ++k) {
    const double nominal = static_cast<double>(k) / sampler.rate;
    // Less than half a period early or late, or the order of samples would be lost.
    const double wobble =
        std::clamp(jitter * clock.normal(), -0.4 / sampler.rate, 0.4 / sampler.rate);
    const double t = k == 0 ? 0.0 : nominal * (1 + sampler.clock_error) + wobble;

    if (bench.gain_noise > 0.0)
      sine.gain_now = cosine.gain_now = 1.0 + bench.gain_noise * gain.normal();
    double line_sine = sine(t);
    double line_cosine = cosine(t + sampler.skew);
    const double vtemp_fraction = k == 0
                                      ? bench.thermal.bridge_fraction(t)
                                      : vtemp_lag(t - last_time, bench.thermal.bridge_fraction(t));
    const double ratio = bench.supply.at(t);
    const double line_vtemp = ratio * bench.chain.supply * vtemp_fraction;
    for (const Tone &tone : converter.tones) {
      line_sine += tone.sine * std::sin(kTurn * tone.frequency * t + tone.phase);
      line_cosine +=
          tone.cosine * std::sin(kTurn * tone.frequency * (t + sampler.skew) + tone.phase);
    }
    if (converter.stuck.active && t >= converter.stuck.time) {
      if (converter.stuck.sine)
        line_sine = stuck_level(bench, held_sine);
      else
        line_cosine = stuck_level(bench, held_cosine);
    }
    held_sine = line_sine;
    held_cosine = line_cosine;

    double vsin = multiplexer(line_sine) + noise_rms * noise.normal();
    double vcos = multiplexer(line_cosine) + noise_rms * noise.normal();
    double vtemp = sampler.scans_vtemp ? multiplexer(line_vtemp) : line_vtemp;
    vtemp += converter.vtemp_noise * noise.normal();
    const double vdd = ratio * bench.chain.supply + converter.vdd_noise * noise.normal();
    const double reference_noise = bench.record.reference_noise * noise.normal();
    if (spike != converter.spikes.end() && spike->sample == k) {
      vsin += spike->sine;
      vcos += spike->cosine;
      ++spike;
    }
    last_time = t;

    if (loss != bench.record.losses.end() && k >= loss->sample) {
      if (k + 1 >= loss->sample + loss->count)
        ++loss;
      continue;
    }

    vsin = converter.quantise(vsin);
    vcos = converter.quantise(vcos);
    if (bench.unknown.code) {
      vsin = bench.unknown.code(vsin);
      vcos = bench.unknown.code(vcos);
    }
    const double middle = bench.chain.supply / 2;
    if (bench.record.inverted_sine)
      vsin = 2 * middle - vsin;
    if (bench.record.inverted_cosine)
      vcos = 2 * middle - vcos;
    if (bench.record.swapped)
      std::swap(vsin, vcos);

    const double shaft = bench.motion.angle(t);
    capture.time.push_back(static_cast<double>(capture.time.size()) / sampler.rate);
    capture.vsin.push_back(vsin);
    capture.vcos.push_back(vcos);
    capture.vtemp.push_back(converter.quantise(vtemp));
    // VDD comes through a divider by two, or it would not fit the converter's range.
    capture.vdd.push_back(2 * converter.quantise(vdd / 2));
    const double read_at =
        t + bench.record.reference_delay + bench.record.reference_jitter * reading.normal();
    capture.reference.push_back(reference_reading(
        bench.record, read_at == t ? shaft : bench.motion.angle(read_at), reference_noise));
    capture.shaft.push_back(shaft);
  }
  return capture;
}

void write_text(std::ostream &out, const Bench &bench, const Capture &capture,
                bool exact_reference) {
  const Record &record = bench.record;
  std::array<char, 200> line{};
  auto print = [&](const char *format, auto... values) {
    const int length = std::snprintf(line.data(), line.size(), format, values...);
    out.write(line.data(), length);
  };
  out << "# ada4571-capture/1\n";
  print("# supply_v = %.1f\n", bench.chain.supply);
  print("# periods_per_turn = %d\n", bench.bridge.periods_per_turn);
  out << "# gain_control = " << (record.gain_control ? "on" : "off") << '\n';
  if (record.states_noise)
    print("# noise_rms_v = %.6f\n", bench.converter.noise);
  print("# adc_bits = %d\n", bench.converter.bits);
  print("# adc_reference_v = %.1f\n", bench.converter.reference);
  print("# sample_rate_hz = %.1f\n", bench.sampler.rate);
  out << "# serial = " << record.serial << '\n';
  const bool reference = record.has_reference || exact_reference;
  out << "time_s,vsin_v,vcos_v" << (record.has_vtemp ? ",vtemp_v" : "")
      << (record.has_vdd ? ",vdd_v" : "") << (reference ? ",reference_deg" : "") << '\n';
  for (std::size_t i = 0; i < capture.time.size(); ++i) {
    print("%.6f,%.6f,%.6f", capture.time[i], capture.vsin[i], capture.vcos[i]);
    if (record.has_vtemp)
      print(",%.6f", capture.vtemp[i]);
    if (record.has_vdd)
      print(",%.5f", capture.vdd[i]);
    if (exact_reference)
      print(",%.6f", wrapped_degrees(capture.shaft[i] + record.reference_zero));
    else if (reference)
      print(",%.4f", capture.reference[i]);
    out << '\n';
  }
}

} // namespace truth

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "simulation/simulation.h"

#include <cmath>
#include <random>

#include "base/error.h"
#include "simulation/generator.h"
#include "simulation/simulated_source.h"

namespace ada {

Model sound_sensor(std::uint64_t seed, double supply_v, bool gain_control) {
  Rng rng(seed);
  std::normal_distribution<double> normal;
  Model model;
  model.supply_v = supply_v;
  model.baseline.amplitude_v = 0.29 * supply_v;
  model.baseline.offset_sin_v = 0.004 * supply_v * normal(rng);
  model.baseline.offset_cos_v = 0.004 * supply_v * normal(rng);
  model.vtemp_reference_v = supply_v * (kVtempFractionAtZero + 25.0 * kVtempFractionPerDegree);
  const auto slope = [&](double offset_v) {
    // A part of the drift goes with the offset itself, as makers of such parts model it.
    const double volts_per_degree = 0.001 * offset_v + 5e-6 * supply_v * normal(rng);
    return volts_per_degree / (kVtempFractionPerDegree * supply_v);
  };
  const double tc_sin = slope(model.baseline.offset_sin_v);
  const double tc_cos = slope(model.baseline.offset_cos_v);
  model.effects.push_back({find_effect("offset-temperature-drift"), {tc_sin, tc_cos}, {}});
  if (!gain_control)
    model.effects.push_back({find_effect("amplitude-temperature-drift"),
                             {-0.003 / (kVtempFractionPerDegree * supply_v)},
                             {}});
  model.provenance.gain_control = gain_control;
  model.provenance.method = "simulation";
  return model;
}

Simulation::Simulation(std::optional<Model> model, SimulationOptions options, std::uint64_t seed)
    : model_(model ? std::move(*model)
                   : sound_sensor(seed, options.adc_reference_v, options.gain_control)),
      options_(std::move(options)), seed_(seed) {
  const auto require = [](bool good, const char *what) {
    if (!good)
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT, what);
  };
  require(std::isfinite(options_.sample_rate_hz) && options_.sample_rate_hz > 0.0 &&
              options_.sample_rate_hz <= 1e8,
          "the sample rate must lie between 0 and 100 MHz");
  require(std::isfinite(options_.duration_s) && options_.duration_s >= 0.0,
          "the duration must be 0 or more");
  require(options_.duration_s * options_.sample_rate_hz <= kMostSimulatedSamples,
          "more than 100 million samples: simulate a shorter time");
  require(std::isfinite(options_.noise_rms_v) && options_.noise_rms_v >= 0.0,
          "the noise must be 0 or more");
  require(options_.adc_bits >= 0 && options_.adc_bits <= 32, "the converter has 0 to 32 bits");
  require(std::isfinite(options_.adc_reference_v) && options_.adc_reference_v > 0.0,
          "the converter's reference must be above 0 V");
  parse_motion(options_.motion, options_.duration_s); // throws on what it cannot read
  parse_temperature(options_.temperature, options_.duration_s);
}

Capture Simulation::run() const {
  if (options_.duration_s <= 0.0)
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "a capture needs a duration above 0");
  Generator generator(*this);
  const double samples = std::round(options_.duration_s * options_.sample_rate_hz);
  Capture capture = generator.next(static_cast<std::size_t>(std::max(1.0, samples)));
  CaptureMetadata &meta = capture.meta;
  meta.supply_v = model_.supply_v;
  meta.periods_per_turn = model_.periods_per_turn;
  meta.gain_control = options_.gain_control;
  meta.noise_rms_v = options_.noise_rms_v;
  meta.sample_rate_hz = options_.sample_rate_hz;
  if (options_.adc_bits > 0) {
    meta.adc_bits = options_.adc_bits;
    meta.adc_reference_v = options_.adc_reference_v;
  }
  meta.serial = "simulated-" + std::to_string(seed_);
  meta.origin = "simulation, seed " + std::to_string(seed_);
  return capture;
}

std::unique_ptr<Source> Simulation::source(bool realtime) const {
  return std::make_unique<SimulatedSource>(*this, realtime);
}

} // namespace ada

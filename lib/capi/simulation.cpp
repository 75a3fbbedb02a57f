// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "simulation/profile.h"
#include "simulation/simulation.h"

#include "capi/guard.h"
#include "capi/handles.h"

using namespace ada;
using namespace ada::capi;

namespace {

SimulationOptions translate(const ada4571_simulation_options &o) {
  SimulationOptions out;
  out.sample_rate_hz = o.sample_rate_hz;
  out.duration_s = o.duration_s;
  out.noise_rms_v = o.noise_rms_v;
  out.adc_bits = o.adc_bits;
  out.adc_reference_v = o.adc_reference_v;
  if (o.motion)
    out.motion = o.motion;
  if (o.temperature)
    out.temperature = o.temperature;
  out.gain_control = o.gain_control != 0;
  out.has_vtemp = o.has_vtemp != 0;
  out.has_vdd = o.has_vdd != 0;
  out.has_reference = o.has_reference != 0;
  return out;
}

} // namespace

extern "C" {

void ada4571_simulation_options_init(ada4571_simulation_options *options) {
  if (!options)
    return;
  const SimulationOptions defaults;
  *options = {};
  options->struct_size = sizeof *options;
  options->sample_rate_hz = defaults.sample_rate_hz;
  options->duration_s = defaults.duration_s;
  options->noise_rms_v = defaults.noise_rms_v;
  options->adc_bits = defaults.adc_bits;
  options->adc_reference_v = defaults.adc_reference_v;
  options->gain_control = 1;
  options->has_vtemp = options->has_vdd = options->has_reference = 1;
}

const char *ada4571_motion_example(size_t index) {
  const auto examples = motion_examples();
  return index < examples.size() ? examples[index] : nullptr;
}

const char *ada4571_temperature_example(size_t index) {
  const auto examples = temperature_examples();
  return index < examples.size() ? examples[index] : nullptr;
}

ada4571_status ada4571_simulation_new(const ada4571_model *model,
                                      const ada4571_simulation_options *options, uint64_t seed,
                                      ada4571_simulation **simulation) {
  return guard([&] {
    require(simulation, "simulation");
    SimulationOptions o;
    if (options) {
      require_struct(options, "options");
      o = translate(*options);
    }
    std::optional<Model> copy;
    if (model)
      copy = model->impl;
    *simulation = new ada4571_simulation{
        std::make_shared<const Simulation>(std::move(copy), std::move(o), seed)};
  });
}

ada4571_status ada4571_simulation_model(const ada4571_simulation *simulation,
                                        ada4571_model **model) {
  return guard([&] {
    require(simulation, "simulation");
    require(model, "model");
    *model = new ada4571_model{simulation->impl->model()};
  });
}

ada4571_status ada4571_simulation_run(const ada4571_simulation *simulation,
                                      ada4571_recording **recording) {
  return guard([&] {
    require(simulation, "simulation");
    require(recording, "recording");
    *recording = new ada4571_recording{
        recording_of(std::make_shared<const Capture>(simulation->impl->run()))};
  });
}

void ada4571_simulation_free(ada4571_simulation *simulation) {
  delete simulation;
}

} // extern "C"

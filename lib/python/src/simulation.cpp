// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <pybind11/stl.h>

#include "call.h"

namespace binding {

namespace {

Simulation new_simulation(const Model *model, const py::dict &wanted, std::uint64_t seed) {
  auto o = initialised(ada4571_simulation_options_init);
  std::string motion, temperature;
  const auto take = [&wanted]<class T>(const char *key, T &value) {
    if (wanted.contains(key) && !wanted[key].is_none())
      value = wanted[key].cast<T>();
  };
  take("sample_rate_hz", o.sample_rate_hz);
  take("duration_s", o.duration_s);
  take("noise_rms_v", o.noise_rms_v);
  take("adc_bits", o.adc_bits);
  take("adc_reference_v", o.adc_reference_v);
  take("gain_control", o.gain_control);
  take("has_vtemp", o.has_vtemp);
  take("has_vdd", o.has_vdd);
  take("has_reference", o.has_reference);
  take("motion", motion);
  take("temperature", temperature);
  if (!motion.empty())
    o.motion = motion.c_str();
  if (!temperature.empty())
    o.temperature = temperature.c_str();
  const auto work = [&](ada4571_simulation **fresh) {
    return ada4571_simulation_new(model ? model->get() : nullptr, &o, seed, fresh);
  };
  return model ? made<Simulation, ada4571_simulation>(work, *model)
               : made<Simulation, ada4571_simulation>(work);
}

} // namespace

void add_simulation(py::module_ &module) {
  py::class_<Simulation>(module, "Simulation")
      .def(py::init(&new_simulation))
      .def("model",
           [](const Simulation &simulation) {
             return made<Model, ada4571_model>(
                 [&](ada4571_model **fresh) {
                   return ada4571_simulation_model(simulation.get(), fresh);
                 },
                 simulation);
           })
      .def("run", [](const Simulation &simulation) {
        return made<Recording, ada4571_recording>(
            [&](ada4571_recording **fresh) { return ada4571_simulation_run(simulation.get(), fresh); },
            simulation);
      });
  py::class_<Emulator>(module, "Emulator")
      .def(py::init([](const Simulation &simulation, int port) {
        return made<Emulator, ada4571_emulator>(
            [&](ada4571_emulator **fresh) {
              return ada4571_emulator_new(simulation.get(), port, fresh);
            },
            simulation);
      }))
      .def(py::init([](const Recording &recording, double speed, int port) {
        return made<Emulator, ada4571_emulator>(
            [&](ada4571_emulator **fresh) {
              return ada4571_emulator_new_replay(recording.get(), speed, port, fresh);
            },
            recording);
      }))
      .def("port", [](const Emulator &emulator) { return ada4571_emulator_port(emulator.get()); })
      .def("run",
           [](const Emulator &emulator) {
             call([&] { return ada4571_emulator_run(emulator.get()); }, emulator);
           })
      .def("stop", [](const Emulator &emulator) { ada4571_emulator_stop(emulator.get()); });
}

} // namespace binding

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <pybind11/stl.h>

#include "call.h"

namespace binding {

namespace {

using namespace py::literals;

py::tuple described(const ada4571_parameter &p) {
  return py::make_tuple(p.name, p.value, p.std_error, p.unit);
}

py::dict described(const ada4571_effect_info &info) {
  return py::dict("id"_a = info.id, "cause"_a = info.cause, "stage"_a = info.stage,
                  "correctable"_a = info.correctable != 0, "parameters"_a = py::list());
}

/// Both the catalogue and a model: `effect` and `parameter` read entry and parameter.
template <class Effect, class Parameter>
py::list effects(std::size_t count, Effect effect, Parameter parameter) {
  py::list all;
  for (std::size_t i = 0; i < count; ++i) {
    auto info = initialised(ada4571_effect_info_init);
    check(Outcome(effect(i, &info)));
    py::dict entry = described(info);
    for (std::size_t j = 0; j < info.parameters; ++j) {
      auto p = initialised(ada4571_parameter_init);
      check(Outcome(parameter(i, j, &p)));
      entry["parameters"].cast<py::list>().append(described(p));
    }
    all.append(entry);
  }
  return all;
}

py::list model_effects(const Model &model) {
  return effects(
      ada4571_model_effect_count(model.get()),
      [&](std::size_t i, ada4571_effect_info *info) {
        return ada4571_model_effect(model.get(), i, info);
      },
      [&](std::size_t i, std::size_t j, ada4571_parameter *p) {
        return ada4571_model_parameter(model.get(), i, j, p);
      });
}

py::dict baseline(const Model &model) {
  auto b = initialised(ada4571_baseline_init);
  check(Outcome(ada4571_model_get_baseline(model.get(), &b)));
  return py::dict("periods_per_turn"_a = b.periods_per_turn, "supply_v"_a = b.supply_v,
                  "amplitude_v"_a = b.amplitude_v, "offset_sin_v"_a = b.offset_sin_v,
                  "offset_cos_v"_a = b.offset_cos_v, "angle_zero_deg"_a = b.angle_zero_deg,
                  "vtemp_reference_v"_a = b.vtemp_reference_v);
}

Model ideal(const py::dict &wanted) {
  auto b = initialised(ada4571_baseline_init);
  const auto take = [&wanted]<class T>(const char *key, T &value) {
    if (wanted.contains(key))
      value = wanted[key].cast<T>();
  };
  take("periods_per_turn", b.periods_per_turn);
  take("supply_v", b.supply_v);
  take("amplitude_v", b.amplitude_v);
  take("offset_sin_v", b.offset_sin_v);
  take("offset_cos_v", b.offset_cos_v);
  take("angle_zero_deg", b.angle_zero_deg);
  take("vtemp_reference_v", b.vtemp_reference_v);
  return made<Model, ada4571_model>(
      [&](ada4571_model **fresh) { return ada4571_model_new(&b, fresh); });
}

Model single(const Recording &recording, int method) {
  return made<Model, ada4571_model>(
      [&](ada4571_model **fresh) {
        return ada4571_calibrate_single(recording.get(),
                                        static_cast<ada4571_calibration_method>(method), fresh);
      },
      recording);
}

Model dual(const Recording &cold, const Recording &hot, int method) {
  const auto work = [&](ada4571_model **fresh) {
    return ada4571_calibrate_dual(cold.get(), hot.get(),
                                  static_cast<ada4571_calibration_method>(method), fresh);
  };
  // One recording twice would lock its mutex twice; the library says what is wrong with it.
  if (&cold == &hot)
    return made<Model, ada4571_model>(work, cold);
  return made<Model, ada4571_model>(work, cold, hot);
}

} // namespace

void add_models(py::module_ &module) {
  py::class_<Model>(module, "Model")
      .def(py::init(&ideal))
      .def_static("load",
                  [](const std::string &path) {
                    return made<Model, ada4571_model>([&](ada4571_model **fresh) {
                      return ada4571_model_load(path.c_str(), fresh);
                    });
                  })
      .def("save",
           [](const Model &model, const std::string &path) {
             call([&] { return ada4571_model_save(model.get(), path.c_str()); }, model);
           })
      .def("add_effect",
           [](const Model &model, const std::string &text) {
             call([&] { return ada4571_model_add_effect(model.get(), text.c_str()); }, model);
           })
      .def("baseline", baseline)
      .def("effects", model_effects);
  module.def("catalogue_range", [](std::size_t effect, std::size_t parameter) {
    std::pair<double, double> ends;
    check(Outcome(ada4571_catalogue_range(effect, parameter, &ends.first, &ends.second)));
    return ends;
  });
  module.def("catalogue", [] {
    return effects(ada4571_catalogue_count(), ada4571_catalogue_get, ada4571_catalogue_parameter);
  });
  module.def("calibrate_single", single);
  module.def("calibrate_dual", dual);
}

} // namespace binding

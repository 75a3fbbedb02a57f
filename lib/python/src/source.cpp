// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <algorithm>

#include <pybind11/stl.h>

#include "frames.h"

namespace binding {

namespace {

using namespace py::literals;

/// Between two looks at Python's signals; nobody sees a stop that is late by this.
constexpr int kSliceMs = 50;

Source open_device(const py::dict &wanted) {
  auto o = initialised(ada4571_source_options_init);
  // Lives until the call is over, as the strings of the options must.
  std::vector<std::string> texts;
  texts.reserve(wanted.size());
  const auto text = [&](const char *key, const char *&value) {
    if (wanted.contains(key) && !wanted[key].is_none())
      value = texts.emplace_back(wanted[key].cast<std::string>()).c_str();
  };
  text("uri", o.uri);
  text("device", o.device);
  text("sin", o.sin_channel);
  text("cos", o.cos_channel);
  text("temp", o.temp_channel);
  text("vdd", o.vdd_channel);
  text("trigger", o.trigger);
  o.sample_rate_hz = wanted["sample_rate_hz"].cast<double>();
  o.supply_v = wanted["supply_v"].cast<double>();
  o.periods_per_turn = wanted["periods_per_turn"].cast<int>();
  o.buffer_frames = wanted["buffer_frames"].cast<std::size_t>();
  return made<Source, ada4571_source>(
      [&](ada4571_source **fresh) { return ada4571_source_open(&o, fresh); });
}

/// Reads into frames[filled, ...) until there is one, the time is over, or the source ends; gives
/// how many came and whether it ended. Python's signals are looked at meanwhile.
std::pair<std::size_t, bool> read(const Source &source, const py::object &given, std::size_t filled,
                                  double timeout_s) {
  Frames frames = as_frames(given);
  if (filled > static_cast<std::size_t>(frames.size()))
    throw py::value_error("more filled than there is room");
  ada4571_frame *room = frames.mutable_data() + filled;
  const std::size_t capacity = static_cast<std::size_t>(frames.size()) - filled;
  double left_ms = timeout_s < 0 ? HUGE_VAL : 1e3 * timeout_s;
  for (;;) {
    std::size_t count = 0;
    ada4571_read_outcome outcome = ADA4571_READ_TIMEOUT;
    const int wait_ms = static_cast<int>(std::min<double>(kSliceMs, left_ms));
    call([&] { return ada4571_source_read(source.get(), room, capacity, wait_ms, &count, &outcome); },
         source);
    if (PyErr_CheckSignals() != 0)
      throw py::error_already_set();
    left_ms -= wait_ms;
    if (outcome == ADA4571_READ_END || outcome == ADA4571_READ_CANCELLED)
      return {0, true};
    if (outcome == ADA4571_READ_FRAMES || left_ms <= 0)
      return {count, false};
  }
}

py::dict source_info(const Source &source) {
  auto i = initialised(ada4571_source_info_init);
  check(Outcome(ada4571_source_get_info(source.get(), &i)));
  return py::dict("description"_a = i.description, "serial"_a = i.serial,
                  "sample_rate_hz"_a = i.sample_rate_hz, "supply_v"_a = i.supply_v,
                  "periods_per_turn"_a = i.periods_per_turn, "gain_control"_a = i.gain_control,
                  "has_vtemp"_a = i.has_vtemp != 0, "has_vdd"_a = i.has_vdd != 0,
                  "has_reference"_a = i.has_reference != 0);
}

py::dict statistics(const Source &source) {
  auto s = initialised(ada4571_source_statistics_init);
  call([&] { return ada4571_source_get_statistics(source.get(), &s); }, source);
  return py::dict("frames"_a = s.frames, "lost"_a = s.lost, "gaps"_a = s.gaps);
}

py::list devices(const std::optional<std::string> &uri) {
  using List = Handle<ada4571_device_list, ada4571_device_list_free>;
  const auto list = made<List, ada4571_device_list>(
      [&](ada4571_device_list **fresh) { return ada4571_device_list_new(or_null(uri), fresh); });
  py::list all;
  for (std::size_t i = 0; i < ada4571_device_list_count(list.get()); ++i) {
    ada4571_device d{};
    d.struct_size = sizeof d;
    check(Outcome(ada4571_device_list_get(list.get(), i, &d)));
    all.append(py::dict("id"_a = d.id, "name"_a = d.name, "label"_a = d.label,
                        "channels"_a = d.channels, "sin_channel"_a = d.sin_channel,
                        "cos_channel"_a = d.cos_channel, "temp_channel"_a = d.temp_channel,
                        "vdd_channel"_a = d.vdd_channel, "labelled"_a = d.labelled != 0));
  }
  return all;
}

py::list stored(const std::optional<std::string> &name) {
  using List = Handle<ada4571_stored_list, ada4571_stored_list_free>;
  const auto list = made<List, ada4571_stored_list>(
      [&](ada4571_stored_list **fresh) { return ada4571_stored_list_new(or_null(name), fresh); });
  py::list all;
  for (std::size_t i = 0; i < ada4571_stored_list_count(list.get()); ++i) {
    auto s = initialised(ada4571_stored_init);
    check(Outcome(ada4571_stored_list_get(list.get(), i, &s)));
    all.append(py::dict("name"_a = s.name, "path"_a = s.path, "uri"_a = s.uri,
                        "device"_a = s.device, "sin_channel"_a = s.sin_channel,
                        "cos_channel"_a = s.cos_channel, "temp_channel"_a = s.temp_channel,
                        "vdd_channel"_a = s.vdd_channel,
                        "calibration_file"_a = s.calibration_file, "problem"_a = s.problem));
  }
  return all;
}

template <auto Function> void simple(const Source &source) {
  call([&] { return Function(source.get()); }, source);
}

} // namespace

void add_sources(py::module_ &module) {
  py::class_<Source>(module, "Source")
      .def_static("named",
                  [](const std::string &name) {
                    return made<Source, ada4571_source>([&](ada4571_source **fresh) {
                      return ada4571_open(name.c_str(), fresh);
                    });
                  })
      .def_static("device", open_device)
      .def_static("recording",
                  [](const Recording &recording) {
                    return made<Source, ada4571_source>(
                        [&](ada4571_source **fresh) {
                          return ada4571_source_open_recording(recording.get(), fresh);
                        },
                        recording);
                  })
      .def_static("replay",
                  [](const Recording &recording, double speed) {
                    return made<Source, ada4571_source>(
                        [&](ada4571_source **fresh) {
                          return ada4571_source_open_replay(recording.get(), speed, fresh);
                        },
                        recording);
                  })
      .def_static("simulation",
                  [](const Simulation &simulation, bool realtime) {
                    return made<Source, ada4571_source>(
                        [&](ada4571_source **fresh) {
                          return ada4571_source_open_simulation(simulation.get(), realtime, fresh);
                        },
                        simulation);
                  })
      .def("start", simple<ada4571_source_start>)
      .def("stop", simple<ada4571_source_stop>)
      // Any thread may cancel, and must not wait for the read that it is to end.
      .def("cancel",
           [](const Source &source) { check(Outcome(ada4571_source_cancel(source.get()))); })
      .def("close", close<Source>)
      .def("read", read)
      .def("fileno",
           [](const Source &source) {
             int fd = -1;
             call([&] { return ada4571_source_get_fd(source.get(), &fd); }, source);
             return fd;
           })
      .def("set_buffer",
           [](const Source &source, std::size_t frames) {
             call([&] { return ada4571_source_set_buffer(source.get(), frames); }, source);
           })
      .def("info", source_info)
      .def("statistics", statistics)
      .def("calibration",
           [](const Source &source) {
             return made<Model, ada4571_model>(
                 [&](ada4571_model **fresh) {
                   return ada4571_source_read_calibration(source.get(), fresh);
                 },
                 source);
           })
      .def("model_for",
           [](const Source &source, const Model &model) {
             return made<Model, ada4571_model>(
                 [&](ada4571_model **fresh) {
                   return ada4571_model_for_source(model.get(), source.get(), fresh);
                 },
                 source, model);
           })
      .def("write_calibration",
           [](const Source &source, const Model &model) {
             call([&] { return ada4571_source_write_calibration(source.get(), model.get()); },
                  source, model);
           })
      .def("save_config", [](const Source &source, const std::string &name,
                             const std::optional<std::string> &calibration) {
        call([&] {
          return ada4571_source_save_config(source.get(), name.c_str(), or_null(calibration));
        }, source);
      });
  module.def("devices", devices);
  module.def("stored", stored);
}

} // namespace binding

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <pybind11/stl.h>

#include "frames.h"

namespace binding {

namespace {

py::dict recording_info(const Recording &recording) {
  auto i = initialised(ada4571_recording_info_init);
  check(Outcome(ada4571_recording_get_info(recording.get(), &i)));
  return described(i);
}

Frames read_all(const Recording &recording) {
  auto i = initialised(ada4571_recording_info_init);
  check(Outcome(ada4571_recording_get_info(recording.get(), &i)));
  Frames frames(static_cast<py::ssize_t>(i.samples));
  ada4571_frame *data = frames.mutable_data();
  std::size_t count = 0;
  call([&] { return ada4571_recording_read(recording.get(), 0, data, i.samples, &count); },
       recording);
  frames.attr("setflags")(py::arg("write") = false);
  return frames;
}

Writer open_writer(const std::string &path, const py::dict &wanted, bool growing, bool resume) {
  auto i = initialised(ada4571_recording_info_init);
  std::string serial, origin;
  const auto take = [&wanted]<class T>(const char *key, T &value) {
    if (wanted.contains(key))
      value = wanted[key].cast<T>();
  };
  take("supply_v", i.supply_v);
  take("periods_per_turn", i.periods_per_turn);
  take("gain_control", i.gain_control);
  take("noise_rms_v", i.noise_rms_v);
  take("sample_rate_hz", i.sample_rate_hz);
  take("adc_bits", i.adc_bits);
  take("adc_reference_v", i.adc_reference_v);
  take("has_vtemp", i.has_vtemp);
  take("has_vdd", i.has_vdd);
  take("has_reference", i.has_reference);
  take("serial", serial);
  take("origin", origin);
  i.serial = serial.empty() ? nullptr : serial.c_str();
  i.origin = origin.empty() ? nullptr : origin.c_str();
  return made<Writer, ada4571_writer>(
      [&](ada4571_writer **fresh) {
        return growing ? ada4571_writer_open_growing(path.c_str(), &i, resume, fresh)
                       : ada4571_writer_open(path.c_str(), &i, fresh);
      });
}

} // namespace

py::dict described(const ada4571_recording_info &i) {
  using namespace py::literals;
  return py::dict("samples"_a = i.samples, "duration_s"_a = i.duration_s, "supply_v"_a = i.supply_v,
                  "periods_per_turn"_a = i.periods_per_turn, "gain_control"_a = i.gain_control,
                  "noise_rms_v"_a = i.noise_rms_v, "sample_rate_hz"_a = i.sample_rate_hz,
                  "adc_bits"_a = i.adc_bits, "adc_reference_v"_a = i.adc_reference_v,
                  "has_vtemp"_a = i.has_vtemp != 0, "has_vdd"_a = i.has_vdd != 0,
                  "has_reference"_a = i.has_reference != 0,
                  "serial"_a = i.serial ? i.serial : "", "origin"_a = i.origin ? i.origin : "");
}

void add_recordings(py::module_ &module) {
  py::class_<Recording>(module, "Recording")
      .def(py::init([](const std::string &path) {
        return made<Recording, ada4571_recording>(
            [&](ada4571_recording **fresh) { return ada4571_recording_open(path.c_str(), fresh); });
      }))
      .def("info", recording_info)
      .def("frames", read_all)
      .def("metadata",
           [](const Recording &recording, const std::string &key) -> std::optional<std::string> {
             const char *value = ada4571_recording_metadata(recording.get(), key.c_str());
             return value ? std::optional<std::string>(value) : std::nullopt;
           })
      .def("save", [](const Recording &recording, const std::string &path) {
        call([&] { return ada4571_recording_save(recording.get(), path.c_str()); }, recording);
      });
  py::class_<Writer>(module, "Writer")
      .def(py::init(&open_writer))
      .def("metadata",
           [](const Writer &writer, const std::string &key, const std::string &value) {
             call([&] { return ada4571_writer_metadata(writer.get(), key.c_str(), value.c_str()); },
                  writer);
           })
      .def("write",
           [](const Writer &writer, const py::object &given) {
             const Frames frames = as_frames(given);
             const ada4571_frame *data = frames.data();
             const auto count = static_cast<std::size_t>(frames.size());
             call([&] { return ada4571_writer_write(writer.get(), data, count); }, writer);
           })
      .def("finish",
           [](const Writer &writer) {
             call([&] { return ada4571_writer_finish(writer.get()); }, writer);
           })
      .def("close", close<Writer>);
}

} // namespace binding

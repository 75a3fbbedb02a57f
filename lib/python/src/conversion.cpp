// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <pybind11/stl.h>

#include "frames.h"
#include "watcher.h"

namespace binding {

namespace {

/// Angles of frames, written by the library into the array that Python gets.
template <auto Function, class Handle> Angles convert(const Handle &handle, const py::object &given) {
  const Frames frames = as_frames(given);
  const auto count = static_cast<std::size_t>(frames.size());
  Angles angles(frames.size());
  const ada4571_frame *from = frames.data();
  ada4571_angle *to = angles.mutable_data();
  call([&] { return Function(handle.get(), from, count, to); }, handle);
  return angles;
}

Angles convert_recording(const Converter &converter, const Recording &recording) {
  auto info = initialised(ada4571_recording_info_init);
  check(Outcome(ada4571_recording_get_info(recording.get(), &info)));
  Angles angles(static_cast<py::ssize_t>(info.samples));
  ada4571_angle *to = angles.mutable_data();
  call([&] { return ada4571_converter_recording(converter.get(), recording.get(), to); }, converter,
       recording);
  return angles;
}

/// A recording into a file of angles, block by block.
template <auto Function, class Handle>
void save(const Handle &handle, const Recording &recording, const std::string &path,
          const py::object &progress) {
  Watcher watcher(progress);
  const Outcome outcome = released(
      [&] {
        return Function(handle.get(), recording.get(), path.c_str(), ADA4571_ANGLES_BY_NAME,
                        Watcher::on_progress, &watcher);
      },
      handle, recording);
  watcher.raise_if_ended();
  check(outcome);
}

ada4571_sample_type sample_type(const py::dtype &type) {
  struct Row {
    char kind;
    py::ssize_t size;
    ada4571_sample_type type;
  };
  constexpr Row kRows[] = {{'i', 1, ADA4571_S8},  {'u', 1, ADA4571_U8},  {'i', 2, ADA4571_S16},
                           {'u', 2, ADA4571_U16}, {'i', 4, ADA4571_S32}, {'u', 4, ADA4571_U32},
                           {'f', 4, ADA4571_F32}, {'f', 8, ADA4571_F64}};
  const bool native = type.attr("isnative").cast<bool>();
  for (const Row &row : kRows)
    if (native && row.kind == type.kind() && row.size == type.itemsize())
      return row.type;
  throw py::type_error("raw samples are integers of 8, 16 or 32 bits, float32 or float64, in the "
                       "machine's byte order");
}

ada4571_layout layout_of(const py::array &sin, const py::array &cos, double scale_v, double offset,
                         unsigned shift, unsigned bits) {
  if (sin.ndim() != 1 || cos.ndim() != 1 || sin.shape(0) != cos.shape(0) || sin.size() == 0 ||
      sin.strides(0) != cos.strides(0) || sin.strides(0) < 0 || !sin.dtype().equal(cos.dtype()))
    throw py::value_error("sin and cos are two arrays of one dimension, length, type and stride");
  auto layout = initialised(ada4571_layout_init);
  layout.type = sample_type(sin.dtype());
  layout.stride_bytes = static_cast<std::size_t>(sin.strides(0));
  layout.scale_v = scale_v;
  layout.offset = offset;
  layout.shift = shift;
  layout.bits = bits;
  return layout;
}

py::tuple convert_raw(const Converter &converter, const py::array &sin, const py::array &cos,
                      double scale_v, double offset, unsigned shift, unsigned bits) {
  const ada4571_layout layout = layout_of(sin, cos, scale_v, offset, shift, bits);
  const auto count = static_cast<std::size_t>(sin.size());
  py::array_t<double> angle(sin.size()), radius(sin.size());
  double *to_angle = angle.mutable_data(), *to_radius = radius.mutable_data();
  const void *from_sin = sin.data(), *from_cos = cos.data();
  call([&] {
    return ada4571_converter_raw_f64(converter.get(), &layout, from_sin, from_cos, count, to_angle,
                                     to_radius);
  }, converter);
  return py::make_tuple(angle, radius);
}

Tracker new_tracker(const Model &model, bool amplitude, bool phase, double rate) {
  auto o = initialised(ada4571_tracker_options_init);
  o.track_amplitude = amplitude;
  o.track_phase = phase;
  o.max_offset_rate_v_per_s = rate;
  return made<Tracker, ada4571_tracker>(
      [&](ada4571_tracker **fresh) { return ada4571_tracker_new(model.get(), &o, fresh); }, model);
}

} // namespace

void add_conversion(py::module_ &module) {
  py::class_<Converter>(module, "Converter")
      .def(py::init([](const Model &model) {
        return made<Converter, ada4571_converter>(
            [&](ada4571_converter **fresh) { return ada4571_converter_new(model.get(), fresh); },
            model);
      }))
      .def("frames", convert<ada4571_converter_frames, Converter>)
      .def("recording", convert_recording)
      .def("save", save<ada4571_converter_save, Converter>)
      .def("raw", convert_raw);
  py::class_<Tracker>(module, "Tracker")
      .def(py::init(&new_tracker))
      .def("frames", convert<ada4571_tracker_frames, Tracker>)
      .def("save", save<ada4571_tracker_save, Tracker>)
      .def("model", [](const Tracker &tracker) {
        return made<Model, ada4571_model>(
            [&](ada4571_model **fresh) { return ada4571_tracker_model(tracker.get(), fresh); },
            tracker);
      });
}

} // namespace binding

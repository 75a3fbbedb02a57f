// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <cstdint>
#include <optional>
#include <span>

#include "capi/angle_form.h"
#include "capi/guard.h"
#include "capi/handles.h"
#include "conversion/frame_converter.h"
#include "conversion/raw_converter.h"
#include "conversion/vector_kernels.h"

struct ada4571_converter {
  ada::Model model;
  ada::FrameConverter frames;
  std::optional<ada::RawConverter> raw; ///< where the model allows it

  explicit ada4571_converter(const ada::Model &m) : model(m), frames(m) {
    try {
      raw.emplace(m);
    } catch (const ada::Error &e) {
      if (e.status() != ADA4571_ERROR_UNSUPPORTED)
        throw;
    }
  }

  const ada::RawConverter &raw_or_why_not() const {
    if (!raw)
      ada::RawConverter{model}; // throws the reason
    return *raw;
  }
};

namespace capi = ada::capi;

namespace {

template <class T>
ada4571_status convert_raw(const ada4571_converter *converter, const ada4571_layout *layout,
                           const void *sin, const void *cos, std::size_t count, T *angle,
                           T *radius) noexcept {
  return capi::guard([&] {
    capi::require(converter, "converter");
    capi::require_struct(layout, "layout");
    const ada::RawConverter &raw = converter->raw_or_why_not();
    if (count == 0)
      return;
    capi::require(sin, "sin");
    capi::require(cos, "cos");
    capi::require(angle, "angle_rad");
    raw.convert(*layout, sin, cos, count, angle, radius);
  });
}

template <class T, class Kernel>
ada4571_status arctangents(const T *y, const T *x, std::size_t count, T *out,
                           Kernel kernel) noexcept {
  return capi::guard([&] {
    if (count == 0)
      return;
    capi::require(y, "y");
    capi::require(x, "x");
    capi::require(out, "out");
    kernel(y, x, count, out);
  });
}

} // namespace

extern "C" {

ada4571_status ada4571_converter_new(const ada4571_model *model, ada4571_converter **converter) {
  return capi::guard([&] {
    capi::require(model, "model");
    capi::require(converter, "converter");
    *converter = new ada4571_converter(model->impl);
  });
}

ada4571_status ada4571_converter_frames(ada4571_converter *converter, const ada4571_frame *frames,
                                        size_t count, ada4571_angle *angles) {
  return capi::guard([&] {
    capi::require(converter, "converter");
    if (count == 0)
      return;
    capi::require(frames, "frames");
    capi::require(angles, "angles");
    converter->frames.frames({frames, count}, {angles, count});
  });
}

ada4571_status ada4571_converter_recording(ada4571_converter *converter,
                                           const ada4571_recording *recording,
                                           ada4571_angle *angles) {
  return capi::guard([&] {
    capi::require(converter, "converter");
    capi::require(recording, "recording");
    const std::size_t count = recording->impl->size();
    if (count == 0)
      return;
    capi::require(angles, "angles");
    converter->frames.capture(*recording->impl->whole(), {angles, count});
  });
}

ada4571_status ada4571_converter_save(const ada4571_converter *converter,
                                      const ada4571_recording *recording, const char *path,
                                      ada4571_angle_form form, ada4571_progress progress,
                                      void *user) {
  return capi::guard([&] {
    capi::require(converter, "converter");
    capi::require(recording, "recording");
    capi::require(path, "path");
    ada::save_angles(
        converter->model, *recording->impl, path, capi::angle_form_of(form),
        [&](double done) { capi::report_progress(progress, user, done, "converting"); });
  });
}

void ada4571_layout_init(ada4571_layout *layout) {
  if (layout != nullptr)
    *layout = {sizeof *layout, ADA4571_S16, 2 * sizeof(std::int16_t), 1.0, 0.0, 0, 0};
}

ada4571_status ada4571_converter_raw_f32(const ada4571_converter *converter,
                                         const ada4571_layout *layout, const void *sin,
                                         const void *cos, size_t count, float *angle_rad,
                                         float *radius) {
  return convert_raw(converter, layout, sin, cos, count, angle_rad, radius);
}

ada4571_status ada4571_converter_raw_f64(const ada4571_converter *converter,
                                         const ada4571_layout *layout, const void *sin,
                                         const void *cos, size_t count, double *angle_rad,
                                         double *radius) {
  return convert_raw(converter, layout, sin, cos, count, angle_rad, radius);
}

ada4571_status ada4571_atan2_f32(const float *y, const float *x, size_t count, float *out) {
  return arctangents(y, x, count, out, ada::atan2_f32);
}

ada4571_status ada4571_atan2_f64(const double *y, const double *x, size_t count, double *out) {
  return arctangents(y, x, count, out, ada::atan2_f64);
}

const char *ada4571_vector_target(void) {
  return ada::vector_target();
}

void ada4571_converter_free(ada4571_converter *converter) {
  delete converter;
}

} // extern "C"

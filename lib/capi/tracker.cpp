// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/tracker.h"
#include "capi/angle_form.h"
#include "capi/guard.h"
#include "capi/handles.h"

struct ada4571_tracker {
  ada::Tracker impl;
};

namespace capi = ada::capi;

extern "C" {

void ada4571_tracker_options_init(ada4571_tracker_options *options) {
  const ada::TrackerOptions defaults;
  if (options != nullptr)
    *options = {sizeof *options, defaults.track_amplitude, defaults.track_phase,
                defaults.max_offset_rate_v_per_s};
}

ada4571_status ada4571_tracker_new(const ada4571_model *model,
                                   const ada4571_tracker_options *options,
                                   ada4571_tracker **tracker) {
  return capi::guard([&] {
    capi::require(model, "model");
    capi::require(tracker, "tracker");
    ada::TrackerOptions o;
    if (options != nullptr) {
      capi::require_struct(options, "options");
      o = {options->track_amplitude != 0, options->track_phase != 0,
           options->max_offset_rate_v_per_s};
    }
    *tracker = new ada4571_tracker{ada::Tracker(model->impl, o)};
  });
}

ada4571_status ada4571_tracker_frames(ada4571_tracker *tracker, const ada4571_frame *frames,
                                      size_t count, ada4571_angle *angles) {
  return capi::guard([&] {
    capi::require(tracker, "tracker");
    if (count == 0)
      return;
    capi::require(frames, "frames");
    capi::require(angles, "angles");
    tracker->impl.frames({frames, count}, {angles, count});
  });
}

ada4571_status ada4571_tracker_save(ada4571_tracker *tracker, const ada4571_recording *recording,
                                    const char *path, ada4571_angle_form form,
                                    ada4571_progress progress, void *user) {
  return capi::guard([&] {
    capi::require(tracker, "tracker");
    capi::require(recording, "recording");
    capi::require(path, "path");
    ada::save_angles(
        [&](auto in, auto out) { tracker->impl.frames(in, out); },
        360.0 / tracker->impl.model().periods_per_turn, *recording->impl, path,
        capi::angle_form_of(form),
        [&](double done) { capi::report_progress(progress, user, done, "converting"); });
  });
}

ada4571_status ada4571_tracker_model(const ada4571_tracker *tracker, ada4571_model **model) {
  return capi::guard([&] {
    capi::require(tracker, "tracker");
    capi::require(model, "model");
    *model = new ada4571_model{tracker->impl.model()};
  });
}

void ada4571_tracker_free(ada4571_tracker *tracker) {
  delete tracker;
}

} // extern "C"

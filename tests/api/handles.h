// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// One valid handle of every kind that needs no device, and small helpers.
#pragma once

#include <gtest/gtest.h>

#include "ada4571.h"

namespace api {

/// A struct of the library, initialised.
template <class Struct> Struct initialised(void (*init)(Struct *)) {
  Struct value;
  init(&value);
  return value;
}

/// Calls a function whose last argument gives a handle; the test fails when the call does.
template <class Handle, class Function, class... Arguments>
Handle *make(Function function, Arguments... arguments) {
  Handle *handle = nullptr;
  EXPECT_EQ(function(arguments..., &handle), ADA4571_OK) << ada4571_last_error();
  return handle;
}

struct Handles {
  Handles() {
    auto options = initialised(ada4571_simulation_options_init);
    options.duration_s = 1;
    const ada4571_simulation_options *const given = &options;
    simulation = make<ada4571_simulation>(
        ada4571_simulation_new, static_cast<ada4571_model *>(nullptr), given, std::uint64_t{4571});
    recording = make<ada4571_recording>(ada4571_simulation_run, simulation);
    model = make<ada4571_model>(ada4571_calibrate_single, recording, ADA4571_CALIBRATE_FIT);
    converter = make<ada4571_converter>(ada4571_converter_new, model);
    source = make<ada4571_source>(ada4571_source_open_simulation, simulation, 0);
  }
  ~Handles() {
    ada4571_source_free(source);
    ada4571_converter_free(converter);
    ada4571_model_free(model);
    ada4571_recording_free(recording);
    ada4571_simulation_free(simulation);
  }
  Handles(const Handles &) = delete;
  Handles &operator=(const Handles &) = delete;

  ada4571_simulation *simulation;
  ada4571_recording *recording;
  ada4571_model *model;
  ada4571_converter *converter;
  ada4571_source *source;
};

} // namespace api

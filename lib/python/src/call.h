// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// How every function of the library is called from Python: without the interpreter's lock, by one
// thread a handle, and with the library's sentence as the exception.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include <pybind11/pybind11.h>

#include "ada4571.h"

namespace binding {

namespace py = pybind11;

template <auto Free> struct Freed {
  template <class T> void operator()(T *handle) const noexcept { Free(handle); }
};

/// A handle of the library and the lock that keeps it to one thread at a time.
template <class T, auto Free> class Handle {
public:
  Handle() = default;
  explicit Handle(T *handle) : handle_(handle) {}

  T *get() const noexcept { return handle_.get(); }
  std::mutex &mutex() const noexcept { return *mutex_; }
  void reset() noexcept { handle_.reset(); }

private:
  std::unique_ptr<T, Freed<Free>> handle_;
  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();
};

using Recording = Handle<ada4571_recording, ada4571_recording_free>;
using Model = Handle<ada4571_model, ada4571_model_free>;
using Source = Handle<ada4571_source, ada4571_source_free>;
using Converter = Handle<ada4571_converter, ada4571_converter_free>;
using Tracker = Handle<ada4571_tracker, ada4571_tracker_free>;
using Simulation = Handle<ada4571_simulation, ada4571_simulation_free>;
using Emulator = Handle<ada4571_emulator, ada4571_emulator_free>;
using Diagnosis = Handle<ada4571_diagnosis, ada4571_diagnosis_free>;
using Import = Handle<ada4571_import, ada4571_import_free>;
using Writer = Handle<ada4571_writer, ada4571_writer_free>;
using Study = Handle<ada4571_study, ada4571_study_free>;
using Pins = Handle<ada4571_pins, ada4571_pins_free>;

/// What a call gave, taken in the thread that made it.
struct Outcome {
  ada4571_status status = ADA4571_OK;
  std::string sentence;

  explicit Outcome(ada4571_status given) : status(given) {
    if (given != ADA4571_OK)
      sentence = ada4571_last_error();
  }
};

/// Raises the exception of the module that belongs to the status.
void check(const Outcome &outcome);

/// Calls without the interpreter's lock, holding those of the handles.
template <class Function, class... Handles>
Outcome released(Function function, const Handles &...handles) {
  const py::gil_scoped_release release;
  [[maybe_unused]] const std::scoped_lock lock(handles.mutex()...);
  return Outcome(function());
}

/// The same where failure is an exception.
template <class Function, class... Handles> void call(Function function, const Handles &...handles) {
  check(released(function, handles...));
}

/// Calls a function whose last argument gives a new handle.
template <class Wanted, class T, class Function, class... Handles>
Wanted made(Function function, const Handles &...handles) {
  T *fresh = nullptr;
  call([&] { return function(&fresh); }, handles...);
  return Wanted(fresh);
}

/// Frees the handle now, when whoever uses it is done.
template <class Handle> void close(Handle &handle) {
  const py::gil_scoped_release release;
  const std::scoped_lock lock(handle.mutex());
  handle.reset();
}

/// A struct of the library, initialised.
template <class Struct> Struct initialised(void (*init)(Struct *)) {
  Struct value;
  init(&value);
  return value;
}

/// A string that may be absent, for the library.
inline const char *or_null(const std::optional<std::string> &text) {
  return text ? text->c_str() : nullptr;
}

/// What a capture says of itself, as Python has it.
py::dict described(const ada4571_recording_info &info);

void add_recordings(py::module_ &module);
void add_imports(py::module_ &module);
void add_models(py::module_ &module);
void add_sources(py::module_ &module);
void add_conversion(py::module_ &module);
void add_simulation(py::module_ &module);
void add_diagnosis(py::module_ &module);
void add_studies(py::module_ &module);
void add_pins(py::module_ &module);

} // namespace binding

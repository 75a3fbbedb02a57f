// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Handles of the C API that free themselves, and failures that carry the exit status.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "ada4571.h"

namespace cli {

/// Exit statuses of the program.
inline constexpr int kDone = 0;
inline constexpr int kUnusable = 1;   ///< the data or the device is unusable
inline constexpr int kWrongUsage = 2; ///< the command line is wrong

/// Ends the verb: the message goes to standard error, the status to the shell.
class Failure : public std::runtime_error {
public:
  Failure(int exit_status, const std::string &message)
      : std::runtime_error(message), exit_status_(exit_status) {}

  int exit_status() const noexcept { return exit_status_; }

private:
  int exit_status_;
};

/// Throws the library's sentence, of data or a device that cannot be used.
inline void check(ada4571_status status, int exit_status = kUnusable) {
  if (status == ADA4571_OK)
    return;
  std::string message = ada4571_last_error();
  if (message.empty())
    message = ada4571_status_name(status);
  throw Failure(exit_status, message);
}

/// The same for a call with arguments of the command line: what the library refuses of them is
/// wrong usage.
inline void check_usage(ada4571_status status) {
  check(status, status == ADA4571_ERROR_INVALID_ARGUMENT ? kWrongUsage : kUnusable);
}

template <auto Free> struct Freed {
  template <class T> void operator()(T *handle) const noexcept { Free(handle); }
};

using Source = std::unique_ptr<ada4571_source, Freed<ada4571_source_free>>;
using DeviceList = std::unique_ptr<ada4571_device_list, Freed<ada4571_device_list_free>>;
using StoredList = std::unique_ptr<ada4571_stored_list, Freed<ada4571_stored_list_free>>;
using Recording = std::unique_ptr<ada4571_recording, Freed<ada4571_recording_free>>;
using Writer = std::unique_ptr<ada4571_writer, Freed<ada4571_writer_free>>;
using File = std::unique_ptr<ada4571_file, Freed<ada4571_file_free>>;
using Model = std::unique_ptr<ada4571_model, Freed<ada4571_model_free>>;
using Converter = std::unique_ptr<ada4571_converter, Freed<ada4571_converter_free>>;
using Tracker = std::unique_ptr<ada4571_tracker, Freed<ada4571_tracker_free>>;
using Pins = std::unique_ptr<ada4571_pins, Freed<ada4571_pins_free>>;
using Simulation = std::unique_ptr<ada4571_simulation, Freed<ada4571_simulation_free>>;
using Emulator = std::unique_ptr<ada4571_emulator, Freed<ada4571_emulator_free>>;
using Diagnosis = std::unique_ptr<ada4571_diagnosis, Freed<ada4571_diagnosis_free>>;
using Health = std::unique_ptr<ada4571_health, Freed<ada4571_health_free>>;

/// Calls a function of the library whose last argument gives the new handle.
template <class Handle, class Function, class... Arguments>
Handle make(Function function, Arguments... arguments) {
  typename Handle::pointer handle = nullptr;
  check(function(arguments..., &handle));
  return Handle(handle);
}

/// The same where the arguments are those of the command line.
template <class Handle, class Function, class... Arguments>
Handle make_as_asked(Function function, Arguments... arguments) {
  typename Handle::pointer handle = nullptr;
  check_usage(function(arguments..., &handle));
  return Handle(handle);
}

/// A struct of the library, initialised: `initialised<ada4571_layout>(ada4571_layout_init)`.
template <class Struct> Struct initialised(void (*init)(Struct *)) {
  Struct value;
  init(&value);
  return value;
}

} // namespace cli

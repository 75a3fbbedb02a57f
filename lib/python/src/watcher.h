// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <optional>
#include <utility>

#include "call.h"

namespace binding {

/// What the library's progress reaches: the callable, and the exception that ends the work.
class Watcher {
public:
  explicit Watcher(py::object progress) : progress_(std::move(progress)) {}

  /// Called by the library in the thread of the call, which does not hold the interpreter.
  static int on_progress(double fraction, const char *what, void *user) {
    const py::gil_scoped_acquire acquire;
    return static_cast<Watcher *>(user)->look(fraction, what);
  }

  /// Raises what ended the work, a Ctrl-C or an exception of the callable.
  void raise_if_ended() {
    if (ended_)
      throw std::move(*ended_);
  }

private:
  int look(double fraction, const char *what) {
    try {
      if (PyErr_CheckSignals() != 0)
        throw py::error_already_set();
      if (!progress_.is_none())
        progress_(fraction, what);
      return 0;
    } catch (py::error_already_set &error) {
      ended_.emplace(error);
      return 1;
    }
  }

  py::object progress_;
  std::optional<py::error_already_set> ended_;
};

} // namespace binding

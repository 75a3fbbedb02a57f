// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The one place where exceptions end: status and message at the C boundary.
#pragma once

#include <exception>
#include <new>
#include <string>

#include "ada4571.h"
#include "base/error.h"

namespace ada::capi {

/// Message of the last failure in this thread; defined in status.cpp.
void set_last_error(const char *message) noexcept;

/// Runs the body of a C function; whatever it throws becomes a status and a message.
template <class Body> ada4571_status guard(Body &&body) noexcept {
  try {
    body();
    return ADA4571_OK;
  } catch (const Error &e) {
    set_last_error(e.what());
    return e.status();
  } catch (const std::bad_alloc &) {
    set_last_error("out of memory");
    return ADA4571_ERROR_NO_MEMORY;
  } catch (const std::exception &e) {
    set_last_error(e.what());
    return ADA4571_ERROR_INTERNAL;
  } catch (...) {
    set_last_error("unknown exception");
    return ADA4571_ERROR_INTERNAL;
  }
}

/// Throws when a required argument is NULL.
template <class T> void require(const T *pointer, const char *name) {
  if (pointer == nullptr)
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, std::string(name) + " is NULL");
}

/// Throws when a caller's struct was not initialised by its _init function. Fields that a newer
/// caller knows and this library does not are refused rather than ignored.
template <class T> void require_struct(const T *options, const char *name) {
  require(options, name);
  if (options->struct_size != sizeof(T))
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                std::string(name) + ".struct_size is wrong: initialise it with its _init function");
}

/// Element of a list that a caller counts through.
template <class Range> const auto &at(const Range &range, std::size_t index, const char *what) {
  if (index >= range.size())
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "there is no " + std::string(what) + " " +
                                                    std::to_string(index) + ", only " +
                                                    std::to_string(range.size()));
  return range[index];
}

/// A caller's progress as the functions of the library call it; throws when that ends the work.
inline void report_progress(ada4571_progress progress, void *user, double fraction,
                            const char *what) {
  if (progress != nullptr && progress(fraction, what, user) != 0)
    throw Error(ADA4571_ERROR_STATE, std::string(what) + " was stopped");
}

inline std::string text_or_empty(const char *s) { return s ? std::string(s) : std::string(); }

} // namespace ada::capi

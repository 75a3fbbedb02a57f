// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <cstring>
#include <exception>
#include <string>

#include "base/parallel.h"
#include "base/text.h"
#include "capi/guard.h"

namespace {

/// Fixed storage: reporting a failure must not itself need memory.
thread_local char last_error[1024] = "";

} // namespace

namespace ada::capi {

void set_last_error(const char *message) noexcept {
  std::string line;
  try { // a message may quote a server or a file
    line = printable(message != nullptr ? message : "");
    message = line.c_str();
  } catch (const std::exception &) {
  }
  std::strncpy(last_error, message != nullptr ? message : "", sizeof last_error - 1);
  last_error[sizeof last_error - 1] = '\0';
}

} // namespace ada::capi

extern "C" {

const char *ada4571_last_error(void) {
  return last_error;
}

const char *ada4571_version(void) {
  return ADA4571_VERSION_STRING;
}

const char *ada4571_status_name(ada4571_status status) {
  switch (status) {
#define ADA4571_NAME(x)                                                                            \
  case x:                                                                                          \
    return #x
    ADA4571_NAME(ADA4571_OK);
    ADA4571_NAME(ADA4571_ERROR_INVALID_ARGUMENT);
    ADA4571_NAME(ADA4571_ERROR_STATE);
    ADA4571_NAME(ADA4571_ERROR_NO_MEMORY);
    ADA4571_NAME(ADA4571_ERROR_IO);
    ADA4571_NAME(ADA4571_ERROR_FORMAT);
    ADA4571_NAME(ADA4571_ERROR_NOT_FOUND);
    ADA4571_NAME(ADA4571_ERROR_PERMISSION);
    ADA4571_NAME(ADA4571_ERROR_BUSY);
    ADA4571_NAME(ADA4571_ERROR_DISCONNECTED);
    ADA4571_NAME(ADA4571_ERROR_UNSUPPORTED);
    ADA4571_NAME(ADA4571_ERROR_UNUSABLE_DATA);
    ADA4571_NAME(ADA4571_ERROR_INTERNAL);
#undef ADA4571_NAME
  }
  return "ADA4571_STATUS_UNKNOWN";
}

void ada4571_set_jobs(unsigned jobs) {
  ada::set_jobs(jobs);
}

} // extern "C"

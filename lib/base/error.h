// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The one exception type of the library. Inside the library a failure is thrown as Error;
// capi/guard.h turns it into a status and a message, so nothing is thrown across the C boundary.
#pragma once

#include <stdexcept>
#include <string>

#include "ada4571.h"

namespace ada {

class Error : public std::runtime_error {
public:
  Error(ada4571_status status, const std::string &message)
      : std::runtime_error(message), status_(status) {}

  ada4571_status status() const noexcept { return status_; }

private:
  ada4571_status status_;
};

} // namespace ada

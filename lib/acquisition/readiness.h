// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The descriptor that a source gives to an event loop: one epoll instance over whatever makes a
// read worth while.
#pragma once

#include <cerrno>

#include <sys/epoll.h>

#include "acquisition/iio_library.h"
#include "base/descriptor.h"
#include "base/error.h"

namespace ada {

class Readiness {
public:
  Readiness() : epoll_(epoll_create1(EPOLL_CLOEXEC)) {
    if (epoll_.get() < 0)
      throw Error(ADA4571_ERROR_IO, "cannot make an epoll instance: " + errno_text(errno));
  }

  int fd() const noexcept { return epoll_.get(); }

  /// It is forgotten again when it is closed.
  void watch(int fd) {
    epoll_event event{};
    event.events = EPOLLIN;
    if (epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, fd, &event) != 0 && errno != EEXIST)
      throw Error(ADA4571_ERROR_IO, "cannot watch a descriptor: " + errno_text(errno));
  }

private:
  Descriptor epoll_;
};

} // namespace ada

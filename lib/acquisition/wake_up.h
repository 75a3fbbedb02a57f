// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// How one thread wakes another without a lock that either could hold: an eventfd, and a flag on
// top of one.
#pragma once

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <limits>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "acquisition/iio_library.h"
#include "base/error.h"

namespace ada {

/// Time left until a deadline as poll() takes it, rounded up.
inline int poll_timeout(std::chrono::steady_clock::time_point deadline) {
  using std::chrono::milliseconds;
  if (deadline == std::chrono::steady_clock::time_point::max())
    return -1;
  const auto left =
      std::chrono::ceil<milliseconds>(deadline - std::chrono::steady_clock::now()).count();
  return left <= 0                                ? 0
         : left > std::numeric_limits<int>::max() ? std::numeric_limits<int>::max()
                                                  : static_cast<int>(left);
}

/// One side rings, the other one polls the fd, clears it, and then looks at what the ring was for.
class WakeUp {
public:
  WakeUp() : fd_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (fd_ < 0)
      throw Error(ADA4571_ERROR_IO, "cannot make an eventfd: " + errno_text(errno));
  }
  ~WakeUp() { close(fd_); }
  WakeUp(const WakeUp &) = delete;
  WakeUp &operator=(const WakeUp &) = delete;

  int fd() const noexcept { return fd_; }
  void ring() noexcept {
    const std::uint64_t one = 1;
    (void)!write(fd_, &one, sizeof one); // full: then it is ringing already
  }
  void clear() noexcept {
    std::uint64_t count = 0;
    (void)!read(fd_, &count, sizeof count);
  }
  /// Waits for a ring until the deadline, and clears it.
  void wait(std::chrono::steady_clock::time_point deadline) noexcept {
    pollfd fd = {fd_, POLLIN, 0};
    if (poll(&fd, 1, poll_timeout(deadline)) > 0)
      clear();
  }

private:
  int fd_;
};

/// Raised by any thread, lowered by the one that reads; its fd is readable while it is up.
class Cancellation {
public:
  bool raised() const noexcept { return raised_.load(std::memory_order_acquire); }
  int fd() const noexcept { return wake_up_.fd(); }
  void raise() noexcept {
    raised_.store(true, std::memory_order_release);
    wake_up_.ring();
  }
  void lower() noexcept {
    raised_.store(false, std::memory_order_release);
    wake_up_.clear();
  }

private:
  std::atomic<bool> raised_{false};
  WakeUp wake_up_;
};

} // namespace ada

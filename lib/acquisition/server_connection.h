// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A connection to a server of IIO devices, which is not believed: lengths are checked, and an
// answer that never ends is given up.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>

#include "acquisition/wake_up.h"
#include "base/descriptor.h"

namespace ada {

/// What ends a command, an errno; caught where the command was given.
struct ServerFailed {
  int error;
};

/// What does not come within the time-out fails with ETIMEDOUT, and after cancel() everything with
/// EBADF. Neither allocates nor locks once it is connected.
class ServerConnection {
public:
  /// `host` as a number or a name that the system resolves: EHOSTUNREACH where it does not. Until
  /// stand_alone() `other`, where there is one, cancels as cancel() does.
  ServerConnection(const std::string &host, const std::string &port,
                   std::chrono::milliseconds timeout, const Cancellation *other);

  void stand_alone() noexcept { other_ = nullptr; }

  void cancel() noexcept { cancelled_.raise(); }
  void send(std::string_view bytes);
  /// All of them, however long they take as long as some come within the time-out, and none is
  /// waited for after the deadline.
  void receive(std::byte *out, std::size_t count,
               std::chrono::steady_clock::time_point deadline =
                   std::chrono::steady_clock::time_point::max());
  /// A line that is a number, all of it within the time-out; a few empty ones before it do not
  /// count.
  long number();

private:
  using Clock = std::chrono::steady_clock;

  void wait(short events, Clock::time_point deadline);
  std::size_t receive_some(std::byte *out, std::size_t count, Clock::time_point deadline);
  char next_byte(Clock::time_point deadline);
  Clock::time_point soon() const { return Clock::now() + timeout_; }

  std::chrono::milliseconds timeout_;
  const Cancellation *other_;
  Descriptor socket_;
  Cancellation cancelled_;
  std::array<std::byte, 512> held_; ///< came together with a line
  std::size_t begin_ = 0, end_ = 0;
};

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// libiio waits for an answer of a server byte by byte, each with a time-out of its own and empty
// lines for ever: one that goes on sending holds it as long as it likes. What takes too long is
// ended from outside, by closing the connection under it.
#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include <sys/types.h>

#include "acquisition/wake_up.h"
#include "base/no_pipe_signal.h"

namespace ada {

/// A connected socket of this process.
struct OpenSocket {
  int fd;
  ino_t inode; ///< tells it from a later one of the same number
  bool operator==(const OpenSocket &) const = default;
};

/// Those whose other end has this port; of TCP, and none where the system does not show them.
std::vector<OpenSocket> sockets_to(const std::string &port);

/// While it lives, and no longer than `limit` or until the cancellation is raised: then the
/// connections are shut down, so that whoever reads from them is told that they are over. Made and
/// destroyed by the thread that reads.
class ServerWatch {
public:
  /// Watches these. With `all_but` all to the port but these, as they are when the time is over:
  /// for the connection that is being made.
  enum class Which { these, all_but };
  ServerWatch(std::string port, std::vector<OpenSocket> sockets, Which which,
              std::chrono::milliseconds limit, const Cancellation *cancellation = nullptr);
  ~ServerWatch();
  ServerWatch(const ServerWatch &) = delete;
  ServerWatch &operator=(const ServerWatch &) = delete;

  /// It took too long, or was cancelled.
  bool over() const noexcept { return over_; }

private:
  void run();

  NoPipeSignal quiet_;
  std::string port_;
  std::vector<OpenSocket> sockets_;
  Which which_;
  std::chrono::steady_clock::time_point deadline_;
  const Cancellation *cancellation_;
  WakeUp done_;
  std::atomic<bool> over_{false};
  std::thread thread_; ///< none where there is nothing to watch
};

} // namespace ada

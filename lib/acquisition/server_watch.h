// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// libiio waits for an answer of a server byte by byte, each with a time-out of its own and empty
// lines for ever: one that goes on sending holds it as long as it likes. What takes too long is
// ended from outside, by closing the connection under it.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
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

/// The same for one dialogue after another over the same connections, by one thread: to make one
/// for each took longer than the dialogue. For one thread at a time.
class DialogueWatch {
public:
  DialogueWatch(std::string port, std::vector<OpenSocket> sockets, std::chrono::milliseconds limit);
  ~DialogueWatch();
  DialogueWatch(const DialogueWatch &) = delete;
  DialogueWatch &operator=(const DialogueWatch &) = delete;

  /// One dialogue; it may take no longer than the limit. One at a time.
  class Dialogue {
  public:
    explicit Dialogue(DialogueWatch &watch) : watch_(watch) { watch_.set_deadline(true); }
    ~Dialogue() { watch_.set_deadline(false); }
    Dialogue(const Dialogue &) = delete;
    Dialogue &operator=(const Dialogue &) = delete;

  private:
    NoPipeSignal quiet_;
    DialogueWatch &watch_;
  };

private:
  using Time = std::chrono::steady_clock::time_point;
  void set_deadline(bool begins);
  void run();

  std::vector<OpenSocket> sockets_;
  std::chrono::milliseconds limit_;
  WakeUp wake_;
  std::mutex mutex_;
  Time deadline_ = Time::max();    ///< of the dialogue that goes on
  Time looks_again_ = Time::max(); ///< when the thread wakes without being woken
  bool done_ = false;
  std::thread thread_; ///< from the first dialogue on; none where there is nothing to watch
};

} // namespace ada

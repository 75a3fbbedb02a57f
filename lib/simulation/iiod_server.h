// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A server for the network protocol of libiio 0.24: text lines that end in CR LF from the client,
// answers that begin with a number (a length, 0, or a negative errno) and a line end. It serves up
// to kMostClients clients at once, each buffer on a connection of its own, as libiio opens them,
// and holds no more than kMostBufferBytes (iiod_buffer.h) for all of their buffers together.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string_view>
#include <thread>

#include "simulation/served_context.h"

namespace ada {

/// Clients at once; more are turned away.
inline constexpr std::size_t kMostClients = 64;

/// What a test wants to go wrong.
struct IiodFault {
  enum class Kind {
    none,
    error,        ///< answer -value
    stall,        ///< no answer until the server stops or the client goes
    drop,         ///< close this connection without an answer
    short_answer, ///< READBUF: close after half of the data, else after half of the answer
    raw_answer,   ///< send `text` instead of the answer
  };
  Kind kind = Kind::none;
  int value = 0;
  std::string text{};
};

class IiodServer {
public:
  /// Asked before each command, with its line; from the threads of the connections.
  using FaultHook = std::function<IiodFault(std::string_view line)>;

  /// Listens on 127.0.0.1:port, 0: a free one. Throws BUSY, PERMISSION or IO.
  IiodServer(std::shared_ptr<ServedContext> context, int port, FaultHook faults = {});
  ~IiodServer();
  IiodServer(const IiodServer &) = delete;
  IiodServer &operator=(const IiodServer &) = delete;

  int port() const { return port_; }

  /// Serves until stop(). May be called once.
  void run();
  /// From any thread and from signal handlers; run() returns and every connection is closed.
  void stop() noexcept;

private:
  struct Client {
    std::thread thread;
    std::atomic<bool> done{false};
  };

  void accept_client();
  void pause();
  void reap(bool all);

  std::shared_ptr<ServedContext> context_;
  FaultHook faults_;
  int port_ = 0, listen_fd_ = -1, stop_fd_ = -1;
  std::list<Client> clients_;
};

/// Serves one connection until it ends or stop_fd becomes readable. Closes nothing.
void serve_iiod_connection(int fd, int stop_fd, ServedContext &context,
                           const IiodServer::FaultHook &faults);

} // namespace ada

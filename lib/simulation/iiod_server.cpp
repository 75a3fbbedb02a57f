// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "simulation/iiod_server.h"

#include <cerrno>
#include <cstring>
#include <system_error>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/descriptor.h"
#include "base/error.h"

namespace ada {

namespace {

/// A client that reads nothing for so long is given up.
constexpr timeval kSendTimeout{10, 0};

/// How long the server leaves new clients waiting when descriptors, threads or memory have run out.
constexpr int kPauseMs = 200;

int listen_on_loopback(int port) {
  const std::string place = "127.0.0.1:" + std::to_string(port);
  // Non-blocking: a client that hangs up between poll and accept must not hold the server.
  Descriptor fd(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (fd.get() < 0)
    throw system_error(errno, place, "cannot make a socket");
  const int yes = 1;
  setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (bind(fd.get(), reinterpret_cast<sockaddr *>(&address), sizeof address) != 0) {
    const int error = errno;
    if (error == EADDRINUSE)
      throw Error(ADA4571_ERROR_BUSY, place + ": the port is in use; choose another");
    throw system_error(error, place, "cannot bind");
  }
  if (listen(fd.get(), 16) != 0)
    throw system_error(errno, place, "cannot listen");
  return fd.release();
}

} // namespace

IiodServer::IiodServer(std::shared_ptr<ServedContext> context, int port, FaultHook faults)
    : context_(std::move(context)), faults_(std::move(faults)) {
  if (port < 0 || port > 65535)
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "the port must be from 0 to 65535");
  Descriptor listener(listen_on_loopback(port));
  sockaddr_in address{};
  socklen_t size = sizeof address;
  getsockname(listener.get(), reinterpret_cast<sockaddr *>(&address), &size);
  port_ = ntohs(address.sin_port);
  stop_fd_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (stop_fd_ < 0)
    throw system_error(errno, "server", "cannot make an eventfd");
  listen_fd_ = listener.release();
}

IiodServer::~IiodServer() {
  stop();
  reap(true);
  if (listen_fd_ >= 0)
    close(listen_fd_);
  close(stop_fd_);
}

void IiodServer::stop() noexcept {
  const int saved = errno; // a signal handler must not change it
  const std::uint64_t one = 1;
  (void)!write(stop_fd_, &one, sizeof one);
  errno = saved;
}

void IiodServer::run() {
  pollfd fds[2] = {{stop_fd_, POLLIN, 0}, {listen_fd_, POLLIN, 0}};
  for (;;) {
    if (poll(fds, 2, -1) < 0) {
      if (errno != EINTR)
        throw system_error(errno, "server", "cannot wait for clients");
      continue; // POSIX does not say what an interrupted poll leaves in revents
    }
    if (fds[0].revents & POLLIN)
      break;
    reap(false);
    if (fds[1].revents & POLLIN)
      accept_client();
  }
  close(listen_fd_); // new clients are refused from now on
  listen_fd_ = -1;
  reap(true);
}

/// What ran out comes back when a client goes. Until then the waiting ones stay in the queue, and a
/// loop that asked again at once would only be busy.
void IiodServer::pause() {
  pollfd stop{stop_fd_, POLLIN, 0};
  (void)!poll(&stop, 1, kPauseMs);
}

void IiodServer::accept_client() {
  Descriptor fd(accept4(listen_fd_, nullptr, nullptr, SOCK_CLOEXEC));
  if (fd.get() < 0) {
    if (errno != EINTR && errno != ECONNABORTED && errno != EAGAIN)
      pause();
    return;
  }
  if (clients_.size() >= kMostClients)
    return;
  const int yes = 1;
  setsockopt(fd.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  setsockopt(fd.get(), SOL_SOCKET, SO_SNDTIMEO, &kSendTimeout, sizeof kSendTimeout);
  Client &client = clients_.emplace_back();
  try {
    client.thread = std::thread([this, raw = fd.get(), &client] {
      const Descriptor connection(raw);
      try {
        serve_iiod_connection(raw, stop_fd_, *context_, faults_);
      } catch (const std::exception &) {
        // One client's trouble (memory, say) ends its connection and nothing else.
      }
      client.done = true;
    });
  } catch (const std::system_error &) { // no thread to be had: this client is turned away
    clients_.pop_back();
    pause();
    return;
  }
  fd.release();
}

void IiodServer::reap(bool all) {
  for (auto client = clients_.begin(); client != clients_.end();) {
    if (!all && !client->done) {
      ++client;
      continue;
    }
    client->thread.join();
    client = clients_.erase(client);
  }
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/server_connection.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

namespace ada {

namespace {

constexpr std::size_t kLongestNumber = 24;
constexpr std::size_t kMostEmptyLines = 64; ///< iiod sends one after a block, if any

} // namespace

ServerConnection::ServerConnection(const std::string &host, const std::string &port,
                                   std::chrono::milliseconds timeout, const Cancellation *other)
    : timeout_(timeout), other_(other) {
  addrinfo hints{}, *found = nullptr;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICSERV;
  if (getaddrinfo(host.c_str(), port.c_str(), &hints, &found) != 0)
    throw ServerFailed{EHOSTUNREACH};
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> address(found, freeaddrinfo);
  socket_ = Descriptor(
      ::socket(address->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, IPPROTO_TCP));
  if (socket_.get() < 0)
    throw ServerFailed{errno};
  const int on = 1; // a command is short and waits for nothing
  (void)::setsockopt(socket_.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  if (::connect(socket_.get(), address->ai_addr, address->ai_addrlen) == 0)
    return;
  if (errno != EINPROGRESS)
    throw ServerFailed{errno};
  wait(POLLOUT, soon());
  int error = 0;
  socklen_t size = sizeof error;
  if (::getsockopt(socket_.get(), SOL_SOCKET, SO_ERROR, &error, &size) != 0 || error != 0)
    throw ServerFailed{error ? error : errno};
}

void ServerConnection::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n > 0)
      bytes.remove_prefix(static_cast<std::size_t>(n));
    else if (errno == EAGAIN)
      wait(POLLOUT, soon());
    else if (errno != EINTR)
      throw ServerFailed{errno};
  }
}

void ServerConnection::receive(std::byte *out, std::size_t count, Clock::time_point deadline) {
  const std::size_t held = std::min(count, end_ - begin_);
  std::memcpy(out, held_.data() + begin_, held);
  begin_ += held;
  for (std::size_t have = held; have < count;)
    have += receive_some(out + have, count - have, std::min(soon(), deadline));
}

long ServerConnection::number() {
  const Clock::time_point deadline = soon();
  std::array<char, kLongestNumber> line;
  for (std::size_t n = 0, empty = 0; n < line.size() && empty <= kMostEmptyLines;) {
    const char c = next_byte(deadline);
    if (c != '\n') {
      line[n++] = c;
    } else if (n > 0 && !(n == 1 && line[0] == '\r')) {
      const char *end = line.data() + n - (line[n - 1] == '\r');
      long value = 0;
      const auto [rest, error] = std::from_chars(line.data(), end, value);
      if (error != std::errc{} || rest != end)
        break;
      return value;
    } else {
      n = 0;
      ++empty;
    }
  }
  throw ServerFailed{EBADMSG};
}

void ServerConnection::wait(short events, Clock::time_point deadline) {
  pollfd fds[3] = {{cancelled_.fd(), POLLIN, 0},
                   {other_ ? other_->fd() : -1, POLLIN, 0},
                   {socket_.get(), events, 0}};
  int ready = 0;
  do
    ready = ::poll(fds, 3, poll_timeout(deadline));
  while (ready < 0 && errno == EINTR);
  if (ready < 0 || fds[0].revents != 0 || fds[1].revents != 0)
    throw ServerFailed{ready < 0 ? errno : EBADF};
  if (ready == 0)
    throw ServerFailed{ETIMEDOUT};
}

std::size_t ServerConnection::receive_some(std::byte *out, std::size_t count,
                                           Clock::time_point deadline) {
  for (;;) {
    if (cancelled_.raised())
      throw ServerFailed{EBADF};
    const ssize_t n = ::recv(socket_.get(), out, count, 0);
    if (n > 0)
      return static_cast<std::size_t>(n);
    if (n == 0)
      throw ServerFailed{EPIPE};
    if (errno == EAGAIN)
      wait(POLLIN, deadline);
    else if (errno != EINTR)
      throw ServerFailed{errno};
  }
}

char ServerConnection::next_byte(Clock::time_point deadline) {
  if (begin_ == end_) {
    begin_ = 0;
    end_ = 0;
    end_ = receive_some(held_.data(), held_.size(), deadline);
  }
  return static_cast<char>(held_[begin_++]);
}

} // namespace ada

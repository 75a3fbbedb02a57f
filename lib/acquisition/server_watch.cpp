// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/server_watch.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>

namespace ada {

namespace {

/// Port of the other end; 0 where there is none.
int peer_port(int fd) {
  sockaddr_storage peer{};
  socklen_t size = sizeof peer;
  if (::getpeername(fd, reinterpret_cast<sockaddr *>(&peer), &size) != 0)
    return 0;
  if (peer.ss_family == AF_INET)
    return ntohs(reinterpret_cast<const sockaddr_in &>(peer).sin_port);
  if (peer.ss_family == AF_INET6)
    return ntohs(reinterpret_cast<const sockaddr_in6 &>(peer).sin6_port);
  return 0;
}

/// Inode of the socket that a descriptor of this process stands for; nothing: it stands for none. By
/// its name in /proc: other threads open and close theirs meanwhile, and to the thread sanitizer an
/// fstat of one that is being closed is a race.
std::optional<ino_t> socket_of(int fd) {
  struct stat info {};
  const std::string name = "/proc/self/fd/" + std::to_string(fd);
  if (::stat(name.c_str(), &info) != 0 || !S_ISSOCK(info.st_mode))
    return std::nullopt;
  return info.st_ino;
}

bool is_still(const OpenSocket &socket) {
  return socket_of(socket.fd) == socket.inode;
}

void shut_down(const std::vector<OpenSocket> &sockets) {
  for (const OpenSocket &socket : sockets)
    if (is_still(socket))
      ::shutdown(socket.fd, SHUT_RDWR);
}

} // namespace

std::vector<OpenSocket> sockets_to(const std::string &port) {
  std::vector<OpenSocket> out;
  if (port.empty())
    return out;
  std::error_code error;
  for (std::filesystem::directory_iterator it("/proc/self/fd", error), end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename();
    int fd = -1;
    if (std::from_chars(name.data(), name.data() + name.size(), fd).ec != std::errc{})
      continue;
    if (const auto inode = socket_of(fd); inode && std::to_string(peer_port(fd)) == port)
      out.push_back({fd, *inode});
  }
  return out;
}

ServerWatch::ServerWatch(std::string port, std::vector<OpenSocket> sockets, Which which,
                         std::chrono::milliseconds limit, const Cancellation *cancellation)
    : port_(std::move(port)), sockets_(std::move(sockets)), which_(which),
      deadline_(std::chrono::steady_clock::now() + limit), cancellation_(cancellation) {
  if (!port_.empty() && (which_ == Which::all_but || !sockets_.empty()))
    thread_ = std::thread([this] { run(); });
}

ServerWatch::~ServerWatch() {
  done_.ring();
  if (thread_.joinable())
    thread_.join();
}

void ServerWatch::run() {
  pollfd fds[2] = {{done_.fd(), POLLIN, 0}, {cancellation_ ? cancellation_->fd() : -1, POLLIN, 0}};
  while (::poll(fds, 2, poll_timeout(deadline_)) < 0 && errno == EINTR) {
  }
  if (fds[0].revents != 0)
    return;
  over_ = true;
  std::vector<OpenSocket> watched = sockets_;
  if (which_ == Which::all_but) {
    watched = sockets_to(port_);
    std::erase_if(watched, [this](const OpenSocket &s) {
      return std::find(sockets_.begin(), sockets_.end(), s) != sockets_.end();
    });
  }
  shut_down(watched);
}

DialogueWatch::DialogueWatch(std::string port, std::vector<OpenSocket> sockets,
                             std::chrono::milliseconds limit)
    : limit_(limit) {
  if (!port.empty())
    sockets_ = std::move(sockets);
}

DialogueWatch::~DialogueWatch() {
  {
    const std::lock_guard lock(mutex_);
    done_ = true;
  }
  wake_.ring();
  if (thread_.joinable())
    thread_.join();
}

void DialogueWatch::set_deadline(bool begins) {
  if (sockets_.empty())
    return;
  if (!thread_.joinable())
    thread_ = std::thread([this] { run(); });
  const std::lock_guard lock(mutex_);
  deadline_ = begins ? std::chrono::steady_clock::now() + limit_ : Time::max();
  // That of a dialogue before is always earlier: then the thread looks in time of its own accord.
  if (deadline_ < looks_again_)
    wake_.ring();
}

void DialogueWatch::run() {
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      if (done_)
        return;
      if (deadline_ <= std::chrono::steady_clock::now()) {
        shut_down(sockets_);
        deadline_ = Time::max();
      }
      looks_again_ = deadline_;
    }
    wake_.wait(looks_again_);
  }
}

} // namespace ada

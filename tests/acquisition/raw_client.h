// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A client that says to the server of IIO devices what it is told to, without libiio.
#pragma once

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "base/descriptor.h"

namespace ada::test {

inline Descriptor connect_to(int port) {
  Descriptor fd(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(fd.get(), reinterpret_cast<sockaddr *>(&address), sizeof address) != 0)
    throw std::runtime_error(std::strerror(errno));
  return fd;
}

inline void say(const Descriptor &fd, const std::string &bytes) {
  (void)!send(fd.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

inline std::string answer_line(const Descriptor &fd) {
  std::string line;
  char c = 0;
  while (recv(fd.get(), &c, 1, 0) == 1 && c != '\n')
    line += c;
  return line;
}

} // namespace ada::test

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/print.h"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <string>

#include <fcntl.h>
#include <unistd.h>

#include "common/handles.h"

namespace cli {

namespace {

int remarks_fd = STDERR_FILENO;

[[noreturn]] void fail(int reason) {
  throw Failure(kUnusable, std::string("standard output: cannot write: ") + std::strerror(reason));
}

/// False with errno when not all of it could be written.
bool write_all(int fd, std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t written = ::write(fd, text.data(), text.size());
    if (written < 0 && errno == EINTR)
      continue;
    if (written < 0)
      return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

} // namespace

void open_standard_descriptors() {
  // open() takes the lowest number that is free.
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd)
    if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", O_RDWR) != fd)
      throw Failure(kUnusable,
                    "cannot open /dev/null in the place of a closed standard descriptor");
  std::signal(SIGXFSZ, SIG_IGN); // a file that may not grow is a failed write, with its sentence
  std::signal(SIGPIPE, SIG_IGN); // so is a pipe that nobody reads any more
#ifdef __GLIBC__
  // libiio and libxml2 print to it what a server sent, as it came. What is to be said of it is said
  // by remark(), which writes to the descriptor; so does the runtime when it ends the program.
  if (FILE *const nowhere = std::fopen("/dev/null", "we"))
    stderr = nowhere;
#endif
}

void put(std::string_view text) {
  if (!write_all(STDOUT_FILENO, text))
    fail(errno);
}

void flush_output() {
  // CLI11's help is in here. A stream that failed has forgotten why; one more write says it.
  std::cout.flush();
  const bool sound = std::cout.good() && std::fflush(stdout) == 0;
  if (!sound) {
    put("\n");
    fail(EIO);
  }
}

std::string plain(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    auto byte = static_cast<unsigned char>(text[i]);
    const bool eight_bits = byte == 0xc2 && i + 1 < text.size() &&
                            (static_cast<unsigned char>(text[i + 1]) & 0xe0) == 0x80; // U+0080 on
    if (eight_bits)
      byte = static_cast<unsigned char>(text[++i]);
    if (byte == '\n')
      out += "\\n";
    else if (byte < 0x20 || byte == 0x7f || eight_bits)
      out += fmt::format("\\x{:02x}", byte);
    else
      out += static_cast<char>(byte);
  }
  return out;
}

void remark_to(int fd) noexcept {
  remarks_fd = fd;
}

void remark(std::string_view text) noexcept {
  if (remarks_fd >= 0) [[maybe_unused]]
    const bool said = write_all(remarks_fd, text);
}

} // namespace cli

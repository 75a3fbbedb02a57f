// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/descriptor.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/uio.h>
#include <unistd.h>

namespace ada {

namespace {

constexpr int kMostLinks = 40; ///< as the kernel

ada4571_status status_of(int errno_value) {
  switch (errno_value) {
  case ENOENT:
  case ENODEV:
    return ADA4571_ERROR_NOT_FOUND;
  case EACCES:
  case EPERM:
  case EROFS:
    return ADA4571_ERROR_PERMISSION;
  case EBUSY:
    return ADA4571_ERROR_BUSY;
  case ENOMEM:
    return ADA4571_ERROR_NO_MEMORY;
  default:
    return ADA4571_ERROR_IO;
  }
}

FileId id_of(const struct stat &info) {
  return S_ISREG(info.st_mode) ? FileId{info.st_dev, info.st_ino} : FileId();
}

} // namespace

Error system_error(int errno_value, const std::string &place, std::string_view action) {
  return Error(status_of(errno_value), place + ": " + std::string(action) + ": " +
                                           std::generic_category().message(errno_value));
}

Descriptor &Descriptor::operator=(Descriptor &&other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

Descriptor::~Descriptor() {
  if (fd_ > STDERR_FILENO)
    ::close(fd_);
}

int Descriptor::release() noexcept {
  return std::exchange(fd_, -1);
}

void write_all(int fd, std::string_view bytes, const std::string &shown) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR)
      continue;
    if (written < 0)
      throw system_error(errno, shown, "cannot write");
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void write_all(int fd, std::span<const std::string_view> pieces, const std::string &shown) {
  std::array<iovec, 16> at; // POSIX knows of no system that takes fewer
  while (!pieces.empty()) {
    const std::size_t some = std::min(pieces.size(), at.size());
    for (std::size_t k = 0; k < some; ++k) // writev reads only
      at[k] = {const_cast<char *>(pieces[k].data()), pieces[k].size()};
    ssize_t written = 0;
    do
      written = ::writev(fd, at.data(), static_cast<int>(some));
    while (written < 0 && errno == EINTR);
    if (written < 0)
      throw system_error(errno, shown, "cannot write");
    auto left = static_cast<std::size_t>(written);
    while (!pieces.empty() && left >= pieces.front().size()) {
      left -= pieces.front().size();
      pieces = pieces.subspan(1);
    }
    if (left > 0) { // a write that was cut short ended within this piece
      write_all(fd, pieces.front().substr(left), shown);
      pieces = pieces.subspan(1);
    }
  }
}

std::string folder_of(const std::string &path) {
  const auto slash = path.rfind('/');
  if (slash == std::string::npos)
    return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

void sync_folder(const std::string &folder) {
  const Descriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() >= 0)
    ::fsync(fd.get());
}

std::string follow_links(const std::string &path) {
  std::string at = path;
  for (int i = 0; i < kMostLinks; ++i) {
    std::array<char, PATH_MAX> target;
    const ssize_t length = ::readlink(at.c_str(), target.data(), target.size());
    if (length < 0)
      return at; // no link, or not there
    const std::string_view next(target.data(), static_cast<std::size_t>(length));
    if (next.starts_with('/'))
      at = next;
    else
      at = at.substr(0, at.rfind('/') + 1) + std::string(next);
  }
  throw system_error(ELOOP, path, "cannot follow the links");
}

FileId file_id(int fd) noexcept {
  struct stat info {};
  return ::fstat(fd, &info) == 0 ? id_of(info) : FileId();
}

FileId file_id(const std::string &path) noexcept {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 ? id_of(info) : FileId();
}

} // namespace ada

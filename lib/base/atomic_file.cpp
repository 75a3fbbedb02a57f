// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/atomic_file.h"

#include <cerrno>
#include <climits>
#include <cstdlib>
#include <memory>
#include <random>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace ada {

namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 16;

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

std::string folder_of(const std::string &path) {
  const auto slash = path.rfind('/');
  if (slash == std::string::npos)
    return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

/// A link is followed to what it names, so that the rename replaces that and not the link.
std::string resolve(const std::string &path) {
  const std::unique_ptr<char, void (*)(void *)> real(::realpath(path.c_str(), nullptr), std::free);
  return real ? std::string(real.get()) : path;
}

/// A rename is on the disk only when the folder is. Some file systems refuse to sync a folder;
/// the file itself is whole all the same, so that is no failure.
void sync_folder(const std::string &folder) {
  const Descriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() >= 0)
    ::fsync(fd.get());
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

AtomicFile::AtomicFile(const std::string &path) : shown_(path), target_(path) {
  buffer_.reserve(kBufferBytes);
  if (path == "-") {
    shown_ = "standard output";
    fd_ = Descriptor(STDOUT_FILENO);
    return;
  }
  struct stat existing {};
  if (::stat(path.c_str(), &existing) != 0) {
    open_temporary(); // a missing folder or a missing permission is reported from there
    return;
  }
  if (S_ISDIR(existing.st_mode))
    throw system_error(EISDIR, shown_, "cannot write");
  if (!S_ISREG(existing.st_mode)) {
    fd_ = Descriptor(::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
    if (fd_.get() < 0)
      throw system_error(errno, shown_, "cannot write");
    return;
  }
  target_ = resolve(path);
  open_temporary();
  // The new file keeps the permissions of the one that it replaces.
  if (::fchmod(fd_.get(), existing.st_mode & 07777) != 0) {
    const int reason = errno;
    ::unlink(temporary_.c_str());
    throw system_error(reason, shown_, "cannot set permissions");
  }
}

AtomicFile::~AtomicFile() {
  if (!temporary_.empty())
    ::unlink(temporary_.c_str());
}

void AtomicFile::open_temporary() {
  std::random_device entropy;
  for (int attempt = 0; attempt < 16; ++attempt) {
    // open() rather than mkstemp(): the permissions follow the umask, as for any new file.
    std::string name = target_ + "." + std::to_string(entropy()) + ".tmp";
    fd_ = Descriptor(::open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (fd_.get() >= 0) {
      temporary_ = std::move(name);
      return;
    }
    if (errno != EEXIST)
      break;
  }
  throw system_error(errno, shown_, "cannot create");
}

void AtomicFile::write(const void *bytes, std::size_t count) {
  const char *from = static_cast<const char *>(bytes);
  synced_ = false;
  if (buffer_.size() + count > kBufferBytes)
    flush();
  if (count >= kBufferBytes)
    write_through(from, count);
  else
    buffer_.insert(buffer_.end(), from, from + count);
}

void AtomicFile::write_through(const char *bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t written = ::write(fd_.get(), bytes, count);
    if (written < 0 && errno == EINTR)
      continue;
    if (written < 0)
      throw system_error(errno, shown_, "cannot write");
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
}

void AtomicFile::flush() {
  write_through(buffer_.data(), buffer_.size());
  buffer_.clear();
}

void AtomicFile::sync() {
  flush();
  if (!temporary_.empty() && ::fsync(fd_.get()) != 0)
    throw system_error(errno, shown_, "cannot write to the disk");
  synced_ = true;
}

void AtomicFile::commit() {
  if (!synced_)
    sync();
  if (temporary_.empty())
    return;
  if (::rename(temporary_.c_str(), target_.c_str()) != 0)
    throw system_error(errno, shown_, "cannot put in place");
  temporary_.clear();
  sync_folder(folder_of(target_));
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/output_file.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/handles.h"

namespace cli {

namespace {

/// Where a symbolic link leads to, so that the rename replaces the file and not the link.
std::string resolved(const std::string &path) {
  const std::unique_ptr<char, decltype(&std::free)> real(realpath(path.c_str(), nullptr),
                                                         &std::free);
  return real ? std::string(real.get()) : path;
}

mode_t default_mode() {
  const mode_t mask = umask(0);
  umask(mask);
  return 0666 & ~mask;
}

} // namespace

OutputFile::OutputFile(const std::string &path) : path_(resolved(path)) {
  if (path == "-") {
    path_ = "standard output";
    fd_ = STDOUT_FILENO;
    return;
  }
  struct stat existing = {};
  if (stat(path_.c_str(), &existing) == 0 && !S_ISREG(existing.st_mode)) {
    fd_ = open(path_.c_str(), O_WRONLY | O_CLOEXEC);
  } else {
    temporary_ = path_ + ".XXXXXX";
    fd_ = mkostemp(temporary_.data(), O_CLOEXEC);
    if (fd_ < 0)
      temporary_.clear();
    else
      fchmod(fd_, default_mode());
  }
  if (fd_ < 0)
    fail("cannot create");
}

OutputFile::~OutputFile() {
  if (fd_ > STDOUT_FILENO)
    close(fd_);
  if (!temporary_.empty())
    unlink(temporary_.c_str());
}

void OutputFile::write(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(fd_, text.data(), text.size());
    if (written < 0 && errno == EINTR)
      continue;
    if (written < 0)
      fail("cannot write");
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void OutputFile::commit() {
  if (temporary_.empty())
    return;
  if (fsync(fd_) != 0)
    fail("cannot write");
  if (rename(temporary_.c_str(), path_.c_str()) != 0)
    fail("cannot create");
  temporary_.clear();
}

void OutputFile::fail(const char *what) const {
  throw Failure(kUnusable, path_ + ": " + what + ": " + std::strerror(errno));
}

} // namespace cli

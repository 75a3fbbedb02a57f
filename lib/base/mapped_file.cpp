// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/mapped_file.h"

#include <cerrno>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

namespace ada {

MappedFile::MappedFile(const std::string &path) {
  // Without O_NONBLOCK the open of a pipe would wait for a writer.
  const Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK));
  if (fd.get() < 0)
    throw system_error(errno, path, "cannot open");
  map(fd.get(), path);
}

MappedFile::MappedFile(int fd, const std::string &shown) {
  map(fd, shown);
}

void MappedFile::map(int fd, const std::string &shown) {
  struct stat info {};
  if (::fstat(fd, &info) != 0)
    throw system_error(errno, shown, "cannot open");
  if (!S_ISREG(info.st_mode))
    throw Error(ADA4571_ERROR_FORMAT, shown + ": this is no regular file");
  const auto size = static_cast<std::size_t>(info.st_size);
  if (size == 0)
    return;
  shown_ = shown;
  fd_ = Descriptor(::fcntl(fd, F_DUPFD_CLOEXEC, 0));
  if (fd_.get() < 0)
    throw system_error(errno, shown, "cannot open");
  void *start = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd, 0);
  if (start == MAP_FAILED)
    throw system_error(errno, shown, "cannot map into memory");
  ::madvise(start, size, MADV_SEQUENTIAL);
  bytes_ = {static_cast<const std::byte *>(start), size};
}

void MappedFile::check_holds(std::size_t bytes) const {
  struct stat info {};
  if (bytes > 0 &&
      (::fstat(fd_.get(), &info) != 0 || static_cast<std::size_t>(info.st_size) < bytes))
    throw Error(ADA4571_ERROR_FORMAT, shown_ + ": the file was cut short while it was read");
}

MappedFile::~MappedFile() {
  if (!bytes_.empty())
    ::munmap(const_cast<std::byte *>(bytes_.data()), bytes_.size());
}

} // namespace ada

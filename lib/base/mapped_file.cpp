// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/mapped_file.h"

#include <cerrno>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "base/atomic_file.h"

namespace ada {

MappedFile::MappedFile(const std::string &path) {
  // Without O_NONBLOCK the open of a pipe would wait for a writer.
  const Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK));
  if (fd.get() < 0)
    throw system_error(errno, path, "cannot open");
  struct stat info {};
  if (::fstat(fd.get(), &info) != 0)
    throw system_error(errno, path, "cannot open");
  if (!S_ISREG(info.st_mode))
    throw Error(ADA4571_ERROR_FORMAT, path + ": this is no regular file");
  const auto size = static_cast<std::size_t>(info.st_size);
  if (size == 0)
    return;
  void *start = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd.get(), 0);
  if (start == MAP_FAILED)
    throw system_error(errno, path, "cannot map into memory");
  ::madvise(start, size, MADV_SEQUENTIAL);
  bytes_ = {static_cast<const std::byte *>(start), size};
}

MappedFile::~MappedFile() {
  if (!bytes_.empty())
    ::munmap(const_cast<std::byte *>(bytes_.data()), bytes_.size());
}

} // namespace ada

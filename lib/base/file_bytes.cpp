// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/file_bytes.h"

#include <cerrno>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace ada {

FileBytes::FileBytes(const std::string &path) : shown_(path) {
  // Without O_NONBLOCK the open of a pipe would wait for a writer.
  const Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK));
  if (fd.get() < 0)
    throw system_error(errno, path, "cannot open");
  open(fd.get());
}

FileBytes::FileBytes(int fd, const std::string &shown) : shown_(shown) {
  open(fd);
}

void FileBytes::open(int fd) {
  struct stat info {};
  if (::fstat(fd, &info) != 0)
    throw system_error(errno, shown_, "cannot open");
  if (!S_ISREG(info.st_mode))
    throw Error(ADA4571_ERROR_FORMAT, shown_ + ": this is no regular file");
  size_ = static_cast<std::size_t>(info.st_size);
  fd_ = Descriptor(::fcntl(fd, F_DUPFD_CLOEXEC, 0));
  if (fd_.get() < 0)
    throw system_error(errno, shown_, "cannot open");
  ::posix_fadvise(fd_.get(), 0, 0, POSIX_FADV_SEQUENTIAL);
}

BytesRead FileBytes::read(std::size_t first, std::size_t count) const {
  if (!is_file())
    return BytesRead(memory_.subspan(first, count));
  auto bytes = std::make_unique_for_overwrite<std::byte[]>(count);
  for (std::size_t done = 0; done < count;) {
    const ssize_t got = ::pread(fd_.get(), bytes.get() + done, count - done,
                                static_cast<off_t>(first + done));
    if (got == 0)
      throw Error(ADA4571_ERROR_FORMAT, shown_ + ": the file was cut short while it was read");
    if (got < 0 && errno != EINTR)
      throw system_error(errno, shown_, "cannot read");
    done += got > 0 ? static_cast<std::size_t>(got) : 0;
  }
  return {std::move(bytes), count};
}

} // namespace ada

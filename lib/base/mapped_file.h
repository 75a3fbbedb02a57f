// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "base/descriptor.h"

namespace ada {

/// A regular file mapped into memory for reading from front to back. When another program cuts it
/// short, the system ends a process that reads past the end (SIGBUS): what is read over a longer
/// time is checked before each part of it.
class MappedFile {
public:
  explicit MappedFile(const std::string &path);
  /// What an open file holds now; `shown` is for messages.
  MappedFile(int fd, const std::string &shown);
  MappedFile(const MappedFile &) = delete;
  MappedFile &operator=(const MappedFile &) = delete;
  ~MappedFile();

  std::span<const std::byte> bytes() const { return bytes_; }
  /// Throws Error(ADA4571_ERROR_FORMAT) where the file is shorter now than so many bytes.
  void check_holds(std::size_t bytes) const;

private:
  void map(int fd, const std::string &shown);

  std::span<const std::byte> bytes_;
  std::string shown_;
  Descriptor fd_; ///< another one of the same file
};

} // namespace ada

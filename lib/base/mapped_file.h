// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace ada {

/// A regular file mapped into memory for reading from front to back. The file must not be cut
/// short by another program meanwhile: the system ends a process that reads past the end.
class MappedFile {
public:
  explicit MappedFile(const std::string &path);
  /// What an open file holds now; `shown` is for messages.
  MappedFile(int fd, const std::string &shown);
  MappedFile(const MappedFile &) = delete;
  MappedFile &operator=(const MappedFile &) = delete;
  ~MappedFile();

  std::span<const std::byte> bytes() const { return bytes_; }

private:
  void map(int fd, const std::string &shown);

  std::span<const std::byte> bytes_;
};

} // namespace ada

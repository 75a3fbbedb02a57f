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
  MappedFile(const MappedFile &) = delete;
  MappedFile &operator=(const MappedFile &) = delete;
  ~MappedFile();

  std::span<const std::byte> bytes() const { return bytes_; }

private:
  std::span<const std::byte> bytes_;
};

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "base/descriptor.h"

namespace ada {

/// Some bytes, which are good as long as this and what it was read from.
class BytesRead {
public:
  explicit BytesRead(std::span<const std::byte> elsewhere) : bytes_(elsewhere) {}
  BytesRead(std::unique_ptr<std::byte[]> own, std::size_t count)
      : own_(std::move(own)), bytes_(own_.get(), count) {}
  operator std::span<const std::byte>() const { return bytes_; }

private:
  std::unique_ptr<std::byte[]> own_;
  std::span<const std::byte> bytes_;
};

/// The bytes of a regular file, or of memory, part by part; by several threads at once. A file is
/// read and not mapped into memory: where another program cuts it short, or the disk fails, the
/// reading of a mapping would end the process (SIGBUS), and a library can guard no process against
/// that.
class FileBytes {
public:
  explicit FileBytes(const std::string &path);
  /// What an open file holds now; `shown` is for messages.
  FileBytes(int fd, const std::string &shown);
  FileBytes(std::span<const std::byte> memory, const std::string &shown)
      : shown_(shown), memory_(memory), size_(memory.size()) {}

  bool is_file() const { return fd_.get() >= 0; }
  /// When it was opened.
  std::size_t size() const { return size_; }
  /// [first, first + count). Throws Error(ADA4571_ERROR_FORMAT) where the file is shorter now.
  BytesRead read(std::size_t first, std::size_t count) const;
  BytesRead all() const { return read(0, size_); }

private:
  void open(int fd);

  std::string shown_;
  Descriptor fd_; ///< another one of the same file; none of memory
  std::span<const std::byte> memory_;
  std::size_t size_ = 0;
};

} // namespace ada

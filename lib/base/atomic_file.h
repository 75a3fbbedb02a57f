// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Files that are written whole or not at all: a temporary file beside the target, fsync, rename.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace ada {

/// The failure `errno_value` of the system as an Error: "capture.csv: cannot open: No such file or
/// directory", with the status that fits (not found, permission, busy, memory, else I/O).
Error system_error(int errno_value, const std::string &place, std::string_view action);

/// An open file descriptor, closed by the destructor unless it is standard input or output.
class Descriptor {
public:
  explicit Descriptor(int fd = -1) noexcept : fd_(fd) {}
  Descriptor(const Descriptor &) = delete;
  Descriptor &operator=(const Descriptor &) = delete;
  Descriptor(Descriptor &&other) noexcept : fd_(other.release()) {}
  Descriptor &operator=(Descriptor &&other) noexcept;
  ~Descriptor();
  int get() const noexcept { return fd_; }
  int release() noexcept;

private:
  int fd_;
};

/// Buffered output. The target appears, or changes, only with commit(); a destructor without it
/// removes the temporary file. "-" is standard output, and a target that exists and is no regular
/// file (a pipe, a device) is written in place: those cannot be replaced by a rename.
class AtomicFile {
public:
  explicit AtomicFile(const std::string &path);
  AtomicFile(const AtomicFile &) = delete;
  AtomicFile &operator=(const AtomicFile &) = delete;
  ~AtomicFile();

  void write(std::string_view bytes) { write(bytes.data(), bytes.size()); }
  void write(const void *bytes, std::size_t count);
  /// Hands the buffered bytes to the system.
  void flush();
  /// flush and fsync; commit() does it too. For a group of files: sync all, then commit all.
  void sync();
  void commit();

  /// Where the bytes are until commit(): the temporary file, or the target written in place.
  const std::string &working_path() const { return temporary_.empty() ? target_ : temporary_; }
  /// Whether the target is a pipe, a device or standard output, which is written as it stands.
  bool in_place() const { return temporary_.empty(); }

private:
  void open_temporary();
  void write_through(const char *bytes, std::size_t count);

  std::string shown_;     ///< the path as the caller gave it, for messages
  std::string target_;    ///< with links resolved, so that a link stays a link
  std::string temporary_; ///< empty when written in place
  Descriptor fd_;
  std::vector<char> buffer_;
  bool synced_ = false;
};

} // namespace ada

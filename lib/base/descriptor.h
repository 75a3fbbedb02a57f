// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// An open file descriptor, and which file it is, whatever its name.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include <sys/stat.h>

#include "base/error.h"

namespace ada {

/// The failure `errno_value` of the system as an Error: "capture.csv: cannot open: No such file or
/// directory", with the status that fits (not found, permission, busy, memory, else I/O).
Error system_error(int errno_value, const std::string &place, std::string_view action);

/// Closed by the destructor unless it is standard input, output or error.
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

/// Writes all of it; throws system_error(..., shown, "cannot write").
void write_all(int fd, std::string_view bytes, const std::string &shown);
/// The same of pieces, one after the other, as few calls as may be.
void write_all(int fd, std::span<const std::string_view> pieces, const std::string &shown);

/// The folder of a path: "." where it names none.
std::string folder_of(const std::string &path);

/// A rename is on the disk only when the folder is. Some file systems refuse to sync a folder;
/// the file itself is whole all the same, so that is no failure.
void sync_folder(const std::string &folder);

/// What a path stands for: links are followed, the last one also to a file that is not there yet.
/// Throws Error for a circle of links.
std::string follow_links(const std::string &path);

/// A regular file, by what no other name can hide; nothing else has an identity here.
struct FileId {
  dev_t device = 0;
  ino_t inode = 0;
  bool operator==(const FileId &) const = default;
  explicit operator bool() const noexcept { return inode != 0; }
};

FileId file_id(int fd) noexcept;
FileId file_id(const std::string &path) noexcept;

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Files that are written whole or not at all. Until it is complete a file has no name where the
// file system knows such files (O_TMPFILE), so that nothing remains of a program that is killed;
// elsewhere it is a temporary file beside the target, NAME.NUMBER.tmp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/descriptor.h"

namespace ada {

/// Buffered output. The target appears, or changes, only with commit(); a destructor without it
/// leaves nothing. "-" is standard output, and a target that exists and is no regular file (a pipe,
/// a device) is written in place: those cannot be replaced. A file that is replaced hands on its
/// permissions and, as far as this user may, its owner; a link is followed, wherever it leads.
class AtomicFile {
public:
  explicit AtomicFile(const std::string &path);
  AtomicFile(const AtomicFile &) = delete;
  AtomicFile &operator=(const AtomicFile &) = delete;
  ~AtomicFile();

  void write(std::string_view bytes) { write(bytes.data(), bytes.size()); }
  void write(const void *bytes, std::size_t count);
  /// Pieces that follow each other, in one call of the system.
  void write(std::span<const std::string_view> pieces);
  /// How many bytes will come: the file system gives room for all of them at once, which costs it
  /// less than block by block. Throws where there is not so much room; a file system that cannot
  /// say is no error.
  void expect(std::uint64_t bytes);
  /// Hands the buffered bytes to the system.
  void flush();
  /// flush and fsync; commit() does it too. For a group of files: sync all, then commit all.
  void sync();
  void commit();
  /// commit(), unless another file has got the name since this one began, or another one than stood
  /// there: then under a free name beside it, which is returned. Empty: under its own.
  std::string commit_or_beside();
  /// commit() under another name in the target's folder; nothing of that name may be there.
  void commit_as(const std::string &path);

  /// The bytes until commit(), readable; standard output and what is written in place are not.
  int fd() const { return fd_.get(); }
  /// Where the bytes will be, links followed.
  const std::string &target() const { return target_; }
  /// Whether the target is a pipe, a device or standard output, which is written as it stands.
  bool in_place() const { return in_place_; }

private:
  void open_unseen();
  bool open_nameless(const std::string &folder);
  void keep_owner_and_mode(const struct stat &existing);
  bool link_to(const std::string &name) const;
  std::string free_name() const;
  void give_name(const std::string &name, bool replace);
  void discard() noexcept;

  std::string shown_;     ///< the path as the caller gave it, for messages
  std::string target_;    ///< with links resolved, so that a link stays a link
  std::string temporary_; ///< empty while the file has no name
  FileId before_;         ///< what stood at the target when this began
  Descriptor fd_;
  std::vector<char> buffer_;
  bool in_place_ = false;
  bool synced_ = false;
};

} // namespace ada

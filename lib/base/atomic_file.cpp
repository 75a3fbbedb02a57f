// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/atomic_file.h"

#include <cerrno>
#include <cstdio>
#include <random>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace ada {

namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 16;
constexpr int kNames = 16; ///< tries for a name that nobody has

/// Where /proc shows an open file, which is how a nameless one gets its name.
std::string proc_path(int fd) {
  return "/proc/self/fd/" + std::to_string(fd);
}

} // namespace

AtomicFile::AtomicFile(const std::string &path) : shown_(path), target_(path) {
  buffer_.reserve(kBufferBytes);
  if (path == "-") {
    shown_ = "standard output";
    in_place_ = true;
    fd_ = Descriptor(STDOUT_FILENO);
    return;
  }
  struct stat existing {};
  if (::stat(path.c_str(), &existing) != 0) {
    target_ = follow_links(path);
    open_unseen(); // a missing folder or a missing permission is reported from there
    return;
  }
  if (S_ISDIR(existing.st_mode))
    throw system_error(EISDIR, shown_, "cannot write");
  if (!S_ISREG(existing.st_mode)) {
    in_place_ = true;
    fd_ = Descriptor(::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
    if (fd_.get() < 0)
      throw system_error(errno, shown_, "cannot write");
    return;
  }
  target_ = follow_links(path);
  before_ = file_id(target_);
  open_unseen();
  try {
    keep_owner_and_mode(existing);
  } catch (...) {
    discard();
    throw;
  }
}

AtomicFile::~AtomicFile() {
  discard();
}

void AtomicFile::discard() noexcept {
  if (!temporary_.empty())
    ::unlink(temporary_.c_str());
  temporary_.clear();
}

void AtomicFile::keep_owner_and_mode(const struct stat &existing) {
  // Only root may give a file away; whose it is then is no reason to refuse.
  [[maybe_unused]] const int given = ::fchown(fd_.get(), existing.st_uid, existing.st_gid);
  if (::fchmod(fd_.get(), existing.st_mode & 07777) != 0)
    throw system_error(errno, shown_, "cannot set permissions");
}

/// Permissions follow the umask, as for any new file.
bool AtomicFile::open_nameless(const std::string &folder) {
  Descriptor fd(::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666));
  if (fd.get() < 0 || ::access(proc_path(fd.get()).c_str(), F_OK) != 0)
    return false;
  fd_ = std::move(fd);
  return true;
}

std::string AtomicFile::free_name() const {
  std::random_device entropy;
  return target_ + "." + std::to_string(entropy()) + ".tmp";
}

void AtomicFile::open_unseen() {
  if (open_nameless(folder_of(target_)))
    return;
  for (int attempt = 0; attempt < kNames; ++attempt) {
    const std::string name = free_name();
    fd_ = Descriptor(::open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (fd_.get() >= 0) {
      temporary_ = name;
      return;
    }
    if (errno != EEXIST)
      break;
  }
  throw system_error(errno, shown_, "cannot create");
}

void AtomicFile::write(const void *bytes, std::size_t count) {
  const char *from = static_cast<const char *>(bytes);
  synced_ = false;
  if (buffer_.size() + count > kBufferBytes)
    flush();
  if (count >= kBufferBytes)
    write_all(fd_.get(), {from, count}, shown_);
  else
    buffer_.insert(buffer_.end(), from, from + count);
}

void AtomicFile::write(std::span<const std::string_view> pieces) {
  synced_ = false;
  flush();
  write_all(fd_.get(), pieces, shown_);
}

void AtomicFile::expect(std::uint64_t bytes) {
  if (!in_place_ && bytes > 0 &&
      ::fallocate(fd_.get(), FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes)) != 0 &&
      errno == ENOSPC)
    throw system_error(ENOSPC, shown_, "cannot write");
}

void AtomicFile::flush() {
  write_all(fd_.get(), {buffer_.data(), buffer_.size()}, shown_);
  buffer_.clear();
}

void AtomicFile::sync() {
  flush();
  if (!in_place_ && ::fsync(fd_.get()) != 0)
    throw system_error(errno, shown_, "cannot write to the disk");
  synced_ = true;
}

bool AtomicFile::link_to(const std::string &name) const {
  return ::linkat(AT_FDCWD, proc_path(fd_.get()).c_str(), AT_FDCWD, name.c_str(),
                  AT_SYMLINK_FOLLOW) == 0;
}

/// A nameless file can take a free name, but not another's: to replace one it takes a temporary
/// name for the moment until the rename.
void AtomicFile::give_name(const std::string &name, bool replace) {
  if (temporary_.empty()) {
    if (link_to(name))
      return;
    for (int attempt = 0; errno == EEXIST && replace && attempt < kNames; ++attempt) {
      const std::string between = free_name();
      if (link_to(between)) {
        temporary_ = between;
        break;
      }
    }
    if (temporary_.empty())
      throw system_error(errno, shown_, "cannot put in place");
  }
  if (::rename(temporary_.c_str(), name.c_str()) != 0)
    throw system_error(errno, shown_, "cannot put in place");
  temporary_.clear();
}

void AtomicFile::commit() {
  if (!synced_)
    sync();
  if (in_place_)
    return;
  give_name(target_, true);
  sync_folder(folder_of(target_));
}

std::string AtomicFile::commit_or_beside() {
  if (!synced_)
    sync();
  const bool replaces = static_cast<bool>(before_);
  if (in_place_ || (replaces && file_id(target_) == before_)) {
    commit();
    return {};
  }
  const std::size_t slash = target_.rfind('/') + 1; // 0 without one
  const std::size_t dot = target_.rfind('.');
  const std::size_t end = dot == target_.npos || dot <= slash ? target_.size() : dot;
  for (int i = 0; i < kNames; ++i) {
    const std::string name =
        i == 0 ? target_ : target_.substr(0, end) + "." + std::to_string(i) + target_.substr(end);
    if (file_id(name)) // which a rename would replace
      continue;
    try {
      give_name(name, false);
    } catch (const Error &) {
      if (file_id(name))
        continue; // meanwhile
      throw;
    }
    sync_folder(folder_of(target_));
    return i == 0 ? std::string() : name;
  }
  throw system_error(EEXIST, shown_, "cannot put in place");
}

void AtomicFile::commit_as(const std::string &path) {
  if (!synced_)
    sync();
  give_name(path, false);
  sync_folder(folder_of(path));
}

} // namespace ada

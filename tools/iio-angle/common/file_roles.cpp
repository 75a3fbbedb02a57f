// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/file_roles.h"

#include <filesystem>

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace cli {

namespace {

/// Either name of a SigMF recording stands for both.
std::vector<std::string> files_of(const std::string &path) {
  for (const std::string_view end : {".sigmf-meta", ".sigmf-data"})
    if (path.ends_with(end)) {
      const std::string stem = path.substr(0, path.size() - end.size());
      return {stem + ".sigmf-meta", stem + ".sigmf-data"};
    }
  return {path};
}

/// What is left of a name when the folders on the way are known: for a file that is not there yet.
std::string plain(const std::string &path) {
  std::error_code ignored;
  return std::filesystem::weakly_canonical(path, ignored).string();
}

} // namespace

bool FileRoles::Known::is(const Known &other) const {
  return inode == 0 || other.inode == 0 ? inode == other.inode && path == other.path
                                        : device == other.device && inode == other.inode;
}

void FileRoles::add(const std::string &path, bool written) {
  struct stat info {};
  const bool is_standard = path == "-";
  if (is_standard && written)
    return; // whatever it is, it is not replaced
  const int failed = is_standard ? fstat(STDIN_FILENO, &info) : stat(path.c_str(), &info);
  if (failed == 0 && !S_ISREG(info.st_mode))
    return; // a pipe, a terminal, /dev/null: written in place
  const Known file{failed == 0 ? path : plain(path), info.st_dev, failed == 0 ? info.st_ino : 0,
                   written};
  for (const Known &other : known_) {
    if (written && file.is(other))
      throw Failure(kWrongUsage,
                    fmt::format("{} is {}: give another name", path,
                                other.written ? "to be written twice"
                                              : "what is read, and would be written over"));
  }
  known_.push_back(file);
}

FileRoles &FileRoles::reads(const std::string &path) {
  if (!path.empty())
    for (const std::string &file : files_of(path))
      add(file, false);
  return *this;
}

FileRoles &FileRoles::reads(const std::string &path, const Recording &recording) {
  auto info = initialised(ada4571_recording_info_init);
  check(ada4571_recording_get_info(recording.get(), &info));
  return reads(path).reads(info.data_file);
}

FileRoles &FileRoles::reads_once(const std::string &path, const Recording &recording) {
  FileRoles own;
  own.reads(path, recording);
  for (const Known &file : own.known_)
    for (const Known &other : known_)
      if (file.is(other))
        throw Failure(kWrongUsage,
                      fmt::format("{} is given twice: the same samples prove nothing more", path));
  known_.insert(known_.end(), own.known_.begin(), own.known_.end());
  return *this;
}

FileRoles &FileRoles::writes(const std::string &path) {
  if (!path.empty())
    for (const std::string &file : files_of(path))
      add(file, true);
  return *this;
}

} // namespace cli

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/file_roles.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/print.h"

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

/// What is left of a name when the folders on the way are known, and links that lead to what is not
/// there yet: for a file that is not there yet.
std::string real_path(const std::string &path) {
  namespace fs = std::filesystem;
  constexpr int kMostLinks = 40; // as the kernel
  std::error_code error;
  fs::path at = fs::absolute(path, error);
  for (int i = 0; i < kMostLinks; ++i) {
    at = fs::weakly_canonical(at.parent_path(), error) / at.filename();
    const fs::path next = fs::read_symlink(at, error);
    if (error)
      break;
    at = at.parent_path() / next; // an absolute one stands for itself
  }
  return at.lexically_normal().string();
}

/// Whether a file can come to be there, with the words that the library would have for it after an
/// hour's work: results appear under a new name in the folder, then take the place of what was
/// there.
void require_room_for(const std::string &path) {
  std::error_code error;
  if (std::filesystem::is_symlink(path, error) && !std::filesystem::exists(path, error))
    return; // leads to what is not there yet: the library knows where
  const std::string folder = std::filesystem::path(real_path(path)).parent_path().string();
  // A folder and a slash: what is no folder is refused, too. As whom it will be opened, not as whom
  // the program was started by.
  if (faccessat(AT_FDCWD, (folder + "/").c_str(), W_OK | X_OK, AT_EACCESS) != 0)
    throw Failure(kUnusable, fmt::format("{}: cannot create: {}", path, std::strerror(errno)));
}

/// What stat() says of a file, of standard input for "-"; false where there is none.
bool look_at(const std::string &path, struct stat &info) {
  return (path == "-" ? fstat(STDIN_FILENO, &info) : stat(path.c_str(), &info)) == 0;
}

/// Whether what is written to a descriptor goes into this file.
bool writes_into(int fd, const struct stat &file) {
  struct stat open {};
  return S_ISREG(file.st_mode) && fstat(fd, &open) == 0 && open.st_dev == file.st_dev &&
         open.st_ino == file.st_ino && (fcntl(fd, F_GETFL) & O_ACCMODE) != O_RDONLY;
}

} // namespace

void refuse_redirection_into(const std::string &path) {
  for (const std::string &name : files_of(path)) {
    struct stat info {};
    if (!look_at(name, info))
      continue;
    const bool out = writes_into(STDOUT_FILENO, info), err = writes_into(STDERR_FILENO, info);
    if (err) // this sentence may not go there either
      remark_to(out ? -1 : STDOUT_FILENO);
    if (out || err)
      throw Failure(kWrongUsage, fmt::format("{} is an input, and {} is redirected into it: give "
                                             "the output another name",
                                             name, out ? "standard output" : "standard error"));
  }
}

void keep_remarks_out_of(const std::vector<std::string> &words) {
  for (const std::string &word : words)
    for (const std::string &name : files_of(word.substr(word.find('=') + 1)))
      if (struct stat info{}; look_at(name, info) && writes_into(STDERR_FILENO, info))
        remark_to(writes_into(STDOUT_FILENO, info) ? -1 : STDOUT_FILENO);
}

Recording open_capture(const std::string &path) {
  refuse_redirection_into(path);
  auto recording = make<Recording>(ada4571_recording_open, path.c_str());
  auto info = initialised(ada4571_recording_info_init);
  check(ada4571_recording_get_info(recording.get(), &info));
  if (const std::string data = info.data_file; !data.empty()) // as a meta file may name it
    refuse_redirection_into(data);
  return recording;
}

Model load_model(const std::string &path) {
  refuse_redirection_into(path);
  return make<Model>(ada4571_model_load, path.c_str());
}

bool FileRoles::Known::is(const Known &other) const {
  return inode == 0 || other.inode == 0 ? inode == other.inode && path == other.path
                                        : device == other.device && inode == other.inode;
}

void FileRoles::add(const std::string &path, bool written) {
  struct stat info {};
  const bool is_standard = path == "-";
  if (is_standard && written) { // whatever it is, it is not replaced
    if (std::exchange(standard_output_, true))
      throw Failure(kWrongUsage, "standard output is to be written twice: give one of them a name");
    return;
  }
  const bool there = look_at(path, info);
  if (there && S_ISDIR(info.st_mode))
    throw Failure(kUnusable, fmt::format("{}: cannot {}: {}", path, written ? "write" : "read",
                                         std::strerror(EISDIR)));
  if (there && !S_ISREG(info.st_mode))
    return; // a pipe, a terminal, /dev/null: written in place
  const Known file{there ? path : real_path(path), info.st_dev, there ? info.st_ino : 0, written};
  for (const Known &other : known_) {
    if (written && file.is(other))
      throw Failure(kWrongUsage,
                    fmt::format("{} is {}: give another name", path,
                                other.written ? "to be written twice"
                                              : "an input, which would be overwritten"));
  }
  if (written)
    require_room_for(path);
  known_.push_back(file);
}

FileRoles &FileRoles::reads(const std::string &path) {
  if (path.empty())
    return *this;
  refuse_redirection_into(path);
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

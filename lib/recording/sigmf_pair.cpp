// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/sigmf_pair.h"

#include <cerrno>
#include <cstdio>
#include <random>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "recording/sigmf_reader.h"

namespace ada {

namespace {

constexpr useconds_t kLockPause_us = 10'000;
constexpr int kLockTries = 1000; ///< ten seconds; a commit takes milliseconds

/// One commit at a time in a folder, so that two writers cannot mix their pairs. A file system
/// without locks does without.
Descriptor lock_folder(const std::string &folder) {
  Descriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  for (int i = 0; fd.get() >= 0 && ::flock(fd.get(), LOCK_EX | LOCK_NB) != 0; ++i) {
    if (errno != EWOULDBLOCK)
      break;
    if (i == kLockTries)
      throw Error(ADA4571_ERROR_BUSY, folder + ": another program keeps this folder locked");
    ::usleep(kLockPause_us);
  }
  return fd;
}

/// The file, locked; none where there is no regular file of that name.
Descriptor lock_data(const std::string &data_path) {
  Descriptor fd(::open(data_path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK));
  if (fd.get() < 0 || !file_id(fd.get()))
    return Descriptor();
  if (!lock_for_writing(fd.get()))
    throw Error(ADA4571_ERROR_BUSY, data_path + ": another program is recording into this file");
  return fd;
}

std::string without_end(const std::string &path) {
  return path.substr(0, path.rfind('.'));
}

/// A link to a file that is not there yet is followed; of a pair it would be half of it.
void refuse_torn_apart(const std::string &path) {
  const std::string meta = sigmf_meta_path(path), data = sigmf_data_path(path);
  if (file_id(meta) && file_id(data))
    return; // somebody has put them so
  const std::string meta_place = follow_links(meta), data_place = follow_links(data);
  if (without_end(meta_place) != without_end(data_place))
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, path +
                                                    ": links would put its two files apart, at " +
                                                    meta_place + " and " + data_place);
}

std::string name_in_folder(const std::string &path) {
  return path.substr(path.rfind('/') + 1);
}

} // namespace

bool lock_for_writing(int fd) noexcept {
  return ::flock(fd, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

Descriptor claim_sigmf_pair(const std::string &path) {
  refuse_torn_apart(path);
  const std::string data_path = follow_links(sigmf_data_path(path));
  const Descriptor lock = lock_folder(folder_of(data_path)); // a commit looks at the file, too
  return lock_data(data_path);
}

void write_sigmf_meta(const SigmfMeta &meta, const std::string &meta_path) {
  AtomicFile file(meta_path);
  file.write(sigmf_meta_to_json(meta));
  file.commit();
}

std::string free_sigmf_stem(const std::string &path) {
  std::random_device entropy;
  const std::string data = follow_links(sigmf_data_path(path));
  return data.substr(0, data.rfind('.')) + "." + std::to_string(entropy());
}

void publish_sigmf_pair(const std::string &path, SigmfMeta meta, const std::string &data,
                        IfRefused refused, const Descriptor &claim) {
  const std::string meta_path = follow_links(sigmf_meta_path(path));
  const std::string data_path = follow_links(sigmf_data_path(path));
  const std::string folder = folder_of(data_path);
  Descriptor lock;
  try {
    lock = lock_folder(folder);
    if (claim.get() < 0 || file_id(claim.get()) != file_id(data_path))
      lock_data(data_path);
    // A meta file elsewhere, by a link, cannot name the data file; then the checksum has to tell.
    meta.dataset = folder_of(meta_path) == folder ? name_in_folder(data) : "";
    if (!meta.dataset.empty())
      write_sigmf_meta(meta, meta_path);
  } catch (const Error &) {
    if (refused == IfRefused::remove)
      ::unlink(data.c_str());
    throw;
  }
  if (::rename(data.c_str(), data_path.c_str()) != 0)
    throw system_error(errno, sigmf_data_path(path), "cannot put in place");
  sync_folder(folder);
  meta.dataset.clear();
  write_sigmf_meta(meta, meta_path);
}

} // namespace ada

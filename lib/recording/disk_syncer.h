// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Brings a growing recording to the disk about once a second, in a thread of its own: a disk that
// is slow for a moment does not hold up the capture.
#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "recording/sigmf_meta.h"

namespace ada {

class DiskSyncer {
public:
  /// `fd` is the data file, open until the syncer is gone; the paths are its and the meta file's.
  DiskSyncer(int fd, std::string data_path, std::string meta_path);
  DiskSyncer(const DiskSyncer &) = delete;
  DiskSyncer &operator=(const DiskSyncer &) = delete;
  ~DiskSyncer();

  /// Written with the next turn, after the data that it speaks of.
  void put_meta(SigmfMeta meta);
  /// Throws what went wrong since the last call.
  void rethrow_failure();
  /// Ends the thread; then all of the data is on the disk, or this throws.
  void stop();

private:
  void run() noexcept;
  void sync_once();
  void end_thread() noexcept;

  int fd_;
  std::string data_path_, meta_path_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  std::optional<SigmfMeta> meta_;
  std::exception_ptr failure_;
  std::thread thread_;
};

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/disk_syncer.h"

#include <cerrno>
#include <chrono>
#include <utility>

#include <unistd.h>

#include "base/descriptor.h"
#include "recording/sigmf_pair.h"

namespace ada {

namespace {

constexpr std::chrono::seconds kInterval{1};

} // namespace

DiskSyncer::DiskSyncer(int fd, std::string data_path, std::string meta_path)
    : fd_(fd), data_path_(std::move(data_path)), meta_path_(std::move(meta_path)),
      thread_([this] { run(); }) {}

DiskSyncer::~DiskSyncer() {
  end_thread();
}

void DiskSyncer::put_meta(SigmfMeta meta) {
  const std::lock_guard lock(mutex_);
  meta_ = std::move(meta);
}

void DiskSyncer::rethrow_failure() {
  const std::lock_guard lock(mutex_);
  if (const auto failure = std::exchange(failure_, nullptr))
    std::rethrow_exception(failure);
}

void DiskSyncer::end_thread() noexcept {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    wake_.notify_all();
  }
  if (thread_.joinable())
    thread_.join();
}

void DiskSyncer::stop() {
  end_thread();
  rethrow_failure();
  sync_once();
}

void DiskSyncer::run() noexcept {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, kInterval, [this] { return stop_; })) {
    lock.unlock();
    std::exception_ptr failure;
    try {
      sync_once();
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure)
      failure_ = failure;
  }
}

void DiskSyncer::sync_once() {
  std::optional<SigmfMeta> meta;
  {
    const std::lock_guard lock(mutex_);
    meta.swap(meta_);
  }
  if (::fdatasync(fd_) != 0)
    throw system_error(errno, data_path_, "cannot write to the disk");
  if (meta)
    write_sigmf_meta(*meta, meta_path_);
}

} // namespace ada

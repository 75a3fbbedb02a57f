// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/room_ahead.h"

#include <algorithm>

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

namespace ada {

namespace {

/// As much again as the file holds, so that a short one takes little, and no more than this.
constexpr std::uint64_t kMost = std::uint64_t{64} << 20; // bytes
constexpr std::uint64_t kLeast = std::uint64_t{1} << 20;
/// Others write to the disk, too: so many times what is taken must be free.
constexpr std::uint64_t kFree = 16;

bool has_room(int fd, std::uint64_t bytes) {
  struct statvfs disk {};
  return ::fstatvfs(fd, &disk) == 0 && disk.f_frsize > 0 &&
         disk.f_bavail / kFree >= bytes / disk.f_frsize;
}

} // namespace

void RoomAhead::provide(int fd, std::uint64_t end) {
  if (end <= end_)
    return;
  const std::uint64_t bytes = std::clamp(end, kLeast, kMost);
  if (has_room(fd, bytes) &&
      ::fallocate(fd, FALLOC_FL_KEEP_SIZE, static_cast<off_t>(end), static_cast<off_t>(bytes)) == 0)
    taken_ = true;
  end_ = end + bytes; // where it was refused it is asked for again there
}

void RoomAhead::give_back(int fd, std::uint64_t size) noexcept {
  if (taken_ && end_ > size) {
    // To its own size: the file stays as it is.
    [[maybe_unused]] const int freed = ::ftruncate(fd, static_cast<off_t>(size));
  }
  end_ = 0;
  taken_ = false;
}

} // namespace ada

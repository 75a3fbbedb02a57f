// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <cstdint>

namespace ada {

/// Space on the disk for what a growing file will hold next, taken in few large pieces: a file
/// system that looks for space block by block with each write takes a quarter more processor time
/// to write. The file's size and contents stay as they are. A file system that cannot do it, or has
/// little space left, is left to its own ways.
class RoomAhead {
public:
  /// Before a write that ends at byte `end` of the file: space from there on.
  void provide(int fd, std::uint64_t end);
  /// What is beyond the `size` bytes of the file is free again.
  void give_back(int fd, std::uint64_t size) noexcept;

private:
  std::uint64_t end_ = 0; ///< of the space that was asked for; 0: none was
  bool taken_ = false;
};

} // namespace ada

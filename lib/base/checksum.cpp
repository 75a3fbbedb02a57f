// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/checksum.h"

#include <libdeflate.h>
#include <zlib.h>

namespace ada {

// libdeflate uses the processor's carry-less multiplication; only zlib joins two sums.
std::uint32_t crc32_of(std::span<const std::byte> bytes, std::uint32_t before) {
  return libdeflate_crc32(before, bytes.data(), bytes.size());
}

std::uint32_t crc32_joined(std::uint32_t first, std::uint32_t second, std::uint64_t second_bytes) {
  return static_cast<std::uint32_t>(
      crc32_combine(first, second, static_cast<z_off_t>(second_bytes)));
}

} // namespace ada

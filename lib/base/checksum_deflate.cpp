// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// By libdeflate, which is on every architecture.

#include <libdeflate.h>

#include "base/checksum.h"

namespace ada {

std::uint32_t crc32_of(std::span<const std::byte> bytes, std::uint32_t before) {
  return libdeflate_crc32(before, bytes.data(), bytes.size());
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// By ISA-L, which uses the widest carry-less multiplication that the processor has.

#include <isa-l/crc.h>

#include "base/checksum.h"

namespace ada {

std::uint32_t crc32_of(std::span<const std::byte> bytes, std::uint32_t before) {
  return crc32_gzip_refl(before, reinterpret_cast<const unsigned char *>(bytes.data()),
                         bytes.size());
}

} // namespace ada

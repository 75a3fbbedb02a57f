// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// CRC-32 as in zlib, gzip and PNG.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace ada {

/// Of bytes, behind those that gave `before`.
std::uint32_t crc32_of(std::span<const std::byte> bytes, std::uint32_t before = 0);

/// Of two runs of bytes, of which the second has this length.
std::uint32_t crc32_joined(std::uint32_t first, std::uint32_t second, std::uint64_t second_bytes);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/identity.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>

#include <zlib.h>

#include "recording/fixed_point.h"

namespace ada {

namespace {

/// One step count as eight bytes, least significant first, whatever the machine.
std::int64_t little_endian(std::int64_t value) {
  if constexpr (std::endian::native == std::endian::big)
    return static_cast<std::int64_t>(__builtin_bswap64(static_cast<std::uint64_t>(value)));
  return value;
}

uLong add_column(uLong crc, const char *name, const std::vector<double> &column, double scale) {
  constexpr std::int64_t kMissing = std::numeric_limits<std::int64_t>::min();
  crc = crc32(crc, reinterpret_cast<const Bytef *>(name), static_cast<uInt>(std::strlen(name)));
  std::array<std::int64_t, 4096> block;
  for (std::size_t first = 0; first < column.size(); first += block.size()) {
    const std::size_t count = std::min(block.size(), column.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const double value = column[first + i];
      block[i] = little_endian(std::isfinite(value) ? to_steps(value, scale) : kMissing);
    }
    crc = crc32(crc, reinterpret_cast<const Bytef *>(block.data()),
                static_cast<uInt>(count * sizeof(std::int64_t)));
  }
  return crc;
}

} // namespace

std::string capture_identity(const Capture &capture) {
  const double volts = power_of_ten(volt_decimals(capture.meta));
  struct Column {
    const char *name;
    const std::vector<double> &values;
    double scale;
  };
  const std::array columns = {
      Column{"time_s", capture.time_s, power_of_ten(kTimeDecimals)},
      Column{"vsin_v", capture.vsin_v, volts},
      Column{"vcos_v", capture.vcos_v, volts},
      Column{"vtemp_v", capture.vtemp_v, volts},
      Column{"vdd_v", capture.vdd_v, volts},
      Column{"reference_deg", capture.reference_deg, power_of_ten(kReferenceDecimals)},
  };
  uLong crc = crc32(0, nullptr, 0);
  int count = 0;
  for (const Column &column : columns) {
    if (column.values.empty())
      continue;
    crc = add_column(crc, column.name, column.values, column.scale);
    ++count;
  }
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "crc32:%08lx/%zux%d", crc, capture.size(), count);
  return text.data();
}

} // namespace ada

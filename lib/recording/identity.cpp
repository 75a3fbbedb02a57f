// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/identity.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>

#include "base/checksum.h"
#include "base/columns_of_numbers.h"
#include "base/parallel.h"
#include "recording/columns.h"
#include "recording/fixed_point.h"

namespace ada {

namespace {

std::uint32_t add_values(std::uint32_t crc, std::span<const double> values, double scale) {
  std::array<std::int64_t, 4096> steps;
  for (std::size_t first = 0; first < values.size(); first += steps.size()) {
    const std::size_t count = std::min(steps.size(), values.size() - first);
    decimal_steps(values.data() + first, scale, count, steps.data());
    if constexpr (std::endian::native ==
                  std::endian::big) // least significant byte first everywhere
      for (std::int64_t &step : steps)
        step = static_cast<std::int64_t>(__builtin_bswap64(static_cast<std::uint64_t>(step)));
    crc = crc32_of(std::as_bytes(std::span(steps).first(count)), crc);
  }
  return crc;
}

double steps_of(const Column &column, const CaptureMetadata &meta) {
  if (column.field == &Frame::time_s)
    return power_of_ten(kTimeDecimals);
  return power_of_ten(column.field == &Frame::reference_deg ? kReferenceDecimals
                                                            : volt_decimals(meta));
}

struct Sums {
  Block block;
  ColumnSums columns;
};

} // namespace

ColumnSums::ColumnSums(const Block &block, const CaptureMetadata &meta) {
  for (std::size_t c = 0; c < kColumns.size(); ++c) {
    const auto values = block.*kColumns[c].block;
    crc_[c] = add_values(crc_[c], values, steps_of(kColumns[c], meta));
    count_[c] = values.size();
  }
}

void ColumnSums::append(const ColumnSums &next) {
  for (std::size_t c = 0; c < kColumns.size(); ++c) {
    crc_[c] = crc32_joined(crc_[c], next.crc_[c], next.count_[c] * 8);
    count_[c] += next.count_[c];
  }
}

std::string ColumnSums::identity(const ChannelSet &channels, std::size_t samples) const {
  std::uint32_t crc = 0;
  int count = 0;
  for (std::size_t c = 0; c < kColumns.size(); ++c) {
    if (!channels.has(kColumns[c]) || samples == 0)
      continue;
    const std::string_view name = kColumns[c].name;
    crc = crc32_of(std::as_bytes(std::span(name)), crc);
    crc = crc32_joined(crc, crc_[c], count_[c] * 8);
    ++count;
  }
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "crc32:%08x/%zux%d", crc, samples, count);
  return text.data();
}

std::string recording_identity(const Recording &recording) {
  ColumnSums all;
  in_order<Sums>(
      recording.blocks(),
      [&](std::size_t k, Sums &s) {
        recording.read(k, kAllColumns, s.block);
        s.columns = ColumnSums(s.block, recording.meta());
      },
      [&](std::size_t, const Sums &s) { all.append(s.columns); });
  return all.identity(recording.channels(), recording.size());
}

std::string capture_identity(const Capture &capture) {
  return recording_identity(*recording_of(capture));
}

} // namespace ada

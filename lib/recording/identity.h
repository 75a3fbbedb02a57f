// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "recording/recording.h"

namespace ada {

/// Checksums of the columns of a stretch.
class ColumnSums {
public:
  ColumnSums() = default;
  ColumnSums(const Block &block, const CaptureMetadata &meta);

  /// Those of the stretch that follows.
  void append(const ColumnSums &next);
  /// The identity of the recording that the stretch is.
  std::string identity(const ChannelSet &channels, std::size_t samples) const;

private:
  std::array<std::uint32_t, kColumnCount> crc_{}; ///< 0 is that of nothing
  std::array<std::size_t, kColumnCount> count_{};
};

/// Names the content of a recording: "crc32:1a2b3c4d/70000x6", the checksum over the columns in the
/// resolution of the text form (fixed_point.h), the samples and the columns. Metadata and gaps do
/// not count, so the name survives a change of the form and of the description.
std::string recording_identity(const Recording &recording);

/// The same of a capture in memory.
std::string capture_identity(const Capture &capture);

} // namespace ada

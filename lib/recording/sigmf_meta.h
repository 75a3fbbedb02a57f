// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The .sigmf-meta file as data. docs/recordings.md describes the ada4571 extension.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "recording/capture.h"
#include "recording/sigmf_frame.h"

namespace ada {

/// Of the names that this library adds to a meta file.
inline constexpr std::string_view kSigmfPrefix = "ada4571:";

struct SigmfMeta {
  CaptureMetadata meta;
  std::vector<SigmfChannel> channels; ///< as they lie in a frame
  std::size_t frame_bytes = 0;
  std::vector<SigmfSegment> segments; ///< never empty; the first begins at sample 0
  std::optional<std::uint32_t> data_crc32;
  bool unfinished = false; ///< it grows, or its writer ended before it was complete
  std::string datetime;    ///< of the first sample, ISO 8601; empty where unknown
  std::string dataset; ///< name of a data file elsewhere than beside the meta file; mostly empty

  /// The channel of this name, or null.
  const SigmfChannel *find(std::string_view name) const;
};

/// Parses and validates; `shown` names the text in messages. Throws Error(ADA4571_ERROR_FORMAT)
/// "file:line:column: why".
SigmfMeta parse_sigmf_meta(std::string_view json, const std::string &shown);

std::string sigmf_meta_to_json(const SigmfMeta &meta);

/// Longest meta file that is read, and most segments that are written.
inline constexpr std::size_t kMaxSigmfMetaBytes = std::size_t{1} << 24;
inline constexpr std::size_t kMaxSigmfSegments = std::size_t{1} << 16;

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// How the channels of a capture lie in the frames of a .sigmf-data file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/scan_format.h"

namespace ada {

/// A word of a frame: an integer as IIO delivers it, or a float.
struct SampleType {
  ScanFormat word;       ///< of a float only storage and big_endian count
  bool is_float = false; ///< 32 or 64 bits

  bool operator==(const SampleType &) const = default;
};

/// "le:s12/16>>4" (as scan_elements/*_type of IIO), or "le:f32", "be:f64" and so on. Throws
/// Error(ADA4571_ERROR_FORMAT or _UNSUPPORTED).
SampleType parse_sample_type(std::string_view text);
std::string to_string(const SampleType &type);

/// The type of every word of a SigMF datatype ("ri16_le", "rf64_be", "ru8"), and back. Throws
/// Error(ADA4571_ERROR_FORMAT); complex types are refused.
SampleType type_of_datatype(std::string_view datatype);
std::string datatype_of(const SampleType &type);

/// One channel: value = (raw + offset) * scale, in the unit of its column.
struct SigmfChannel {
  std::string name; ///< as in the text form; others are ignored
  SampleType type;
  std::size_t byte = 0; ///< offset in the frame
  double scale = 1.0, offset = 0.0;
};

/// Whether every number that the words of a channel can hold is within the limit of its column.
bool always_within(const SigmfChannel &channel, double limit);

/// Values of one channel of `frames`, whole frames of `frame_bytes`.
void decode_channel(const SigmfChannel &channel, std::span<const std::byte> frames,
                    std::size_t frame_bytes, double *out);

/// The integers of a channel, for timestamps that a double could not hold.
void decode_integers(const SigmfChannel &channel, std::span<const std::byte> frames,
                     std::size_t frame_bytes, std::int64_t *out);

/// Puts the bytes of each channel where IIO would: aligned to its size, the frame to the largest.
/// Returns the bytes of a frame.
std::size_t place_channels(std::vector<SigmfChannel> &channels);

/// A stretch of samples without a gap.
struct SigmfSegment {
  std::size_t sample_start = 0;
  std::uint64_t global_index = 0; ///< counted with the samples that are missing
  double time_s = 0.0;            ///< of its first sample
};

/// The segment that begins at sample `index` after a gap; `last_time` is that of the sample before,
/// `rate_hz` 0 where it is unknown.
SigmfSegment next_segment(const SigmfSegment &before, std::size_t index, double time_s,
                          double last_time_s, double rate_hz);

/// Time of sample `i` of a segment when there is no time channel.
inline double regular_time(const SigmfSegment &segment, std::size_t i, double rate_hz) {
  return segment.time_s + static_cast<double>(i - segment.sample_start) / rate_hz;
}

} // namespace ada

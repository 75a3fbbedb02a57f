// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Frames as a device gives them, for a recording that keeps its integers: what brings one sample to
// volts and seconds is said once, and no sample is converted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "acquisition/scan_format.h"
#include "base/frame.h"

namespace ada {

struct RawChannel {
  double Frame::*target = nullptr;
  ScanFormat format;
  LinearScale scale;
  std::size_t byte = 0; ///< in the frame

  bool operator==(const RawChannel &) const = default;
};

/// The timestamp is a signed word of 64 bits in the byte order of this machine, in nanoseconds.
struct RawForm {
  std::vector<RawChannel> channels; ///< in the order of the scan, without the timestamp
  std::size_t timestamp_byte = 0, frame_bytes = 0;

  bool operator==(const RawForm &) const = default;
};

/// Lives until the next read.
struct RawFrames {
  const RawForm *form = nullptr;
  std::span<const std::byte> bytes;
  std::size_t count = 0;
  std::int64_t origin_ns = 0; ///< timestamp at time 0, the first frame since the start
  /// Times of the frames where a timestamp is not the time after origin_ns; mostly empty.
  std::span<const std::int64_t> times_ns;
  /// No step between two of them is longer, where times_ns is empty.
  std::int64_t longest_step_ns = 0;

  std::int64_t timestamp(std::size_t i) const {
    std::int64_t word;
    std::memcpy(&word, bytes.data() + i * form->frame_bytes + form->timestamp_byte, sizeof word);
    return word;
  }
  std::int64_t time_ns(std::size_t i) const {
    return times_ns.empty() ? static_cast<std::int64_t>(static_cast<std::uint64_t>(timestamp(i)) -
                                                        static_cast<std::uint64_t>(origin_ns))
                            : times_ns[i];
  }
  double time_s(std::size_t i) const { return static_cast<double>(time_ns(i)) / 1e9; }
  RawFrames first(std::size_t n) const {
    RawFrames out = *this;
    out.count = n;
    out.bytes = bytes.first(n * form->frame_bytes);
    out.times_ns = times_ns.empty() ? times_ns : times_ns.first(n);
    return out;
  }
};

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The capture buffer of one client: counts into bytes as the kernel lays them out, at the pace of
// the device.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "simulation/served_context.h"

namespace ada {

/// What all buffers of the process may hold together. A buffer that does not fit any more is
/// refused with ENOMEM. 64 clients at a twentieth of a second of 10 MS/s, 10 bytes a frame, take
/// 305 MiB.
inline constexpr std::size_t kMostBufferBytes = std::size_t{320} << 20;

/// A part of kMostBufferBytes, given back at the end.
class BufferMemory {
public:
  BufferMemory() = default;
  ~BufferMemory();
  BufferMemory(const BufferMemory &) = delete;
  BufferMemory &operator=(const BufferMemory &) = delete;
  /// False where so much is not left. Once.
  bool take(std::size_t bytes);

private:
  std::size_t bytes_ = 0;
};

class IiodBuffer {
public:
  using Clock = std::chrono::steady_clock;

  explicit IiodBuffer(const ServedDevice &device) : device_(device) {}

  /// `mask`: 32 channels a word of eight hexadecimal digits, the highest first. 0 or an errno:
  /// EINVAL, or ENOMEM where the clients hold kMostBufferBytes already. begin() comes next.
  int open(std::size_t samples, std::string_view mask);
  /// Anew, or where another buffer left off.
  void begin(std::optional<Run> left);
  /// What another buffer can go on with. This one is of no use afterwards.
  Run leave() { return std::move(run_); }

  const std::string &mask_text() const { return mask_; }
  /// Whole frames in so many bytes, at most the buffer.
  std::size_t frames_in(std::size_t bytes) const;
  /// When the next `frames` frames are there.
  Clock::time_point due(std::size_t frames) const;
  /// Makes them, fewer at the end of the stream and none behind it; how many.
  std::size_t produce(std::size_t frames);
  std::string_view data() const { return {bytes_.data(), used_}; }

private:
  struct Element {
    ScanFormat format;
    std::size_t column; ///< in the counts, for a voltage
    bool timestamp;
  };

  /// Seconds from the beginning of the stream to when that frame is taken.
  double time_of(std::uint64_t frame) const;
  /// Lays `frames` frames of counts_ down from frame `first` of the buffer on.
  void lay_down(std::size_t first, std::size_t frames);
  void put(char *at, const ScanFormat &format, std::int64_t value) const;

  const ServedDevice &device_;
  std::string mask_;
  std::vector<Element> elements_;
  FrameLayout layout_;
  std::size_t columns_ = 0; ///< words of a frame of the stream
  Run run_;
  std::vector<std::int64_t> counts_; ///< of one piece
  BufferMemory memory_;
  std::vector<char> bytes_;
  std::size_t used_ = 0;
};

} // namespace ada

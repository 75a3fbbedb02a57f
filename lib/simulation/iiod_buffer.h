// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The capture buffer of one client: counts into bytes as the kernel lays them out, at the pace of
// the device.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/served_context.h"

namespace ada {

class IiodBuffer {
public:
  using Clock = std::chrono::steady_clock;

  explicit IiodBuffer(const ServedDevice &device) : device_(device) {}

  /// `mask`: 32 channels a word of eight hexadecimal digits, the highest first. 0 or an errno.
  int open(std::size_t samples, std::string_view mask);

  const std::string &mask_text() const { return mask_; }
  /// Whole frames in so many bytes, at most the buffer.
  std::size_t frames_in(std::size_t bytes) const;
  /// When the next `frames` frames are there.
  Clock::time_point due(std::size_t frames) const;
  /// Makes them; false at the end of the stream.
  bool produce(std::size_t frames);
  std::string_view data() const { return {bytes_.data(), used_}; }

private:
  struct Element {
    ScanFormat format;
    std::size_t column; ///< in the counts, for a voltage
    bool timestamp;
  };

  void put(char *at, const ScanFormat &format, std::int64_t value) const;

  const ServedDevice &device_;
  std::string mask_;
  std::vector<Element> elements_;
  FrameLayout layout_;
  std::size_t columns_ = 0; ///< words of a frame of the stream
  std::unique_ptr<FrameCounts> stream_;
  std::vector<std::int64_t> counts_;
  std::vector<char> bytes_;
  std::size_t used_ = 0;
  std::uint64_t produced_ = 0;
  Clock::time_point began_;
  std::int64_t began_ns_ = 0;
};

} // namespace ada

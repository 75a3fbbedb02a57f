// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Whole frames from blocks of bytes that may end anywhere. Short reads are ordinary: what is left
// of a frame at the end of a block is kept and completed from the next. No allocation after
// reset().
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

namespace ada {

class FrameAssembler {
public:
  /// Forgets everything; frames are `frame_bytes` long from now on.
  void reset(std::size_t frame_bytes) {
    split_.assign(frame_bytes, std::byte{});
    kept_ = 0;
    block_ = {};
  }

  std::size_t frame_bytes() const { return split_.size(); }

  /// The next block; the one before must be used up (take() returned nothing). It is not copied
  /// and must live until it is used up.
  void feed(std::span<const std::byte> block) { block_ = block; }

  /// Up to max_frames frames in one piece; empty: feed more.
  std::span<const std::byte> take(std::size_t max_frames) {
    const std::size_t size = frame_bytes();
    if (kept_ > 0 || block_.size() < size)
      return complete_split_frame();
    const auto whole = block_.first(std::min(max_frames, block_.size() / size) * size);
    block_ = block_.subspan(whole.size());
    return whole;
  }

private:
  std::span<const std::byte> complete_split_frame() {
    const std::size_t part = std::min(frame_bytes() - kept_, block_.size());
    if (part > 0)
      std::memcpy(split_.data() + kept_, block_.data(), part);
    block_ = block_.subspan(part);
    kept_ += part;
    if (kept_ < frame_bytes() || kept_ == 0)
      return {};
    kept_ = 0;
    return split_;
  }

  std::vector<std::byte> split_; ///< the frame that a block boundary has cut
  std::size_t kept_ = 0;         ///< bytes of it that are there
  std::span<const std::byte> block_;
};

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What every writer asks of what it is given, so that each file written can be read again.
#pragma once

#include <set>
#include <string>
#include <string_view>

#include "recording/capture_file.h"

namespace ada {

/// Metadata and frames on their way into a file. All functions throw
/// Error(ADA4571_ERROR_INVALID_ARGUMENT or _STATE) that name the place.
class FrameCheck {
public:
  FrameCheck(const CaptureMetadata &meta, const ChannelSet &channels);

  void add_metadata(std::string_view key, std::string_view value);
  void accept(const Frame &frame);
  /// Many at once, whose values are within their limits and whose times do not go back.
  void accept_all(double first_s, double last_s, std::size_t count);
  /// Call once, when finishing.
  void require_frames() const;

  const CaptureMetadata &meta() const { return meta_; }
  const ChannelSet &channels() const { return channels_; }
  std::size_t frames() const { return frames_; }

private:
  void accept_time(double time_s);

  CaptureMetadata meta_;
  ChannelSet channels_;
  std::set<std::string, std::less<>> keys_;
  std::size_t frames_ = 0;
  double last_time_ = 0;
};

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/frame_check.h"

#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "recording/metadata.h"

namespace ada {

FrameCheck::FrameCheck(const CaptureMetadata &meta, const ChannelSet &channels)
    : meta_(meta), channels_(channels) {
  if (const std::string problem = check_metadata(meta_); !problem.empty())
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, problem);
  for (const auto &[key, value] : meta_.other)
    if (!keys_.insert(key).second)
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "the key " + excerpt(key) + " is given twice");
}

void FrameCheck::add_metadata(std::string_view key, std::string_view value) {
  if (frames_ > 0)
    throw Error(ADA4571_ERROR_STATE, "metadata must be given before the first frame");
  if (is_known_metadata(key))
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                "the key " + excerpt(key) + " belongs to the recording's info: set it there");
  if (keys_.find(key) != keys_.end())
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "the key " + excerpt(key) + " is given twice");
  if (const std::string problem = assign_metadata(meta_, key, value); !problem.empty())
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, problem);
  keys_.emplace(key);
}

void FrameCheck::accept(const Frame &frame) {
  for (const Column &column : kColumns) {
    const double value = frame.*column.field;
    if (!channels_.has(column) || std::fabs(value) <= column.limit)
      continue;
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                "frame " + std::to_string(frames_) + ": " + std::string(column.name) +
                    (std::isnan(value) ? " is not a number" : " is out of range"));
  }
  accept_time(frame.time_s);
  ++frames_;
}

void FrameCheck::accept_time(double time_s) {
  if (frames_ > 0 && time_s < last_time_)
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                "frame " + std::to_string(frames_) + ": time_s goes back from " +
                    shortest(last_time_) + " to " + shortest(time_s));
  last_time_ = time_s;
}

void FrameCheck::accept_all(double first_s, double last_s, std::size_t count) {
  if (!(std::fabs(first_s) <= kMaxTimeS && std::fabs(last_s) <= kMaxTimeS))
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                "frame " + std::to_string(frames_) + ": time_s is out of range");
  accept_time(first_s);
  last_time_ = last_s;
  frames_ += count;
}

void FrameCheck::require_frames() const {
  if (frames_ == 0)
    throw Error(ADA4571_ERROR_STATE, "the recording has no frame: there is nothing to write");
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Frames as the bytes of a .sigmf-data file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "recording/capture.h"
#include "recording/columns.h"
#include "recording/sigmf_frame.h"

namespace ada {

/// What the data file holds; each can only be given up, not gained, while frames come.
struct SigmfForm {
  bool counts = false;  ///< voltages as codes of the converter
  bool regular = false; ///< no time channel: the sample rate and the segments say the time
};

/// Frames to bytes in one form. VDD and the reference are no channels of the converter and stay
/// doubles.
class SigmfEncoder {
public:
  SigmfEncoder(const CaptureMetadata &meta, const ChannelSet &present, SigmfForm form);

  /// The bytes of a frame, or nothing when a voltage is no code of the converter.
  std::optional<std::span<const std::byte>> encode(const Frame &frame);

  SigmfForm form() const { return form_; }

  std::vector<SigmfChannel> channels;
  std::size_t frame_bytes = 0;

private:
  struct Item {
    double Frame::*field;
    bool is_time;
    double steps; ///< decimal steps a volt
  };

  void store(const SigmfChannel &channel, std::uint64_t word);

  SigmfForm form_;
  std::vector<Item> items_;
  std::vector<std::byte> buffer_;
};

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The channels of a capture as one table: name in the file, place in a Capture, in a Block
// and in a Frame.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "base/frame.h"
#include "recording/block.h"
#include "recording/capture.h"
#include "recording/fixed_point.h"

namespace ada {

struct Column {
  std::string_view name;
  std::vector<double> Capture::*values;
  std::span<const double> Block::*block;
  double Frame::*field;
  double limit; ///< greatest magnitude that a file may hold
  bool required;
};

inline constexpr std::array kColumns = {
    Column{"time_s", &Capture::time_s, &Block::time_s, &Frame::time_s, kMaxTimeS, true},
    Column{"vsin_v", &Capture::vsin_v, &Block::vsin_v, &Frame::vsin_v, kMaxVolts, true},
    Column{"vcos_v", &Capture::vcos_v, &Block::vcos_v, &Frame::vcos_v, kMaxVolts, true},
    Column{"vtemp_v", &Capture::vtemp_v, &Block::vtemp_v, &Frame::vtemp_v, kMaxVolts, false},
    Column{"vdd_v", &Capture::vdd_v, &Block::vdd_v, &Frame::vdd_v, kMaxVolts, false},
    Column{"reference_deg", &Capture::reference_deg, &Block::reference_deg, &Frame::reference_deg,
           kMaxDegrees, false},
};
static_assert(kColumns.size() == kColumnCount);

/// Which of the optional channels there are.
struct ChannelSet {
  bool vtemp = false, vdd = false, reference = false;

  static ChannelSet of(const Capture &capture) {
    return {capture.has_vtemp(), capture.has_vdd(), capture.has_reference()};
  }
  bool has(const Column &column) const {
    if (column.field == &Frame::vtemp_v)
      return vtemp;
    if (column.field == &Frame::vdd_v)
      return vdd;
    return column.field == &Frame::reference_deg ? reference : true;
  }
};

/// Sample i of a block with every channel; absent ones are NaN.
inline Frame frame_at(const Block &block, std::size_t i) {
  Frame frame = empty_frame();
  for (const Column &column : kColumns)
    if (const auto &values = block.*column.block; !values.empty())
      frame.*column.field = values[i];
  return frame;
}

/// The same of a capture.
inline Frame frame_at(const Capture &capture, std::size_t i) {
  Frame frame = empty_frame();
  for (const Column &column : kColumns)
    if (const auto &values = capture.*column.values; !values.empty())
      frame.*column.field = values[i];
  return frame;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A recording to angles, block by block, in any order and by several threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "conversion/frame_converter.h"
#include "conversion/raw_converter.h"
#include "conversion/vector_kernels.h"
#include "recording/recording.h"

namespace ada {

/// The angles of one block, a column each. Times are those of the block that was read.
struct AngleBlock {
  Block block;
  std::vector<double> angle_deg, radius;
  std::vector<std::uint32_t> status;

  std::size_t count() const { return block.count; }
  ada4571_angle at(std::size_t i) const {
    return {block.time_s[i], angle_deg[i], radius[i], status[i]};
  }
  void set(std::size_t i, const ada4571_angle &angle);
  void resize(std::size_t count);
};

class BlockConverter {
public:
  /// Refuses what FrameConverter::capture refuses.
  BlockConverter(const Model &model, const Recording &recording);

  /// Reads a block and converts it, with or without its times.
  void convert(std::size_t block, AngleBlock &out, bool times = true) const;
  /// Converts the block in `out`, of which columns() at least was read.
  void convert(AngleBlock &out) const;
  /// `times`: the result is to hold them; the kernels need none.
  ColumnMask columns(bool times = true) const {
    return (times || !raw_ ? kTimeColumn : 0) | kPairColumns | (raw_ ? 0 : kVtempColumn);
  }

private:
  void by_kernel(AngleBlock &out) const;
  void by_kernel(const RawPairs &in, AngleBlock &out) const;
  SampleLimits limits(const ada4571_layout &layout) const;
  void convert_singly(const Block &in, AngleBlock &out) const;
  void by_frames(AngleBlock &out) const;
  void mark_gaps(AngleBlock &out) const;

  const Recording &recording_;
  Model model_; ///< at the supply of the recording
  FrameConverter frames_;
  std::optional<RawConverter> raw_;
  std::vector<ada4571_angle> all_; ///< where a sample needs those on both of its sides
};

} // namespace ada

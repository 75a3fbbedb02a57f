// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Live frames, and live angles from them.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "common/handles.h"

namespace cli {

/// Starts the source and hands over block after block, until `take` returns false, the source is
/// exhausted, or Ctrl-C. `take` is also called with an empty block a few times a second when
/// nothing comes. Throws when nothing comes for ten seconds.
void read_blocks(const Source &source,
                 const std::function<bool(std::span<const ada4571_frame>)> &take);
/// The same under a StopSignal of the caller, which cancels the source: for work that must be
/// finished after the reading, whatever signals come.
void read_until_stopped(const Source &source,
                        const std::function<bool(std::span<const ada4571_frame>)> &take);

/// Calibration for a live source: the file when one is named, else what the stored configuration
/// or the driver has, else an ideal sensor, which standard error is told.
Model live_model(const Source &source, const std::string &path);

/// Frames to angles, block after block: a converter, or with `dynamic` a tracker.
class LiveAngles {
public:
  LiveAngles(const Model &model, bool dynamic);
  std::span<const ada4571_angle> convert(std::span<const ada4571_frame> frames);
  /// 360/p degrees.
  double range_deg() const { return range_deg_; }

private:
  Converter converter_;
  Tracker tracker_;
  double range_deg_;
  std::vector<ada4571_angle> angles_;
};

/// 360/p degrees of a model.
double angle_range_deg(const Model &model);

/// Tells standard error what of the angle's correction has no name.
void mention_remainder(const Model &model);

} // namespace cli

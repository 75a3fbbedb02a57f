// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Frames in volts to angles, sample by sample, with status. A model that folds into an ellipse is
// inverted in closed form here; every other model goes to the iterative AngleSolver.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "base/frame.h"
#include "conversion/ellipse.h"
#include "recording/columns.h"
#include "recording/gap_detector.h"

namespace ada {

class AngleSolver;

/// One sample through the inverse. `angle` gets angle_deg, radius and the status bits for radius,
/// rails and invalid numbers; its time_s is the frame's.
void convert_sample(const EllipseInverse &inverse, int periods_per_turn, double zero_rad,
                    double supply_v, const Frame &frame, ada4571_angle &angle);

/// What a calibration must go with: where the frames come from.
struct FramesOf {
  std::string what; ///< "capture", in a message
  bool live;        ///< channels of a device, no columns of a file
  int periods_per_turn;
  double supply_v;
  bool vtemp;
};

/// The model at the supply of such frames. Throws ADA4571_ERROR_UNUSABLE_DATA where it cannot
/// convert them: other periods a turn, or no VTEMP where it follows that.
Model model_for(const Model &model, const FramesOf &frames);
Model model_for(const Model &model, const CaptureMetadata &meta, const ChannelSet &channels);

class FrameConverter {
public:
  explicit FrameConverter(const Model &model);
  ~FrameConverter();

  /// A live stream, block after block; no allocation. Where the model follows VTEMP, a missing
  /// VTEMP is taken from the frame before; before the first one the sample is invalid.
  void frames(std::span<const Frame> in, std::span<ada4571_angle> out);

  /// A whole capture, at the supply that it states: outputs are ratiometric. Throws
  /// ADA4571_ERROR_UNUSABLE_DATA when the model follows VTEMP and the capture has none.
  void capture(const Capture &in, std::span<ada4571_angle> out) const;

  /// Whether an angle depends on its own sample alone, but for a VTEMP that is missing.
  bool sample_by_sample() const { return ellipse_.has_value(); }
  /// One such sample; `vtemp_v` is the last one seen, before and after it.
  ada4571_angle sample(const Frame &frame, double &vtemp_v) const;
  ada4571_angle sample(const Frame &frame) const {
    double vtemp_v = kAbsent;
    return sample(frame, vtemp_v);
  }

private:
  Model model_;
  std::optional<EllipseModel> ellipse_;
  EllipseInverse inverse_{}; ///< where nothing follows VTEMP
  std::unique_ptr<AngleSolver> solver_;
  GapDetector gaps_;
  double vtemp_v_; ///< last one seen
};

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "conversion/frame_converter.h"

#include <cmath>

#include "base/angle.h"
#include "base/error.h"
#include "conversion/angle_solver.h"
#include "conversion/sample_status.h"

namespace ada {

void convert_sample(const EllipseInverse &inverse, int periods_per_turn, double zero_rad,
                    double supply_v, const Frame &frame, ada4571_angle &angle) {
  angle.time_s = frame.time_s;
  const double y = inverse.sine(frame.vsin_v, frame.vcos_v);
  const double x = inverse.cosine(frame.vsin_v, frame.vcos_v);
  angle.radius = std::hypot(y, x);
  if (!std::isfinite(angle.radius)) {
    angle.angle_deg = kAbsent;
    angle.radius = kAbsent;
    angle.status = ADA4571_SAMPLE_INVALID;
    return;
  }
  const double alpha = std::atan2(y, x) / periods_per_turn - zero_rad;
  angle.angle_deg = wrap(alpha * kDegPerRad, 360.0 / periods_per_turn);
  angle.status = radius_status(angle.radius) | rail_status(frame.vsin_v, frame.vcos_v, supply_v);
}

FrameConverter::FrameConverter(const Model &model) : model_(model), vtemp_v_(kAbsent) {
  if (EllipseModel::beyond(model).empty()) {
    ellipse_.emplace(model);
    inverse_ = ellipse_->at(model.vtemp_reference_v);
  } else {
    solver_ = std::make_unique<AngleSolver>(model);
  }
}

FrameConverter::~FrameConverter() = default;

ada4571_angle FrameConverter::sample(const Frame &in, double &vtemp_v) const {
  const int p = ellipse_->periods_per_turn();
  const double zero = ellipse_->zero_rad(), supply_v = ellipse_->supply_v();
  ada4571_angle out{in.time_s, kAbsent, kAbsent, ADA4571_SAMPLE_INVALID};
  if (std::isfinite(in.vtemp_v))
    vtemp_v = in.vtemp_v;
  if (!ellipse_->follows_temperature())
    convert_sample(inverse_, p, zero, supply_v, in, out);
  else if (std::isfinite(vtemp_v))
    convert_sample(ellipse_->at(vtemp_v), p, zero, supply_v, in, out);
  return out;
}

void FrameConverter::frames(std::span<const Frame> in, std::span<ada4571_angle> out) {
  if (solver_)
    solver_->frames(in, out);
  else
    for (std::size_t i = 0; i < in.size(); ++i)
      out[i] = sample(in[i], vtemp_v_);
  for (std::size_t i = 0; i < in.size(); ++i)
    if (gaps_(in[i].time_s))
      out[i].status |= ADA4571_SAMPLE_GAP;
}

Model model_for(const Model &model, const FramesOf &frames) {
  model.require_periods(frames.periods_per_turn, "the calibration", "the " + frames.what);
  if (!frames.vtemp && EllipseModel::beyond(model).empty() &&
      EllipseModel(model).follows_temperature())
    throw Error(ADA4571_ERROR_UNUSABLE_DATA,
                "the calibration follows VTEMP and the " + frames.what + " has no " +
                    (frames.live ? "channel of it: name one" : "column vtemp_v: record VTEMP") +
                    ", or use a single-temperature calibration");
  // Everything the sensor puts out is a fraction of its supply, so the calibration scales.
  return frames.supply_v != model.supply_v ? model.at_supply(frames.supply_v) : model;
}

Model model_for(const Model &model, const CaptureMetadata &meta, const ChannelSet &channels) {
  return model_for(
      model, FramesOf{"capture", false, meta.periods_per_turn, meta.supply_v, channels.vtemp});
}

void FrameConverter::capture(const Capture &in, std::span<ada4571_angle> out) const {
  const Model model = model_for(model_, in.meta, ChannelSet::of(in));
  if (model.supply_v != model_.supply_v) {
    FrameConverter(model).capture(in, out);
    return;
  }
  double vtemp_v = kAbsent;
  if (solver_)
    solver_->capture(in, out);
  else
    for (std::size_t i = 0; i < in.size(); ++i)
      out[i] = sample(frame_at(in, i), vtemp_v);
  GapDetector gaps; // those that the source did not report
  for (std::size_t i = 0; i < in.size(); ++i)
    if (gaps(in.time_s[i]))
      out[i].status |= ADA4571_SAMPLE_GAP;
  for (const std::size_t gap : in.gaps)
    if (gap < in.size())
      out[gap].status |= ADA4571_SAMPLE_GAP;
}

} // namespace ada

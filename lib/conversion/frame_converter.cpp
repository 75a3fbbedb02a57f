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

void FrameConverter::convert(const EllipseModel &ellipse, double &vtemp, const Frame &in,
                             ada4571_angle &out) const {
  const int p = ellipse.periods_per_turn();
  if (!ellipse.follows_temperature()) {
    convert_sample(inverse_, p, ellipse.zero_rad(), ellipse.supply_v(), in, out);
    return;
  }
  if (std::isfinite(in.vtemp_v))
    vtemp = in.vtemp_v;
  if (std::isfinite(vtemp))
    convert_sample(ellipse.at(vtemp), p, ellipse.zero_rad(), ellipse.supply_v(), in, out);
  else
    out = {in.time_s, kAbsent, kAbsent, ADA4571_SAMPLE_INVALID};
}

void FrameConverter::frames(std::span<const Frame> in, std::span<ada4571_angle> out) {
  if (solver_)
    solver_->frames(in, out);
  else
    for (std::size_t i = 0; i < in.size(); ++i)
      convert(*ellipse_, vtemp_v_, in[i], out[i]);
  for (std::size_t i = 0; i < in.size(); ++i)
    if (gaps_(in[i].time_s))
      out[i].status |= ADA4571_SAMPLE_GAP;
}

void FrameConverter::capture(const Capture &in, std::span<ada4571_angle> out) const {
  if (in.meta.periods_per_turn != model_.periods_per_turn)
    throw Error(
        ADA4571_ERROR_UNUSABLE_DATA,
        "the calibration is for periods_per_turn = " + std::to_string(model_.periods_per_turn) +
            ", the capture says " + std::to_string(in.meta.periods_per_turn));
  if (in.meta.supply_v != model_.supply_v) {
    // Everything the sensor puts out is a fraction of its supply, so the calibration scales.
    FrameConverter(model_.at_supply(in.meta.supply_v)).capture(in, out);
    return;
  }
  if (solver_)
    solver_->capture(in, out);
  else
    by_ellipse(in, out);
  GapDetector gaps; // those that the source did not report
  for (std::size_t i = 0; i < in.size(); ++i)
    if (gaps(in.time_s[i]))
      out[i].status |= ADA4571_SAMPLE_GAP;
  for (const std::size_t gap : in.gaps)
    if (gap < in.size())
      out[gap].status |= ADA4571_SAMPLE_GAP;
}

void FrameConverter::by_ellipse(const Capture &in, std::span<ada4571_angle> out) const {
  if (ellipse_->follows_temperature() && !in.has_vtemp())
    throw Error(
        ADA4571_ERROR_UNUSABLE_DATA,
        "the calibration follows VTEMP and the capture has no column vtemp_v: record VTEMP, "
        "or use a single-temperature calibration");
  double vtemp = kAbsent;
  for (std::size_t i = 0; i < in.size(); ++i) {
    Frame frame = empty_frame();
    frame.time_s = in.time_s[i];
    frame.vsin_v = in.vsin_v[i];
    frame.vcos_v = in.vcos_v[i];
    if (in.has_vtemp())
      frame.vtemp_v = in.vtemp_v[i];
    convert(*ellipse_, vtemp, frame, out[i]);
  }
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/tracker.h"

#include <algorithm>
#include <cmath>

#include "base/angle.h"
#include "base/error.h"
#include "calibration/single.h"
#include "conversion/frame_converter.h"

namespace ada {

namespace {

/// What a stored calibration may be off by at the first turn, of the amplitude.
constexpr double kStartError = 0.02;
/// A turn whose distances are farther than this from any ellipse (of the amplitude) teaches
/// nothing.
constexpr double kMaxUnexplained = 0.05;
/// Spikes: this many times the running scatter.
constexpr double kSpike = 8.0;
/// So many unsound samples in a row are no spike but a fault: the turn is not believed.
constexpr int kFault = 3;
/// The trend is carried on for this many windows beyond the last measurement.
constexpr double kHorizon = 2.0;

std::array<TrendFilter, kEllipseSize> trends(double max_rate, double amplitude) {
  const double relative = max_rate / amplitude;
  return {TrendFilter(max_rate, kStartError * amplitude), TrendFilter(relative, kStartError),
          TrendFilter(relative, kStartError), TrendFilter(max_rate, kStartError * amplitude),
          TrendFilter(max_rate, kStartError * amplitude)};
}

double checked_rate(double rate) {
  if (!(rate > 0) || !std::isfinite(rate))
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                "max_offset_rate_v_per_s must be greater than zero");
  return rate;
}

void set_effect(Model &model, std::string_view id, double value) {
  EffectInstance fresh = effect_instance(id, {value}, {});
  for (EffectInstance &e : model.effects)
    if (e.effect == fresh.effect) {
      e = fresh;
      return;
    }
  model.effects.push_back(std::move(fresh));
}

} // namespace

Tracker::Tracker(const Model &model, const TrackerOptions &options)
    : model_(model), ellipse_(model), options_(options), amplitude_v_(model.baseline.amplitude_v),
      trend_(trends(checked_rate(options.max_offset_rate_v_per_s), amplitude_v_)),
      window_(model.periods_per_turn), scatter_v_(model.noise_rms_v.value_or(1e-3 * amplitude_v_)),
      vtemp_v_(kAbsent), time_s_(0) {}

EllipseParameters Tracker::in_force(double time_s, double vtemp_v) const {
  EllipseParameters e = ellipse_.parameters_at(vtemp_v);
  e.centre_sin_v += trend_[kCentreSin].at(time_s);
  e.centre_cos_v += trend_[kCentreCos].at(time_s);
  if (options_.track_amplitude) {
    const double a = e.amplitude_v;
    e.amplitude_v = std::clamp(a + trend_[kAmplitude].at(time_s), 0.5 * a, 1.5 * a);
    e.k = std::clamp(e.k + trend_[kMismatch].at(time_s), -1.0, 1.0);
  }
  if (options_.track_phase)
    e.delta_rad = std::clamp(e.delta_rad + trend_[kDelta].at(time_s), -1.0, 1.0);
  return e;
}

void Tracker::frames(std::span<const Frame> in, std::span<ada4571_angle> out) {
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Frame &frame = in[i];
    if (std::isfinite(frame.vtemp_v))
      vtemp_v_ = frame.vtemp_v;
    if (std::isfinite(frame.time_s)) {
      if (!begun_)
        for (TrendFilter &t : trend_)
          t.begin(frame.time_s);
      begun_ = true;
      time_s_ = frame.time_s;
    }
    if (ellipse_.follows_temperature() && !std::isfinite(vtemp_v_)) {
      out[i] = {frame.time_s, kAbsent, kAbsent, ADA4571_SAMPLE_INVALID};
      continue;
    }
    const EllipseParameters e = in_force(time_s_, vtemp_v_);
    const EllipseInverse inverse = ellipse_.wired(invert(e));
    convert_sample(inverse, ellipse_.periods_per_turn(), ellipse_.zero_rad(), ellipse_.supply_v(),
                   frame, out[i]);
    if (gaps_(frame.time_s)) {
      out[i].status |= ADA4571_SAMPLE_GAP;
      window_.reset(); // how far it turned meanwhile is not known
      forget_neighbours();
    }
    if ((out[i].status & ~unsigned{ADA4571_SAMPLE_GAP}) != 0 || !std::isfinite(frame.time_s)) {
      forget_neighbours();
      if (++unsound_ == kFault)
        window_.reset();
      continue;
    }
    unsound_ = 0;
    const double y = inverse.sine(frame.vsin_v, frame.vcos_v);
    const double x = inverse.cosine(frame.vsin_v, frame.vcos_v), r = out[i].radius;
    judge({time_s_, y / r, x / r, (r - 1) * e.amplitude_v});
  }
}

/// Second differences of the distance see a spike and little else: the ellipse moves slowly.
void Tracker::judge(const Pending &sample) {
  if (known_ < 2) {
    neighbours_[static_cast<std::size_t>(known_++)] = sample;
    return;
  }
  const Pending before = neighbours_[0], middle = neighbours_[1];
  const double bend = middle.distance_v - 0.5 * (before.distance_v + sample.distance_v);
  const double span = 0.5 * std::abs(before.distance_v - sample.distance_v);
  const bool spike = std::abs(bend) > kSpike * scatter_v_ + span;
  // Follows the median of |bend| by small steps, so that spikes cannot lift it much.
  const double step = 0.02 * scatter_v_;
  scatter_v_ += std::abs(bend) > scatter_v_ ? step : -step;
  scatter_v_ = std::max(scatter_v_, 1e-6 * amplitude_v_);
  neighbours_ = {middle, sample};
  if (!spike)
    learn(middle);
}

void Tracker::learn(const Pending &s) {
  const bool was_still = window_.stands_still();
  const auto turn = window_.add(s.time_s, s.sin_psi, s.cos_psi, s.distance_v, amplitude_v_);
  if (window_.stands_still() && !was_still)
    for (TrendFilter &t : trend_)
      t.hold(s.time_s);
  if (turn)
    accept(*turn);
}

void Tracker::accept(const TurnEstimate &turn) {
  if (turn.unexplained_rms_v > kMaxUnexplained * amplitude_v_)
    return;
  // A sensor's own distortion is the same in every turn: what fits far worse than the turns before
  // holds a fault. Each refusal loosens this, so that a lasting change is believed after a while.
  if (usual_unexplained_v_ > 0 && turn.unexplained_rms_v > 3 * usual_unexplained_v_) {
    usual_unexplained_v_ *= 1.2;
    return;
  }
  const double weight = usual_unexplained_v_ > 0 ? 0.1 : 1.0;
  usual_unexplained_v_ += weight * (turn.unexplained_rms_v - usual_unexplained_v_);
  for (const auto i : {kCentreSin, kCentreCos})
    if (std::abs(turn.change[i]) > trend_[i].believable(turn.time_s, turn.error[i]))
      return;
  const double horizon = kHorizon * turn.duration_s;
  const double before_sin = trend_[kCentreSin].rate(), before_cos = trend_[kCentreCos].rate();
  for (std::size_t i = 0; i < kEllipseSize; ++i) {
    const bool wanted = i == kCentreSin || i == kCentreCos ||
                        (i == kDelta ? options_.track_phase : options_.track_amplitude);
    if (wanted)
      trend_[i].update(turn.time_s, turn.change[i], turn.error[i], horizon);
  }
  // After update() the rate has moved; what the window measured is relative to the one before.
  trend_[kCentreSin].update_rate(turn.rate_sin + before_sin - trend_[kCentreSin].rate(),
                                 turn.rate_sin_error);
  trend_[kCentreCos].update_rate(turn.rate_cos + before_cos - trend_[kCentreCos].rate(),
                                 turn.rate_cos_error);
}

Model Tracker::model() const {
  Model m = model_;
  m.baseline.offset_sin_v += trend_[kCentreSin].at(time_s_);
  m.baseline.offset_cos_v += trend_[kCentreCos].at(time_s_);
  const EllipseParameters e = in_force(time_s_, m.vtemp_reference_v);
  if (options_.track_amplitude) {
    m.baseline.amplitude_v = e.amplitude_v;
    set_effect(m, "amplitude-mismatch", e.k);
  }
  if (options_.track_phase)
    set_effect(m, "quadrature-error", e.delta_rad * kDegPerRad);
  m.baseline_std_error = {0, 0, 0, 0};
  m.provenance.method = "dynamic";
  return m;
}

} // namespace ada

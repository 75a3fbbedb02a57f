// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/dual.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "base/angle.h"
#include "base/error.h"
#include "calibration/single.h"

namespace ada {

namespace {

/// A change of amplitude is modelled when it stands this many standard errors above zero.
constexpr double kSignificantChange = 5.0;

struct Known {
  double value, error;
};

/// Mean with weights 1/variance. A method that gives no error (0) takes equal weights.
Known pooled(Known a, Known b) {
  if (!(a.error > 0) || !(b.error > 0))
    return {0.5 * (a.value + b.value), 0.0};
  const double wa = 1 / (a.error * a.error), wb = 1 / (b.error * b.error);
  return {(wa * a.value + wb * b.value) / (wa + wb), 1 / std::sqrt(wa + wb)};
}

Known slope(Known a, Known b, double span) {
  return {(b.value - a.value) / span, std::hypot(a.error, b.error) / span};
}

Known parameter(const PairEstimate &e, EllipseIndex i) {
  const EllipseParameters &v = e.value;
  const double values[kEllipseSize] = {v.amplitude_v, v.k, v.delta_rad, v.centre_sin_v,
                                       v.centre_cos_v};
  return {values[i], e.std_error[i]};
}

PairEstimate estimate_named(const Recording &recording, CalibrationMethod method,
                            const char *name) {
  try {
    PairEstimate e = estimate_pair(RecordingToFit(recording), method);
    refuse_implausible(e, recording.meta());
    if (!e.vtemp_mean_v)
      throw Error(ADA4571_ERROR_UNUSABLE_DATA, "it has no VTEMP");
    return e;
  } catch (const Error &e) {
    throw Error(e.status(), std::string("the ") + name + " capture: " + e.what());
  }
}

void refuse_strangers(const Recording &cold, const Recording &hot) {
  if (cold.meta().periods_per_turn != hot.meta().periods_per_turn)
    throw Error(ADA4571_ERROR_UNUSABLE_DATA,
                "the two captures differ in periods_per_turn: not the same sensor");
  if (!cold.meta().serial.empty() && !hot.meta().serial.empty() &&
      cold.meta().serial != hot.meta().serial)
    throw Error(ADA4571_ERROR_UNUSABLE_DATA, "the two captures are of different sensors, '" +
                                                 cold.meta().serial + "' and '" +
                                                 hot.meta().serial + "'");
  if (cold.meta().supply_v != hot.meta().supply_v)
    throw Error(ADA4571_ERROR_UNUSABLE_DATA,
                "the two captures differ in supply_v: the same supply is needed at both "
                "temperatures");
  if (cold.meta().gain_control && hot.meta().gain_control &&
      *cold.meta().gain_control != *hot.meta().gain_control)
    throw Error(ADA4571_ERROR_UNUSABLE_DATA,
                "gain control is on in one capture and off in the other");
}

double span_of(const PairEstimate &cold, const PairEstimate &hot, double supply_v) {
  const double span = *hot.vtemp_mean_v - *cold.vtemp_mean_v;
  if (!(span >= kMinVtempSpan * supply_v)) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "the two temperatures are too close: VTEMP differs by %.0f mV, at least %.0f mV "
                  "are needed for a slope",
                  span * 1e3, kMinVtempSpan * supply_v * 1e3);
    throw Error(ADA4571_ERROR_UNUSABLE_DATA, text);
  }
  return span;
}

} // namespace

Model calibrate_dual(const Recording &cold, const Recording &hot, CalibrationMethod method) {
  refuse_strangers(cold, hot);
  PairEstimate a = estimate_named(cold, method, "cold");
  PairEstimate b = estimate_named(hot, method, "hot");
  const bool exchanged = *b.vtemp_mean_v < *a.vtemp_mean_v;
  if (exchanged)
    std::swap(a, b);
  const double span = span_of(a, b, cold.meta().supply_v);

  // At the middle of the two temperatures the lines are known best, and level and slope are
  // nearly uncorrelated.
  const auto middle = [&](EllipseIndex i) {
    const Known x = parameter(a, i), y = parameter(b, i);
    return Known{0.5 * (x.value + y.value), 0.5 * std::hypot(x.error, y.error)};
  };
  PairEstimate both;
  both.has_mismatch = a.has_mismatch || b.has_mismatch;
  both.has_quadrature = a.has_quadrature || b.has_quadrature;
  const Known amplitude = middle(kAmplitude), cs = middle(kCentreSin), cc = middle(kCentreCos);
  const Known k = pooled(parameter(a, kMismatch), parameter(b, kMismatch));
  const Known delta = pooled(parameter(a, kDelta), parameter(b, kDelta));
  both.value = {amplitude.value, k.value, delta.value, cs.value, cc.value};
  both.std_error = {amplitude.error, k.error, delta.error, cs.error, cc.error};
  both.noise_rms_v = std::sqrt(0.5 * (std::pow(a.noise_rms_v, 2) + std::pow(b.noise_rms_v, 2)));
  both.residual_rms_v =
      std::sqrt(0.5 * (std::pow(a.residual_rms_v, 2) + std::pow(b.residual_rms_v, 2)));
  if (a.heldout_rms_v > 0 && b.heldout_rms_v > 0)
    both.heldout_rms_v =
        std::sqrt(0.5 * (std::pow(a.heldout_rms_v, 2) + std::pow(b.heldout_rms_v, 2)));
  both.vtemp_mean_v = 0.5 * (*a.vtemp_mean_v + *b.vtemp_mean_v);
  both.vtemp_min_v = std::min(*a.vtemp_min_v, *b.vtemp_min_v);
  both.vtemp_max_v = std::max(*a.vtemp_max_v, *b.vtemp_max_v);

  Model model =
      model_of(both, cold.meta(), cold.identity(), std::string("dual ") + method_name(method));
  model.provenance.capture_identity =
      exchanged ? hot.identity() + " " + cold.identity() : cold.identity() + " " + hot.identity();
  const Known tc_sin = slope(parameter(a, kCentreSin), parameter(b, kCentreSin), span);
  const Known tc_cos = slope(parameter(a, kCentreCos), parameter(b, kCentreCos), span);
  model.effects.push_back(effect_instance("offset-temperature-drift", {tc_sin.value, tc_cos.value},
                                          {tc_sin.error, tc_cos.error}));
  Known tc = slope(parameter(a, kAmplitude), parameter(b, kAmplitude), span);
  tc = {tc.value / amplitude.value, tc.error / amplitude.value};
  if (std::abs(tc.value) > kSignificantChange * tc.error)
    model.effects.push_back(effect_instance("amplitude-temperature-drift", {tc.value}, {tc.error}));
  return possible(std::move(model));
}

Model calibrate_dual(const Capture &cold, const Capture &hot, CalibrationMethod method) {
  return calibrate_dual(*recording_of(cold), *recording_of(hot), method);
}

} // namespace ada

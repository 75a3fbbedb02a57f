// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/pair_estimate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/angle.h"
#include "base/error.h"
#include "base/robust.h"
#include "calibration/extrema_method.h"
#include "calibration/guards.h"
#include "calibration/mean_method.h"

namespace ada {

namespace {

/// Least arc for a fit: on less, the smallest distortion of the circle moves its centre by more
/// than the arc is long.
constexpr double kMinCoverageDeg = 90.0;
/// Angle errors (mechanical, rms over the turn) that noise alone leaves in the calibration:
/// up to the first one, or on this much of the circle, mismatch and quadrature are fitted without
/// asking; beyond the second one the capture is refused.
constexpr double kGoodErrorDeg = 0.01;
constexpr double kGoodCoverageDeg = 270.0;
constexpr double kMaxErrorDeg = 0.1;
/// Likelihood ratio that mismatch and quadrature error must reach on a short arc: 1 % chance.
constexpr double kWorthwhile = 9.21;

double error_deg(const EllipseFit &fit, int periods) {
  return fit.predicted_error_rad() / periods * kDegPerRad;
}

/// Whether two more parameters explain the data better than chance would.
bool ellipse_is_worthwhile(const EllipseFit &circle, const EllipseFit &ellipse) {
  const double n = static_cast<double>(std::min(circle.used, ellipse.used));
  return n * 2 * std::log(circle.residual_rms_v / ellipse.residual_rms_v) > kWorthwhile;
}

/// The ellipse where the data carry it; on a short arc the circle, unless the data contradict it.
EllipseFit fit_with_what_the_data_carry(const Capture &capture, bool &circle_only) {
  circle_only = false;
  const int p = capture.meta.periods_per_turn;
  EllipseFit circle = fit_ellipse(capture.vsin_v, capture.vcos_v, {.circle = true});
  if (circle.coverage_deg < kMinCoverageDeg) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "the capture covers %.0f electrical degrees (%.0f mechanical), a fit needs %.0f: "
                  "turn the magnet further",
                  circle.coverage_deg, circle.coverage_deg / p, kMinCoverageDeg);
    throw Error(ADA4571_ERROR_UNUSABLE_DATA, text);
  }
  std::optional<EllipseFit> ellipse;
  try {
    ellipse = fit_ellipse(capture.vsin_v, capture.vcos_v, {});
  } catch (const Error &) {
    // On a short arc the five may have no minimum; the circle stands.
  }
  if (ellipse &&
      (error_deg(*ellipse, p) <= kGoodErrorDeg || ellipse->coverage_deg >= kGoodCoverageDeg))
    return *std::move(ellipse);
  if (ellipse && ellipse_is_worthwhile(circle, *ellipse))
    return *std::move(ellipse);
  circle_only = true;
  return circle;
}

void refuse_uncertain(const EllipseFit &fit, int periods) {
  const double error = error_deg(fit, periods);
  // A distortion that is no ellipse makes the fit uncertain by about as much as it bends the
  // angle by itself; that is not for this guard to refuse.
  const double distortion = fit.structure_rms_v / fit.value.amplitude_v / periods * kDegPerRad;
  if (error <= kMaxErrorDeg + distortion)
    return;
  char text[200];
  std::snprintf(
      text, sizeof text,
      "noise leaves the calibration uncertain by %.2g degrees rms, more than %.2g: capture "
      "more of the turn, or longer",
      error, kMaxErrorDeg);
  throw Error(ADA4571_ERROR_UNUSABLE_DATA, text);
}

/// A spike of VTEMP tells nothing of the temperature.
void describe_temperature(const Capture &capture, PairEstimate &estimate) {
  const Reach believed = fence(capture.vtemp_v);
  double sum = 0, n = 0, low = INFINITY, high = -INFINITY;
  for (const double v : capture.vtemp_v)
    if (believed.holds(v)) {
      sum += v;
      n += 1;
      low = std::min(low, v);
      high = std::max(high, v);
    }
  if (n == 0)
    return;
  estimate.vtemp_mean_v = sum / n;
  estimate.vtemp_min_v = low;
  estimate.vtemp_max_v = high;
}

} // namespace

const char *method_name(CalibrationMethod method) {
  switch (method) {
  case CalibrationMethod::fit:
    return "fit";
  case CalibrationMethod::mean:
    return "mean";
  case CalibrationMethod::extrema:
    return "extrema";
  }
  return "";
}

PairEstimate estimate_pair(const Capture &capture, CalibrationMethod method) {
  refuse_dead_channels(capture);
  bool circle_only = false;
  const EllipseFit fit = fit_with_what_the_data_carry(capture, circle_only);
  refuse(why_no_circle(fit));
  refuse(why_clipped(capture, fit));
  refuse_scattered(capture, fit);

  PairEstimate estimate;
  estimate.residual_rms_v = fit.residual_rms_v;
  estimate.noise_rms_v = std::sqrt(std::max(
      fit.residual_rms_v * fit.residual_rms_v - fit.structure_rms_v * fit.structure_rms_v, 0.0));
  switch (method) {
  case CalibrationMethod::fit:
    refuse_uncertain(fit, capture.meta.periods_per_turn);
    estimate.value = fit.value;
    for (std::size_t i = 0; i < kEllipseSize; ++i)
      estimate.std_error[i] = fit.std_error(static_cast<EllipseIndex>(i));
    estimate.has_mismatch = estimate.has_quadrature = !circle_only;
    break;
  case CalibrationMethod::mean:
    estimate_by_mean(capture, fit, estimate);
    break;
  case CalibrationMethod::extrema:
    estimate_by_extrema(capture, fit, estimate);
    break;
  }
  describe_temperature(capture, estimate);
  return estimate;
}

} // namespace ada

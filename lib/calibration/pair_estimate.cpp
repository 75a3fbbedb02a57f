// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/pair_estimate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/angle.h"
#include "base/error.h"
#include "base/parallel.h"
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

/// Whether no arc could have been taken for an ellipse: it is so near to a circle, or so wide. A
/// flat one may go to and fro along an arc, whose noise is on both sides of it. Not where its sides
/// are farther apart than three standard deviations on either. A shaft that dithers on an arc may
/// draw such an ellipse as well, with a lag between the channels: at the rim of its circle, and far
/// from the middle of the supply.
bool is_no_arc(const EllipseFit &fit, double supply_v) {
  constexpr double kMismatch = 0.5, kQuadratureRad = 20 * kRadPerDeg, kClearOfNoise = 6.0;
  const EllipseParameters &e = fit.value;
  if (std::abs(e.k) < kMismatch && std::abs(e.delta_rad) < kQuadratureRad)
    return true;
  // Of the signals a sin(psi + delta / 2), b cos(psi - delta / 2): with a and b the product and the
  // sum of squares of the two half axes are a b |cos delta| and a^2 + b^2.
  const double a = e.amplitude_v * (1.0 + 0.5 * e.k), b = e.amplitude_v * (1.0 - 0.5 * e.k);
  const double squares = a * a + b * b, product = std::abs(a * b * std::cos(e.delta_rad));
  const double minor2 =
      0.5 * (squares - std::sqrt(std::max(0.0, squares * squares - 4.0 * product * product)));
  const double off_v = std::hypot(e.centre_sin_v - 0.5 * supply_v, e.centre_cos_v - 0.5 * supply_v);
  return std::sqrt(minor2) > kClearOfNoise * fit.residual_rms_v && off_v * off_v < squares - minor2;
}

/// The ellipse where the data carry it; on a short arc the circle, unless the data contradict it.
EllipseFit fit_with_what_the_data_carry(const RecordingToFit &what, bool &circle_only) {
  circle_only = false;
  const int p = what.recording.meta().periods_per_turn;
  std::optional<EllipseFit> ellipse;
  try {
    ellipse = fit_ellipse(what, {});
  } catch (const Error &) {
    // On a short arc the five may have no minimum; the circle stands.
  }
  if (ellipse && is_no_arc(*ellipse, what.recording.meta().supply_v) &&
      ellipse->coverage_deg >= kGoodCoverageDeg)
    return *std::move(ellipse);
  // Which shows how much of the circle there is.
  EllipseFit circle = fit_ellipse_to_sample(what, {.circle = true});
  if (circle.coverage_deg < kMinCoverageDeg) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "the capture covers %.0f electrical degrees (%.0f mechanical), a fit needs %.0f: "
                  "turn the magnet further",
                  circle.coverage_deg, circle.coverage_deg / p, kMinCoverageDeg);
    throw Error(ADA4571_ERROR_UNUSABLE_DATA, text);
  }
  if (ellipse &&
      (error_deg(*ellipse, p) <= kGoodErrorDeg || ellipse->coverage_deg >= kGoodCoverageDeg))
    return *std::move(ellipse);
  if (what.is_long)
    circle = fit_ellipse(what, {.circle = true});
  if (ellipse && ellipse_is_worthwhile(circle, *ellipse))
    return *std::move(ellipse);
  circle_only = true;
  return circle;
}

void refuse_uncertain(const EllipseFit &fit, int periods, double most_deg) {
  const double error = error_deg(fit, periods);
  // A distortion that is no ellipse makes the fit uncertain by about as much as it bends the
  // angle by itself; that is not for this guard to refuse.
  const double distortion = fit.structure_rms_v / fit.value.amplitude_v / periods * kDegPerRad;
  if (error <= most_deg + distortion)
    return;
  char text[200];
  std::snprintf(
      text, sizeof text,
      "noise leaves the calibration uncertain by %.2g degrees rms, more than %.2g: capture "
      "more of the turn, or longer",
      error, most_deg);
  throw Error(ADA4571_ERROR_UNUSABLE_DATA, text);
}

struct Temperature {
  Block block;
  double sum = 0, n = 0, low = INFINITY, high = -INFINITY;
};

/// A spike of VTEMP tells nothing of the temperature.
void describe_temperature(const RecordingToFit &what, PairEstimate &estimate) {
  if (!what.recording.channels().vtemp)
    return;
  const Reach believed = fence(what.sample->vtemp_v);
  Temperature all;
  in_order<Temperature>(
      what.recording.blocks(),
      [&](std::size_t k, Temperature &t) {
        what.recording.read(k, kVtempColumn, t.block);
        t.sum = t.n = 0;
        t.low = INFINITY;
        t.high = -INFINITY;
        for (const double v : t.block.vtemp_v)
          if (believed.holds(v)) {
            t.sum += v;
            t.n += 1;
            t.low = std::min(t.low, v);
            t.high = std::max(t.high, v);
          }
      },
      [&](std::size_t, const Temperature &t) {
        all.sum += t.sum;
        all.n += t.n;
        all.low = std::min(all.low, t.low);
        all.high = std::max(all.high, t.high);
      });
  if (all.n == 0)
    return;
  estimate.vtemp_mean_v = all.sum / all.n;
  estimate.vtemp_min_v = all.low;
  estimate.vtemp_max_v = all.high;
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

PairEstimate estimate_pair(const RecordingToFit &what, CalibrationMethod method, double most_deg) {
  if (what.is_long && method != CalibrationMethod::fit) // those need the path of the angle
    return estimate_pair(RecordingToFit(what.recording, true), method, most_deg);
  const Capture &capture = *what.sample;
  refuse_dead_channels(capture);
  if (!what.is_long) // stretches do not show it; but then too many samples lie off the ellipse
    refuse_stuck_stretches(capture);
  bool circle_only = false;
  const EllipseFit fit = fit_with_what_the_data_carry(what, circle_only);
  refuse(why_no_circle(fit));
  refuse(why_clipped(capture, fit));
  refuse_scattered(capture, fit);

  PairEstimate estimate;
  estimate.residual_rms_v = fit.residual_rms_v;
  estimate.noise_rms_v = std::sqrt(std::max(
      fit.residual_rms_v * fit.residual_rms_v - fit.structure_rms_v * fit.structure_rms_v, 0.0));
  switch (method) {
  case CalibrationMethod::fit:
    refuse_uncertain(fit, capture.meta.periods_per_turn, most_deg);
    estimate.heldout_rms_v = fit.heldout_rms_v;
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
  describe_temperature(what, estimate);
  return estimate;
}

PairEstimate estimate_pair(const Capture &capture, CalibrationMethod method) {
  const auto recording = recording_of(capture);
  return estimate_pair(RecordingToFit(*recording), method);
}

} // namespace ada

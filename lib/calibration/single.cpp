// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/single.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

#include <fmt/format.h>

#include "base/angle.h"
#include "base/error.h"
#include "calibration/guards.h"
#include "model/effect.h"
#include "model/effect_text.h"
#include "model/model_file.h"

namespace ada {

namespace {

std::string now_utc() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

/// Of the supply: an output whose middle lies farther from half of it has no tenth left on one
/// side.
constexpr double kMostOffset = 0.4;

} // namespace

EffectInstance effect_instance(std::string_view id, std::vector<double> values,
                               std::vector<double> std_errors) {
  const Effect *effect = find_effect(id);
  const std::size_t given = values.size();
  if (effect != nullptr) {
    const auto &parameters = effect_info(*effect).parameters;
    while (values.size() < parameters.size() && may_be_absent(parameters[values.size()]))
      values.push_back(std::nan(""));
  }
  if (effect == nullptr || effect_info(*effect).parameters.size() != values.size())
    throw Error(ADA4571_ERROR_INTERNAL, "the catalogue has no effect '" + std::string(id) +
                                            "' with " + std::to_string(given) + " parameters");
  return {effect, std::move(values), std::move(std_errors)};
}

Model model_of(const PairEstimate &estimate, const CaptureMetadata &meta,
               const std::string &identity, const std::string &method) {
  const EllipseParameters &e = estimate.value;
  const auto &se = estimate.std_error;
  Model model;
  model.periods_per_turn = meta.periods_per_turn;
  model.supply_v = meta.supply_v;
  model.baseline.amplitude_v = e.amplitude_v;
  model.baseline.offset_sin_v = e.centre_sin_v - 0.5 * model.supply_v;
  model.baseline.offset_cos_v = e.centre_cos_v - 0.5 * model.supply_v;
  model.baseline_std_error = {se[kAmplitude], se[kCentreSin], se[kCentreCos], 0.0};
  model.vtemp_reference_v = estimate.vtemp_mean_v.value_or(0.0);
  if (estimate.noise_rms_v > 0)
    model.noise_rms_v = estimate.noise_rms_v;
  if (estimate.has_mismatch)
    model.effects.push_back(effect_instance("amplitude-mismatch", {e.k}, {se[kMismatch]}));
  if (estimate.has_quadrature)
    model.effects.push_back(
        effect_instance("quadrature-error", {e.delta_rad * kDegPerRad}, {se[kDelta] * kDegPerRad}));
  Provenance &from = model.provenance;
  from.serial = meta.serial;
  from.date = now_utc();
  from.method = method;
  from.capture_identity = identity;
  from.generator = "libada4571 " ADA4571_VERSION_STRING;
  from.vtemp_min_v = estimate.vtemp_min_v;
  from.vtemp_max_v = estimate.vtemp_max_v;
  from.gain_control = meta.gain_control;
  from.fit_residual_rms_v = estimate.residual_rms_v;
  if (estimate.heldout_rms_v > 0)
    from.heldout_residual_rms_v = estimate.heldout_rms_v;
  return model;
}

void refuse_implausible(const PairEstimate &estimate, const CaptureMetadata &meta) {
  const EllipseParameters &e = estimate.value;
  const double structure_v = std::sqrt(
      std::max(std::pow(estimate.residual_rms_v, 2) - std::pow(estimate.noise_rms_v, 2), 0.0));
  if (const double off = structure_v / e.amplitude_v; off > kRoundness)
    throw Error(ADA4571_ERROR_UNUSABLE_DATA,
                fmt::format("the samples lie on no circle: their curve leaves the best ellipse by "
                            "{:.2g} % of its radius (rms), as a triangle or a cut-off sine does",
                            100 * off));
  for (const auto &[name, centre_v] :
       {std::pair("VSIN", e.centre_sin_v), std::pair("VCOS", e.centre_cos_v)})
    if (std::abs(centre_v - 0.5 * meta.supply_v) > kMostOffset * meta.supply_v)
      throw Error(
          ADA4571_ERROR_UNUSABLE_DATA,
          fmt::format("the middle of {} is {:.3f} V where half of the stated supply is {:.3f} "
                      "V: supply_v or the scale is wrong",
                      name, centre_v, 0.5 * meta.supply_v));
}

Model possible(Model model) {
  try {
    check_model(model);
  } catch (const Error &e) {
    if (e.status() != ADA4571_ERROR_INVALID_ARGUMENT)
      throw;
    throw Error(ADA4571_ERROR_UNUSABLE_DATA,
                "the circle of the capture is no sensor's: " + std::string(e.what()) +
                    "; its supply_v or its scale is wrong");
  }
  return model;
}

Model calibrate_single(const RecordingToFit &what, CalibrationMethod method) {
  const PairEstimate estimate = estimate_pair(what, method);
  refuse_implausible(estimate, what.recording.meta());
  return possible(model_of(estimate, what.recording.meta(), what.recording.identity(),
                           std::string("single ") + method_name(method)));
}

Model calibrate_single(const Capture &capture, CalibrationMethod method) {
  const auto recording = recording_of(capture);
  return calibrate_single(RecordingToFit(*recording), method);
}

} // namespace ada

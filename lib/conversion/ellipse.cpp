// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "conversion/ellipse.h"

#include <algorithm>
#include <cmath>

#include "base/angle.h"
#include "base/error.h"
#include "model/effect.h"

namespace ada {

namespace {

/// Both channels right at once has no inverse; refused long before cos d reaches zero.
constexpr double kMinCosDelta = 0.05;

} // namespace

EllipseInverse invert(const EllipseParameters &e) {
  const double a_sin = e.amplitude_v * (1 + e.k / 2), a_cos = e.amplitude_v * (1 - e.k / 2);
  const double cos_d = std::cos(e.delta_rad);
  if (!(a_sin > 0) || !(a_cos > 0) || !(cos_d > kMinCosDelta))
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                "the calibration has no inverse: amplitude, mismatch or quadrature error is out of "
                "range");
  const double c = std::cos(e.delta_rad / 2) / cos_d, s = std::sin(e.delta_rad / 2) / cos_d;
  return {e.centre_sin_v, e.centre_cos_v, c / a_sin, -s / a_cos, -s / a_sin, c / a_cos};
}

EllipseInverse swap_channels(const EllipseInverse &i) {
  return {i.centre_cos_v, i.centre_sin_v, i.sin_from_cos,
          i.sin_from_sin, i.cos_from_cos, i.cos_from_sin};
}

EllipseInverse mirror_sin(const EllipseInverse &i, double supply_v) {
  EllipseInverse m = i;
  m.centre_sin_v = supply_v - i.centre_sin_v;
  m.sin_from_sin = -i.sin_from_sin;
  m.cos_from_sin = -i.cos_from_sin;
  return m;
}

EllipseInverse mirror_cos(const EllipseInverse &i, double supply_v) {
  return swap_channels(mirror_sin(swap_channels(i), supply_v));
}

std::string_view EllipseModel::beyond(const Model &model) {
  EllipseParts parts;
  for (const EffectInstance &e : model.effects) {
    const EffectInfo &info = effect_info(*e.effect);
    if (info.correctable && !e.effect->fold(e.values, parts))
      return info.id;
  }
  return model.remainder ? "periodic-remainder" : std::string_view();
}

EllipseModel::EllipseModel(const Model &model)
    : periods_(model.periods_per_turn), supply_v_(model.supply_v),
      zero_rad_(model.baseline.angle_zero_deg * kRadPerDeg),
      vtemp_reference_v_(model.vtemp_reference_v) {
  if (const std::string_view id = beyond(model); !id.empty())
    throw Error(ADA4571_ERROR_UNSUPPORTED,
                "the model holds '" + std::string(id) +
                    "', which goes beyond offsets, amplitudes and quadrature");
  for (const EffectInstance &e : model.effects)
    e.effect->fold(e.values, parts_);
  reference_.amplitude_v = model.baseline.amplitude_v;
  reference_.k = parts_.k;
  reference_.delta_rad = parts_.delta_rad;
  const Baseline last = correctable_part(model).baseline;
  reference_.centre_sin_v = 0.5 * supply_v_ + last.offset_sin_v;
  reference_.centre_cos_v = 0.5 * supply_v_ + last.offset_cos_v;
  invert(reference_); // refuses a model without an inverse here rather than at the first sample
}

EllipseParameters EllipseModel::parameters_at(double vtemp_v) const {
  EllipseParameters e = reference_;
  if (follows_temperature()) {
    const double dv = vtemp_v - vtemp_reference_v_;
    e.centre_sin_v += parts_.tc_sin * dv;
    e.centre_cos_v += parts_.tc_cos * dv;
    // A VTEMP far outside the sensor's range must not turn the ellipse inside out.
    e.amplitude_v *= std::max(1 + parts_.tc_amplitude * dv, 0.05);
  }
  return e;
}

EllipseInverse EllipseModel::wired(EllipseInverse i) const {
  // Recorded = inverted(swapped(sensor)): the wiring in the order in which a signal passes it.
  if (parts_.swapped)
    i = swap_channels(i);
  if (parts_.sin_inverted)
    i = mirror_sin(i, supply_v_);
  if (parts_.cos_inverted)
    i = mirror_cos(i, supply_v_);
  return i;
}

} // namespace ada

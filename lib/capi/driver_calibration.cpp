// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "capi/driver_calibration.h"

#include <cmath>

#include "base/error.h"
#include "model/effect.h"

namespace ada {

namespace {

constexpr const char *kMismatch = "amplitude-mismatch";

double nominal_amplitude(double supply_v) {
  return Baseline{}.amplitude_v * supply_v / Model{}.supply_v;
}

double mismatch_of(const Model &model) {
  for (const EffectInstance &effect : model.effects)
    if (effect.effect && effect_info(*effect.effect).id == kMismatch && !effect.values.empty())
      return effect.values.front();
  return 0.0;
}

double six_decimals(double value) {
  return std::round(value * 1e6) / 1e6;
}

DriverCalibration::Channel channel_of(const DriverCalibration::Channel &present, double offset_v,
                                      double amplitude_v, double nominal_v) {
  DriverCalibration::Channel out = present;
  if (out.bias)
    out.bias = std::round(-offset_v / present.volts_per_count) + 0.0; // + 0: no negative zero
  if (out.scale)
    out.scale = six_decimals(nominal_v / amplitude_v);
  return out;
}

double amplitude_of(const DriverCalibration::Channel &channel, double nominal_v) {
  const double scale = channel.scale.value_or(1.0);
  if (scale <= 0.0)
    throw Error(ADA4571_ERROR_FORMAT, "the driver's calibscale is not greater than 0");
  return nominal_v / scale;
}

} // namespace

DriverCalibration driver_calibration_of(const Model &model, const DriverCalibration &present,
                                        double supply_v) {
  const Model scaled = model.at_supply(supply_v);
  const Baseline &b = scaled.baseline;
  const double k = mismatch_of(scaled), nominal = nominal_amplitude(supply_v);
  if (!(b.amplitude_v > 0.0) || !(std::abs(k) < 1.0))
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "the model's amplitude makes no sense");
  return {channel_of(present.sin, b.offset_sin_v, b.amplitude_v * (1.0 + k / 2), nominal),
          channel_of(present.cos, b.offset_cos_v, b.amplitude_v * (1.0 - k / 2), nominal)};
}

Model model_of(const DriverCalibration &calibration, double supply_v, int periods_per_turn) {
  const DriverCalibration::Channel &sin = calibration.sin, &cos = calibration.cos;
  if (sin.bias.value_or(0.0) == 0.0 && cos.bias.value_or(0.0) == 0.0 &&
      sin.scale.value_or(1.0) == 1.0 && cos.scale.value_or(1.0) == 1.0)
    throw Error(ADA4571_ERROR_NOT_FOUND,
                "the driver holds no calibration: calibbias is 0 and calibscale is 1");
  const double nominal = nominal_amplitude(supply_v);
  const double a_sin = amplitude_of(sin, nominal), a_cos = amplitude_of(cos, nominal);
  Model model;
  model.supply_v = supply_v;
  model.periods_per_turn = periods_per_turn;
  model.baseline.amplitude_v = (a_sin + a_cos) / 2;
  model.baseline.offset_sin_v = -sin.bias.value_or(0.0) * sin.volts_per_count;
  model.baseline.offset_cos_v = -cos.bias.value_or(0.0) * cos.volts_per_count;
  model.provenance.method = "driver";
  const double k = (a_sin - a_cos) / model.baseline.amplitude_v;
  if (k != 0.0)
    model.effects.push_back({find_effect(kMismatch), {k}, {}});
  return model;
}

} // namespace ada

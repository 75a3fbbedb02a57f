// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "model/model.h"

#include <cmath>

#include "base/error.h"
#include "model/effect.h"

namespace ada {

namespace {

/// How a parameter of this unit follows the supply: VSIN, VCOS and VTEMP are fractions of VDD, so
/// volts grow with it and what is counted per volt of VTEMP shrinks.
double supply_factor(std::string_view unit, double ratio) {
  if (unit == "V")
    return ratio;
  if (unit == "1/V" || unit == "V/V^2")
    return 1.0 / ratio;
  return 1.0;
}

void scale(Baseline &b, double ratio) {
  b.amplitude_v *= ratio;
  b.offset_sin_v *= ratio;
  b.offset_cos_v *= ratio;
}

void scale(std::optional<double> &volts, double ratio) {
  if (volts)
    *volts *= ratio;
}

void scale(EffectInstance &instance, double ratio) {
  const auto parameters = instance.effect->info().parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double factor = supply_factor(parameters[i].unit, ratio);
    instance.values[i] *= factor;
    if (!instance.std_errors.empty())
      instance.std_errors[i] *= factor;
  }
}

} // namespace

Model Model::without(std::size_t effect) const {
  Model out = *this;
  out.effects.erase(out.effects.begin() + static_cast<std::ptrdiff_t>(effect));
  return out;
}

void Model::require_periods(int here, const std::string &name, const std::string &what) const {
  if (periods_per_turn != here)
    throw Error(ADA4571_ERROR_UNUSABLE_DATA,
                name + " is for periods_per_turn = " + std::to_string(periods_per_turn) + ", " +
                    what + " says " + std::to_string(here));
}

Model Model::at_supply(double volts) const {
  if (!(volts > 0) || !std::isfinite(volts))
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "the supply must be above 0 V");
  const double ratio = volts / supply_v;
  Model out = *this;
  out.supply_v = volts;
  scale(out.baseline, ratio);
  scale(out.baseline_std_error, ratio);
  out.vtemp_reference_v *= ratio;
  scale(out.vdd_reference_v, ratio);
  scale(out.noise_rms_v, ratio);
  for (EffectInstance &instance : out.effects)
    scale(instance, ratio);
  for (auto field : {&Provenance::vtemp_min_v, &Provenance::vtemp_max_v,
                     &Provenance::fit_residual_rms_v, &Provenance::heldout_residual_rms_v})
    scale(out.provenance.*field, ratio);
  return out;
}

Model correctable_part(const Model &model) {
  Model out = model;
  std::erase_if(out.effects, [&](const EffectInstance &e) {
    return e.effect->leaves_behind(e.values, out.baseline) || !e.effect->info().correctable;
  });
  return out;
}

} // namespace ada

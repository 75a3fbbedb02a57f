// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The table of effects, in physical order: an effect acts after those above it. A new effect is a
// file in effects/ and a row here.

#include <algorithm>
#include <string>
#include <vector>

#include "base/error.h"
#include "model/effect.h"

#define ADA4571_EFFECTS(X)                                                                         \
  X(angle_slip)                                                                                    \
  X(rotation_nonuniformity)                                                                        \
  X(sensor_off_axis)                                                                               \
  X(field_direction_error)                                                                         \
  X(stray_field)                                                                                   \
  X(hysteresis)                                                                                    \
  X(weak_field)                                                                                    \
  X(temperature_lag)                                                                               \
  X(amplitude_temperature_drift)                                                                   \
  X(quadrature_error)                                                                              \
  X(amplitude_mismatch)                                                                            \
  X(offset_temperature_drift)                                                                      \
  X(offset_temperature_curvature)                                                                  \
  X(offset_step)                                                                                   \
  X(offset_wander)                                                                                 \
  X(gain_wander)                                                                                   \
  X(quadratic_nonlinearity)                                                                        \
  X(cubic_nonlinearity)                                                                            \
  X(harmonic_distortion)                                                                           \
  X(supply_variation)                                                                              \
  X(clipping)                                                                                      \
  X(low_pass_rolloff)                                                                              \
  X(propagation_delay)                                                                             \
  X(channel_skew)                                                                                  \
  X(periodic_interference)                                                                         \
  X(multiplexer_memory)                                                                            \
  X(timing_jitter)                                                                                 \
  X(angle_noise)                                                                                   \
  X(amplitude_noise)                                                                               \
  X(flicker_noise)                                                                                 \
  X(impulse_noise)                                                                                 \
  X(excess_noise)                                                                                  \
  X(stuck_channel)                                                                                 \
  X(channel_swap)                                                                                  \
  X(channel_inverted)                                                                              \
  X(reference_delay)                                                                               \
  X(reference_eccentricity)                                                                        \
  X(reference_harmonic)                                                                            \
  X(reference_resolution)                                                                          \
  X(sample_loss)

namespace ada {

#define X(name) const Effect &name();
ADA4571_EFFECTS(X)
#undef X

std::span<const Effect *const> catalogue() {
  static const Effect *const table[] = {
#define X(name) &name(),
      ADA4571_EFFECTS(X)
#undef X
  };
  return table;
}

std::vector<EffectInstance> in_physical_order(std::vector<EffectInstance> effects) {
  const auto place = [](const EffectInstance &e) {
    return std::find(catalogue().begin(), catalogue().end(), e.effect) - catalogue().begin();
  };
  std::stable_sort(effects.begin(), effects.end(),
                   [&](const auto &a, const auto &b) { return place(a) < place(b); });
  return effects;
}

const Effect *find_effect(std::string_view id) {
  for (const Effect *effect : catalogue())
    if (effect->info().id == id)
      return effect;
  return nullptr;
}

namespace {

template <class Is>
const Effect &only_effect(Is is) {
  const Effect *found = nullptr;
  for (const Effect *effect : catalogue())
    if (is(effect->info())) {
      if (found)
        throw Error(ADA4571_ERROR_STATE, "the catalogue has two effects of one kind: " + std::string(found->info().id) +
                    " and " + std::string(effect->info().id));
      found = effect;
    }
  if (!found)
    throw Error(ADA4571_ERROR_STATE, "the catalogue has no effect of a kind that is needed");
  return *found;
}

} // namespace

const Effect &the_effect(bool (*is)(const EffectInfo &)) {
  return only_effect(is);
}

const Effect &the_effect_that_spoils(Spoils what) {
  return only_effect([what](const EffectInfo &e) { return e.spoils == what; });
}

} // namespace ada

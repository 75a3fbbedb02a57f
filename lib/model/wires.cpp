// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "model/wires.h"

#include <algorithm>
#include <memory>

#include "model/effect.h"
#include "model/wave.h"

namespace ada {

namespace {

/// Wires are what is recorded otherwise than it is, with nothing to be measured about it: a channel
/// is chosen at most.
bool is_of_wires(const EffectInfo &info) {
  return info.stage == Stage::record && info.evidence == Evidence::screening &&
         info.spoils == Spoils::nothing &&
         std::all_of(info.parameters.begin(), info.parameters.end(),
                     [](const ParameterInfo &p) { return p.role == Role::chosen; });
}

} // namespace

Wires wires_of(const Model &model) {
  if (std::none_of(model.effects.begin(), model.effects.end(),
                   [](const EffectInstance &e) { return is_of_wires(e.effect->info()); }))
    return {};
  const double mid_v = 0.5 * model.supply_v;
  const auto wave = std::make_unique<Wave>();
  wave->n = 2;
  wave->mid_v = mid_v;
  for (std::size_t i = 0; i < wave->n; ++i) {
    wave->s[i] = mid_v + (i == 0 ? 1.0 : 0.0);
    wave->c[i] = mid_v + (i == 1 ? 1.0 : 0.0);
  }
  for (const EffectInstance &e : in_physical_order(model.effects))
    if (is_of_wires(e.effect->info()))
      e.effect->apply(e.values, *wave);
  return {wave->s[0] - mid_v, wave->s[1] - mid_v, wave->c[0] - mid_v, wave->c[1] - mid_v};
}

std::array<double, 2> recorded_centre_v(const Model &model) {
  const Wires w = wires_of(model);
  const double mid_v = 0.5 * model.supply_v, sin_v = model.baseline.offset_sin_v,
               cos_v = model.baseline.offset_cos_v;
  return {mid_v + w.sin_of_sin * sin_v + w.sin_of_cos * cos_v,
          mid_v + w.cos_of_sin * sin_v + w.cos_of_cos * cos_v};
}

} // namespace ada

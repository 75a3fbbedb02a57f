// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/wiring.h"

#include <algorithm>
#include <memory>
#include <type_traits>

namespace ada {

namespace {

/// What the wires make of a volt in one channel: rows are VSIN and VCOS as recorded.
struct Wires {
  double sin_of_sin = 1.0, sin_of_cos = 0.0, cos_of_sin = 0.0, cos_of_cos = 1.0;
  bool plain() const { return sin_of_sin == 1.0 && cos_of_cos == 1.0; }
};

/// Wires are what is recorded otherwise than it is, with nothing to be measured about it: a channel
/// is chosen at most.
bool is_of_wires(const EffectInfo &info) {
  return info.stage == Stage::record && info.evidence == Evidence::screening &&
         info.spoils == Spoils::nothing &&
         std::all_of(info.parameters.begin(), info.parameters.end(),
                     [](const ParameterInfo &p) { return p.role == Role::chosen; });
}

Wires wires_of(const Model &model, double mid_v) {
  if (std::none_of(model.effects.begin(), model.effects.end(),
                   [](const EffectInstance &e) { return is_of_wires(e.effect->info()); }))
    return {};
  const auto wave = std::make_unique<Wave>();
  wave->n = 2;
  wave->mid_v = mid_v;
  for (std::size_t i = 0; i < wave->n; ++i) {
    wave->s[i] = mid_v + (i == 0 ? 1.0 : 0.0);
    wave->c[i] = mid_v + (i == 1 ? 1.0 : 0.0);
  }
  for (const EffectInstance &e : model.effects)
    if (is_of_wires(e.effect->info()))
      e.effect->apply(e.values, *wave);
  return {wave->s[0] - mid_v, wave->s[1] - mid_v, wave->c[0] - mid_v, wave->c[1] - mid_v};
}

} // namespace

BeforeWires::BeforeWires(const Model &model, const Residual &recorded) : view_(recorded) {
  const double mid_v = 0.5 * recorded.supply_v;
  const Wires w = wires_of(model, mid_v);
  if (w.plain())
    return;
  // They exchange and invert: the inverse is the transpose.
  const auto undo = [&w](auto sin, auto cos, double about, auto &to_sin, auto &to_cos) {
    using Value = std::remove_cvref_t<decltype(to_sin[0])>;
    for (std::size_t i = 0; i < sin.size(); ++i) {
      const double s = sin[i] - about, c = cos[i] - about;
      to_sin.push_back(static_cast<Value>(about + w.sin_of_sin * s + w.cos_of_sin * c));
      to_cos.push_back(static_cast<Value>(about + w.sin_of_cos * s + w.cos_of_cos * c));
    }
  };
  undo(recorded.sin_v, recorded.cos_v, 0.0, columns_[0], columns_[1]);
  undo(recorded.model_sin_v, recorded.model_cos_v, mid_v, columns_[2], columns_[3]);
  undo(recorded.read_sin_v, recorded.read_cos_v, mid_v, read_[0], read_[1]);
  const std::array centre_sin{recorded.centre_sin_v}, centre_cos{recorded.centre_cos_v};
  std::vector<double> sin, cos;
  undo(centre_sin, centre_cos, mid_v, sin, cos);
  view_.centre_sin_v = sin[0];
  view_.centre_cos_v = cos[0];
  view_.sin_v = columns_[0];
  view_.cos_v = columns_[1];
  view_.model_sin_v = columns_[2];
  view_.model_cos_v = columns_[3];
  view_.read_sin_v = read_[0];
  view_.read_cos_v = read_[1];
}

} // namespace ada

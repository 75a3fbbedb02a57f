// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// VDD moves and the converter's reference does not: both outputs scale with VDD(t)/mean. The wave
// form comes from the VDD channel; `rms_fraction` is its rms. What a filter or a delay lets through
// left the sensor earlier: VDD then, by its first two derivatives.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"rms_fraction", "1", 0.01, -1.0, 1.0, Role::fitted, 1e-4}};

constexpr EffectInfo kInfo{.id = "supply-variation",
                           .cause = "The supply moves while the converter's reference does not, "
                                    "and both outputs follow the supply.",
                           .stage = Stage::chain,
                           .parameters = kParameters,
                           .correctable = true,
                           .recorded = true,
                           .axis = "supply",
                           .pattern = Pattern::gain,
                           .character = Character::recorded};

class SupplyVariation final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    if (w.at.supply == nullptr)
      return;
    const double d = w.delay_s;
    for (std::size_t i = 0; i < w.n; ++i) {
      double then = static_cast<double>(w.at.supply[i]);
      if (d != 0.0 && w.at.supply_rate)
        then -= d * static_cast<double>(w.at.supply_rate[i]);
      if (d != 0.0 && w.at.supply_bend)
        then += 0.5 * d * d * static_cast<double>(w.at.supply_bend[i]);
      const double more = v[0] * then;
      w.s[i] += more * (w.s[i] + w.mid_v);
      w.c[i] += more * (w.c[i] + w.mid_v);
    }
  }
  std::string invisible(const Residual &r) const override {
    return r.has_supply ? "" : "no VDD channel: its wave form is not known";
  }
};

} // namespace

const Effect &supply_variation() {
  static const SupplyVariation effect;
  return effect;
}

} // namespace ada

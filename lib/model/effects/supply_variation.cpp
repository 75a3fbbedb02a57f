// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// VDD moves and the converter's reference does not: both outputs scale with VDD(t)/mean. The wave
// form comes from the VDD channel; `rms_fraction` is its rms.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"rms_fraction", "1", 0.01, -1.0, 1.0, Role::fitted, 1e-4}};

constexpr EffectInfo kInfo{.id = "supply-variation",
                           .cause = "The supply moves while the converter's reference does not, "
                                    "and both outputs follow the supply.",
                           .stage = Stage::converter,
                           .parameters = kParameters,
                           .correctable = true,
                           .recorded = true};

class SupplyVariation final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    if (w.at.supply == nullptr)
      return;
    for (std::size_t i = 0; i < w.n; ++i) {
      const double gain = 1.0 + v[0] * w.at.supply[i];
      w.s[i] *= gain;
      w.c[i] *= gain;
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

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Offsets move with VTEMP; the slope at the model's reference VTEMP.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 2> kParameters{
    ParameterInfo{"tc_sin", "V/V", 0.02, -2.0, 2.0, Role::fitted, 1e-3},
    ParameterInfo{"tc_cos", "V/V", -0.015, -2.0, 2.0, Role::fitted, 1e-3}};

constexpr EffectInfo kInfo{.id = "offset-temperature-drift",
                           .cause = "The offsets drift with temperature.",
                           .stage = Stage::chain,
                           .parameters = kParameters,
                           .correctable = true,
                           .axis = "temperature",
                           .pattern = Pattern::offset,
                           .prior_rank = 1};

class OffsetTemperatureDrift final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  bool fold(Values v, EllipseParts &e) const override {
    e.tc_sin = v[0];
    e.tc_cos = v[1];
    return true;
  }
  void apply(Values v, Wave &w) const override {
    for (std::size_t i = 0; i < w.n; ++i)
      w.add_offset(i, v[0] * w.temp[i], v[1] * w.temp[i]);
  }
  std::string invisible(const Residual &r) const override { return r.why_no_temperature; }
};

} // namespace

const Effect &offset_temperature_drift() {
  static const OffsetTemperatureDrift effect;
  return effect;
}

} // namespace ada

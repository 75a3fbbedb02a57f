// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A second-order term of the offsets over VTEMP, about the model's reference VTEMP.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 2> kParameters{
    ParameterInfo{"c_sin", "V/V^2", 0.02, -10.0, 10.0, Role::fitted, 1e-3},
    ParameterInfo{"c_cos", "V/V^2", 0.02, -10.0, 10.0, Role::fitted, 1e-3}};

constexpr std::array<Separation, 1> kSeparations{
    {{"temperature-lag",
      "sweep the temperature up and down: a lag opens a loop, a curvature does not"}}};

constexpr EffectInfo kInfo{.id = "offset-temperature-curvature",
                           .cause = "The offsets bend over temperature, so a straight line through "
                                    "two temperatures leaves a remainder.",
                           .stage = Stage::chain,
                           .parameters = kParameters,
                           .correctable = true,
                           .separations = kSeparations,
                           .axis = "temperature",
                           .pattern = Pattern::offset};

class OffsetTemperatureCurvature final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    for (std::size_t i = 0; i < w.n; ++i) {
      const double u2 = w.temp[i] * w.temp[i];
      w.add_offset(i, v[0] * u2, v[1] * u2);
    }
  }
  std::string invisible(const Residual &r) const override { return r.why_no_temperature; }
};

} // namespace

const Effect &offset_temperature_curvature() {
  static const OffsetTemperatureCurvature effect;
  return effect;
}

} // namespace ada

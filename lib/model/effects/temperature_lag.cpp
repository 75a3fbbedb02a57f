// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// VTEMP follows the bridge with a first-order lag, tau dV/dt = V_bridge - V, so the bridge stands
// at V + tau dV/dt. Acts on what the temperature effects below it see.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"tau_s", "s", 10.0, 0.0, 10000.0, Role::fitted, 0.1}};

constexpr std::array<Separation, 1> kSeparations{
    {{"offset-temperature-curvature",
      "sweep the temperature up and down: a lag opens a loop, a curvature does not"}}};

constexpr EffectInfo kInfo{
    .id = "temperature-lag",
    .cause =
        "The temperature sensor follows the bridge late, so a correction by VTEMP comes late too.",
    .stage = Stage::bridge,
    .parameters = kParameters,
    .correctable = true,
    .separations = kSeparations,
    .axis = "temperature",
    .character = Character::dynamic};

class TemperatureLag final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    if (w.at.temp_rate == nullptr)
      return;
    for (std::size_t i = 0; i < w.n; ++i)
      w.temp[i] += v[0] * w.at.temp_rate[i];
  }
  std::string invisible(const Residual &r) const override { return r.why_no_temperature; }
};

} // namespace

const Effect &temperature_lag() {
  static const TemperatureLag effect;
  return effect;
}

} // namespace ada

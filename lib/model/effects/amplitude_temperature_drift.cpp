// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The amplitude moves with VTEMP, as it does with the gain control off: A (1 + tc u).

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"tc_amplitude", "1/V", -0.1, -5.0, 5.0, Role::fitted, 1e-3}};

constexpr EffectInfo kInfo{.id = "amplitude-temperature-drift",
                           .cause = "The amplitude changes with temperature.",
                           .stage = Stage::bridge,
                           .parameters = kParameters,
                           .correctable = true,
                           .axis = "temperature",
                           .pattern = Pattern::gain,
                           .prior_rank = 1};

class AmplitudeTemperatureDrift final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  bool fold(Values v, EllipseParts &e) const override {
    e.tc_amplitude = v[0];
    return true;
  }
  void apply(Values v, Wave &w) const override {
    for (std::size_t i = 0; i < w.n; ++i) {
      const double gain = 1.0 + v[0] * w.temp[i];
      w.c[i] *= gain;
      w.s[i] *= gain;
    }
  }
  std::string invisible(const Residual &r) const override { return r.why_no_temperature; }
};

} // namespace

const Effect &amplitude_temperature_drift() {
  static const AmplitudeTemperatureDrift effect;
  return effect;
}

} // namespace ada

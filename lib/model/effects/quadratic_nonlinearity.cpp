// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Even (bow) transfer error of the chain: each channel adds q2 A x^2, x = signal/A about
// mid-supply.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"q2", "1", 0.01, -0.3, 0.3, Role::fitted, 1e-4}};

constexpr EffectInfo kInfo{.id = "quadratic-nonlinearity",
                           .cause =
                               "The transfer of the signal chain is bent like a bow (even order).",
                           .stage = Stage::chain,
                           .parameters = kParameters,
                           .correctable = true};

class QuadraticNonlinearity final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    const double g = v[0] / w.amplitude_v;
    for (std::size_t i = 0; i < w.n; ++i) {
      w.s[i] += g * w.s[i] * w.s[i];
      w.c[i] += g * w.c[i] * w.c[i];
    }
  }
};

} // namespace

const Effect &quadratic_nonlinearity() {
  static const QuadraticNonlinearity effect;
  return effect;
}

} // namespace ada

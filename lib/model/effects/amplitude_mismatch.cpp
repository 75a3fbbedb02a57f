// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A_sin = A (1 + k/2), A_cos = A (1 - k/2): an ellipse with its axes on the channels.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"k", "1", 0.01, -1.9, 1.9, Role::fitted, 1e-4}};

constexpr std::array<Separation, 2> kSeparations{
    {{"harmonic-distortion", "record a reference and capture again: two amplitudes leave each "
                             "channel a sine, a harmonic does not"},
     {"clipping",
      "capture at another amplitude (gain control, supply): clipping keeps its level in volts"}}};

constexpr EffectInfo kInfo{.id = "amplitude-mismatch",
                           .cause = "The two channels have different amplitudes.",
                           .stage = Stage::bridge,
                           .parameters = kParameters,
                           .correctable = true,
                           .separations = kSeparations,
                           .prior_rank = 0,
                           .affine = true};

class AmplitudeMismatch final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  bool fold(Values v, EllipseParts &e) const override {
    e.k = v[0];
    return true;
  }
  void apply(Values v, Wave &w) const override {
    for (std::size_t i = 0; i < w.n; ++i) {
      w.s[i] *= 1.0 + 0.5 * v[0];
      w.c[i] *= 1.0 - 0.5 * v[0];
    }
  }
};

} // namespace

const Effect &amplitude_mismatch() {
  static const AmplitudeMismatch effect;
  return effect;
}

} // namespace ada

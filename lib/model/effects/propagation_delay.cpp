// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A pure common delay: both channels show the angle of tau earlier.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"tau_s", "s", 50e-6, 0.0, 1.0, Role::fitted, 1e-6}};

constexpr std::array<Separation, 4> kSeparations{
    {{"angle-slip",
      "go back to the first speed in the same capture: a delay comes back, a slip stays"},
     {"hysteresis", "capture a second speed: a delay grows with it, hysteresis does not"},
     {"low-pass-rolloff",
      "capture at a higher speed: a low pass also lowers the amplitude, a delay does not"},
     {"reference-delay",
      "use another reference, or measure the delay of the signal path by itself"}}};

constexpr EffectInfo kInfo{
    .id = "propagation-delay",
    .cause = "The signals arrive late by a fixed time, so the angle lags with the speed.",
    .stage = Stage::chain,
    .parameters = kParameters,
    .correctable = true,
    .separations = kSeparations,
    .axis = "speed",
    .pattern = Pattern::turn,
    .character = Character::dynamic,
    .prior_rank = 1};

class PropagationDelay final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void dynamics(Values v, Taps &taps) const override {
    const Tap delay{v[0], 1.0};
    taps.pass({&delay, 1});
  }
  std::string invisible(const Residual &r) const override {
    if (!r.has_reference)
      return "without a reference a delay has nothing to lag behind";
    return r.several_speeds || r.both_directions
               ? ""
               : "one speed in one direction: a delay is a part of the zero angle";
  }
};

} // namespace

const Effect &propagation_delay() {
  static const PropagationDelay effect;
  return effect;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Reference and signals are read at instants that scatter against each other: an angle noise that
// grows with speed.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{ParameterInfo{"rms_s", "s", 5e-6, 0.0, 1.0}};

constexpr std::array<Separation, 1> kSeparations{
    {{"angle-noise",
      "capture a second speed: a jitter of the clock grows with it, a noisy angle does not"}}};

constexpr EffectInfo kInfo{.id = "timing-jitter",
                           .cause = "Signals and reference are read at instants that scatter, "
                                    "which is a noise of the angle that grows with the speed.",
                           .stage = Stage::sampler,
                           .parameters = kParameters,
                           .correctable = false,
                           .evidence = Evidence::noise,
                           .separations = kSeparations,
                           .axis = "noise",
                           .pattern = Pattern::turn,
                           .character = Character::dynamic};

class TimingJitter final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void record(Values v, Take &take) const override {
    std::normal_distribution<double> normal(0.0, v[0] * take.model.periods_per_turn);
    for (std::size_t i = 0; i < take.capture.size(); ++i) {
      const double turn = take.at.omega[i] * normal(take.rng);
      turn_vector(take, i, std::cos(turn), std::sin(turn));
    }
  }
  std::string invisible(const Residual &r) const override {
    return r.several_speeds ? ""
           : r.own_motion ? "whole periods show one speed only: it is an angle noise like any other"
                          : "one speed only: it is an angle noise like any other";
  }
};

} // namespace

const Effect &timing_jitter() {
  static const TimingJitter effect;
  return effect;
}

} // namespace ada

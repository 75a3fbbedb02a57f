// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// White noise across the vector: the shaft vibrates against the reference, or the reference is
// noisy.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"rms_deg", "deg", 0.02, 0.0, 90.0}};

constexpr std::array<Separation, 2> kSeparations{
    {{"timing-jitter",
      "capture a second speed: a jitter of the clock grows with it, a noisy angle does not"},
     {"reference-resolution", "read the reference with finer steps"}}};

constexpr EffectInfo kInfo{
    .id = "angle-noise",
    .cause = "The noise lies across the vector: the shaft vibrates, or the reference is noisy.",
    .stage = Stage::motion,
    .parameters = kParameters,
    .correctable = false,
    .evidence = Evidence::noise,
    .separations = kSeparations,
    .axis = "noise",
    .pattern = Pattern::turn,
    .character = Character::white};

class AngleNoise final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void record(Values v, Take &take) const override {
    std::normal_distribution<double> normal(0.0, v[0] * kRadPerDeg * take.model.periods_per_turn);
    for (std::size_t i = 0; i < take.capture.size(); ++i) {
      const double turn = normal(take.rng);
      turn_vector(take, i, std::cos(turn), std::sin(turn));
    }
  }
};

} // namespace

const Effect &angle_noise() {
  static const AngleNoise effect;
  return effect;
}

} // namespace ada

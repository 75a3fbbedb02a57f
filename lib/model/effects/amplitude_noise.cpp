// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// White noise along the vector: of the supply, of the gain. It does not touch the angle.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"rms_fraction", "1", 0.0005, 0.0, 1.0}};

constexpr std::array<Separation, 2> kSeparations{
    {{"supply-variation", "record VDD: what follows it is the supply"},
     {"gain-wander",
      "capture for longer: a wander is smooth, noise differs from sample to sample"}}};

constexpr EffectInfo kInfo{.id = "amplitude-noise",
                           .cause = "The noise lies along the vector: the supply or the gain is "
                                    "noisy, and the angle does not see it.",
                           .stage = Stage::chain,
                           .parameters = kParameters,
                           .correctable = false,
                           .evidence = Evidence::noise,
                           .separations = kSeparations,
                           .axis = "noise",
                           .pattern = Pattern::gain,
                           .character = Character::white};

class AmplitudeNoise final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void record(Values v, Take &take) const override {
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < take.capture.size(); ++i)
      turn_vector(take, i, 1.0 + v[0] * normal(take.rng), 0.0);
  }
};

} // namespace

const Effect &amplitude_noise() {
  static const AmplitudeNoise effect;
  return effect;
}

} // namespace ada

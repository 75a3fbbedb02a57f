// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Both amplitudes move together, slowly with time.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"rms_fraction", "1", 0.003, 0.0, 1.0}};

constexpr std::array<Separation, 3> kSeparations{
    {{"amplitude-temperature-drift",
      "record VTEMP and sweep the temperature: a drift follows it, a wander does not"},
     {"supply-variation", "record VDD: what follows it is the supply"},
     {"amplitude-noise",
      "capture for longer: a wander is smooth, noise differs from sample to sample"}}};

constexpr EffectInfo kInfo{
    .id = "gain-wander",
    .cause =
        "Both amplitudes wander together, slowly with time: the gain, the magnet or its distance.",
    .stage = Stage::chain,
    .parameters = kParameters,
    .correctable = false,
    .evidence = Evidence::process,
    .separations = kSeparations,
    .axis = "time",
    .pattern = Pattern::gain,
    .character = Character::process};

class GainWander final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void record(Values v, Take &take) const override {
    if (take.memory.empty())
      SlowCourse::draw(take.duration_s, take.rng, take.memory);
    const SlowCourse course(take.memory);
    for (std::size_t i = 0; i < take.capture.size(); ++i)
      turn_vector(take, i, 1.0 + v[0] * course(take.at.time[i]), 0.0);
  }
};

} // namespace

const Effect &gain_wander() {
  static const GainWander effect;
  return effect;
}

} // namespace ada

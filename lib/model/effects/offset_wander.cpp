// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The offsets move slowly with time, whatever the temperature.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 2> kParameters{
    ParameterInfo{"rms_sin_v", "V", 0.002, 0.0, 5.0},
    ParameterInfo{"rms_cos_v", "V", 0.002, 0.0, 5.0}};

constexpr std::array<Separation, 4> kSeparations{
    {{"offset-temperature-drift",
      "record VTEMP and sweep the temperature: a drift follows it, a wander does not"},
     {"flicker-noise",
      "capture for longer: a wander is smooth, flicker noise goes on toward high frequency"},
     {"supply-variation", "record VDD: what follows it is the supply"},
     {"offset-step", "capture again: a step stays, a wander goes on"}}};

constexpr EffectInfo kInfo{.id = "offset-wander",
                           .cause =
                               "The offsets wander slowly with time, whatever the temperature: a "
                               "warming or stressed package, an amplifier that has not settled.",
                           .stage = Stage::chain,
                           .parameters = kParameters,
                           .correctable = false,
                           .evidence = Evidence::process,
                           .separations = kSeparations,
                           .axis = "time",
                           .pattern = Pattern::offset,
                           .character = Character::process};

class OffsetWander final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void record(Values v, Take &take) const override {
    if (take.memory.empty())
      for (int channel = 0; channel < 2; ++channel)
        SlowCourse::draw(take.duration_s, take.rng, take.memory);
    const std::span<const double> numbers(take.memory);
    const SlowCourse sin(numbers.first(SlowCourse::kNumbers));
    const SlowCourse cos(numbers.subspan(SlowCourse::kNumbers));
    for (std::size_t i = 0; i < take.capture.size(); ++i) {
      take.capture.vsin_v[i] += v[0] * sin(take.at.time[i]);
      take.capture.vcos_v[i] += v[1] * cos(take.at.time[i]);
    }
  }
};

} // namespace

const Effect &offset_wander() {
  static const OffsetWander effect;
  return effect;
}

} // namespace ada

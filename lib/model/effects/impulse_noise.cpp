// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Isolated spikes: a fraction `rate` of the samples of either channel is hit.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 2> kParameters{
    ParameterInfo{"rate", "1", 0.001, 0.0, 0.5}, ParameterInfo{"amplitude_v", "V", 0.1, 0.0, 5.0}};

constexpr EffectInfo kInfo{.id = "impulse-noise",
                           .cause =
                               "Isolated spikes hit the signals: sparks, ESD or a bad contact.",
                           .stage = Stage::converter,
                           .parameters = kParameters,
                           .correctable = false,
                           .evidence = Evidence::screening,
                           .axis = "noise",
                           .pattern = Pattern::offset,
                           .character = Character::white,
                           .spoils = Spoils::readings};

class ImpulseNoise final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void record(Values v, Take &take) const override {
    Capture &capture = take.capture;
    std::bernoulli_distribution hit(v[0]);
    std::normal_distribution<double> size(0.0, v[1]);
    for (std::size_t i = 0; i < capture.size(); ++i) {
      if (!hit(take.rng))
        continue;
      capture.vsin_v[i] += size(take.rng);
      capture.vcos_v[i] += size(take.rng);
    }
  }
  bool screen(Screened &look) const override { return screen_spikes(look, *this); }
};

} // namespace

const Effect &impulse_noise() {
  static const ImpulseNoise effect;
  return effect;
}

} // namespace ada

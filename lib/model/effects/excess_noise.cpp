// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// White noise above what the model states; `rms_v` is what comes on top of it.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{ParameterInfo{"rms_v", "V", 0.001, 0.0, 5.0}};

constexpr std::array<Separation, 3> kSeparations{
    {{"impulse-noise", "capture for longer: spikes stay rare and large, noise is in every sample"},
     {"amplitude-noise", "capture at another amplitude (gap, gain control): a noise of the gain "
                         "goes with it, this one "
                         "stays as many volts"},
     {"angle-noise", "capture at another amplitude (gap, gain control): a noise of the angle goes "
                     "with it, this one "
                     "stays as many volts"}}};

constexpr EffectInfo kInfo{.id = "excess-noise",
                           .cause = "There is more white noise than the model states.",
                           .stage = Stage::converter,
                           .parameters = kParameters,
                           .correctable = false,
                           .evidence = Evidence::noise,
                           .separations = kSeparations,
                           .axis = "noise",
                           .pattern = Pattern::offset,
                           .character = Character::white,
                           .prior_rank = 1};

class ExcessNoise final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void record(Values v, Take &take) const override {
    Capture &capture = take.capture;
    std::normal_distribution<double> noise(0.0, v[0]);
    for (std::size_t i = 0; i < capture.size(); ++i) {
      capture.vsin_v[i] += noise(take.rng);
      capture.vcos_v[i] += noise(take.rng);
    }
  }
};

} // namespace

const Effect &excess_noise() {
  static const ExcessNoise effect;
  return effect;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Noise that grows toward low frequency, in both channels independently: its power density is
// rms^2 / (ln(corner T) f) from 1/T on, so that rms is what lies between 1/T and the corner, at
// which it meets the white noise. T is the duration of the capture.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 2> kParameters{
    ParameterInfo{"rms_v", "V", 0.0005, 0.0, 5.0},
    ParameterInfo{"corner_hz", "Hz", 600.0, 1e-3, 1e9}};

constexpr std::array<Separation, 2> kSeparations{
    {{"offset-wander",
      "capture for longer: a wander is smooth, flicker noise goes on toward high frequency"},
     {"excess-noise", "sample faster: white noise stays as strong, flicker noise does not"}}};

constexpr EffectInfo kInfo{.id = "flicker-noise",
                           .cause = "The noise grows toward low frequency in both channels: "
                                    "flicker noise of the sensor or the amplifier.",
                           .stage = Stage::converter,
                           .parameters = kParameters,
                           .correctable = false,
                           .evidence = Evidence::noise,
                           .separations = kSeparations,
                           .axis = "noise",
                           .pattern = Pattern::offset,
                           .character = Character::process};

class FlickerNoise final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void record(Values v, Take &take) const override {
    const double duration = take.duration_s > 0.0 ? take.duration_s : kEndless;
    const double period = take.at.frame_period_s;
    // First-order relaxations with time constants of 2, 4, 8, ... / (2 pi) periods and an rms of a
    // each have a power density of a^2 / (ln 2 f) together, between the slowest and the fastest;
    // what is folded back from above the sampling rate adds 0.6 a^2 a sample to it.
    const double rms = v[0] * std::sqrt(std::log(2.0) / std::max(std::log(v[1] * duration), 1.0));
    const auto octaves = static_cast<std::size_t>(
        std::clamp(std::ceil(std::log2(4.0 * duration / period)), 1.0, 48.0));
    std::normal_distribution<double> normal;
    if (take.memory.empty())
      for (std::size_t k = 0; k < 2 * octaves; ++k)
        take.memory.push_back(normal(take.rng));
    std::vector<double> keep(octaves);
    for (std::size_t k = 0; k < octaves; ++k)
      keep[k] = std::exp(-kTwoPi * std::ldexp(0.5, -static_cast<int>(k)));
    const auto next = [&](double *state) {
      double sum = 0.0;
      for (std::size_t k = 0; k < octaves; ++k) {
        state[k] = keep[k] * state[k] + std::sqrt(1.0 - keep[k] * keep[k]) * normal(take.rng);
        sum += state[k];
      }
      return rms * sum;
    };
    for (std::size_t i = 0; i < take.capture.size(); ++i) {
      take.capture.vsin_v[i] += next(take.memory.data());
      take.capture.vcos_v[i] += next(take.memory.data() + octaves);
    }
  }
};

} // namespace

const Effect &flicker_noise() {
  static const FlickerNoise effect;
  return effect;
}

} // namespace ada

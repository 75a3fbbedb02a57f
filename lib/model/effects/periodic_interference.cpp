// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A tone that does not turn with the shaft: mains, or the alias of a PWM.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 5> kParameters{
    ParameterInfo{"frequency_hz", "Hz", 50.0, 0.0, kInf, Role::fitted, 1e-3},
    ParameterInfo{"amplitude_sin_v", "V", 0.003, 0.0, 5.0, Role::fitted, 1e-4},
    ParameterInfo{"amplitude_cos_v", "V", 0.003, 0.0, 5.0, Role::fitted, 1e-4},
    ParameterInfo{"phase_sin_deg", "deg", 0.0, -360.0, 360.0},
    ParameterInfo{"phase_cos_deg", "deg", 0.0, -360.0, 360.0}};

constexpr std::array<Separation, 4> kSeparations{
    {{"supply-variation", "record VDD: what follows it is the supply"},
     {"harmonic-distortion",
      "capture at another speed: a tone keeps its frequency, a harmonic its order"},
     {"rotation-nonuniformity",
      "capture at another speed: a tone keeps its frequency, a ripple of the shaft its order"},
     {"reference-harmonic", "capture at another speed: a tone keeps its frequency, an error of the "
                            "reference its order"}}};

constexpr EffectInfo kInfo{.id = "periodic-interference",
                           .cause = "A tone that does not turn with the shaft lies on the signals: "
                                    "mains pickup or the alias of a PWM.",
                           .stage = Stage::converter,
                           .parameters = kParameters,
                           .correctable = false,
                           .separations = kSeparations,
                           .axis = "frequency",
                           .pattern = Pattern::offset,
                           .character = Character::process,
                           .repeats = true};

class PeriodicInterference final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    const std::vector<double> x = to_coordinates(v);
    double s[kWaveBlock], c[kWaveBlock];
    for (std::size_t i = 0; i < w.n; ++i)
      s[i] = kTwoPi * v[0] * w.at.time[i];
    sincos_of(s, w.n, s, c);
    for (std::size_t i = 0; i < w.n; ++i) {
      w.s[i] += x[1] * s[i] + x[2] * c[i];
      w.c[i] += x[3] * s[i] + x[4] * c[i];
    }
  }
  std::vector<double> to_coordinates(Values v) const override {
    const double ps = v[3] * kRadPerDeg, pc = v[4] * kRadPerDeg;
    return {v[0], v[1] * std::cos(ps), v[1] * std::sin(ps), v[2] * std::cos(pc),
            v[2] * std::sin(pc)};
  }
  std::vector<double> from_coordinates(Values, std::span<const double> x) const override {
    return {x[0], std::hypot(x[1], x[2]), std::hypot(x[3], x[4]),
            wrap(std::atan2(x[2], x[1]) * kDegPerRad, 360.0),
            wrap(std::atan2(x[4], x[3]) * kDegPerRad, 360.0)};
  }
  std::optional<OneLine> one_line(Values v) const override {
    return OneLine{OneLine::Per::second, v[0]};
  }
  std::vector<double> steps(Values) const override { return {1e-5, 1e-4, 1e-4, 1e-4, 1e-4}; }
  std::vector<std::vector<double>> guesses(const Residual &r) const override {
    return find_tones(r);
  }
};

} // namespace

const Effect &periodic_interference() {
  static const PeriodicInterference effect;
  return effect;
}

} // namespace ada

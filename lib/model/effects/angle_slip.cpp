// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The magnet turns on the shaft at one moment: its angle jumps by `step_deg` and stays there.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 2> kParameters{
    ParameterInfo{"time_s", "s", 1.0, -kInf, kInf, Role::chosen},
    ParameterInfo{"step_deg", "deg", 1.0, -180.0, 180.0, Role::fitted, 0.01}};

constexpr std::array<Separation, 1> kSeparations{
    {{"sample-loss", "record a hardware sample counter, or the reference beside the sensor"}}};

constexpr EffectInfo kInfo{.id = "angle-slip",
                           .cause = "The magnet turned on the shaft at one moment, so the angle is "
                                    "off by a constant from then on.",
                           .stage = Stage::motion,
                           .parameters = kParameters,
                           .correctable = false,
                           .separations = kSeparations,
                           // At the only reversal of a capture the two look alike.
                           .yields_to = "hysteresis",
                           .axis = "time",
                           .pattern = Pattern::turn,
                           .character = Character::event,
                           .repeats = true};

class AngleSlip final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    for (std::size_t i = 0; i < w.n; ++i)
      if (w.at.time[i] >= v[0])
        w.alpha[i] += v[1] * kRadPerDeg;
  }
  std::vector<std::vector<double>> guesses(const Residual &r) const override {
    std::vector<std::vector<double>> out;
    for (const StepGuess &step : find_steps(r, StepIn::angle))
      out.push_back({step.time_s, step.first * kDegPerRad});
    return out;
  }
  std::string invisible(const Residual &r) const override {
    return r.has_reference ? "" : "without a reference it is looked for on the first look";
  }
  bool screen(Screened &look) const override { return screen_slip(look, *this); }
};

} // namespace

const Effect &angle_slip() {
  static const AngleSlip effect;
  return effect;
}

} // namespace ada

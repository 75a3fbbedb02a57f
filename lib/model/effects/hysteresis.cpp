// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The reading trails by half the width, by the sense of the rotation, whatever its speed.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"width_deg", "deg", 0.1, 0.0, 10.0, Role::fitted, 0.01}};

constexpr std::array<Separation, 2> kSeparations{
    {{"propagation-delay", "capture a second speed: a delay grows with it, hysteresis does not"},
     {"low-pass-rolloff",
      "capture a second speed: a filter lag grows with it, hysteresis does not"}}};

constexpr EffectInfo kInfo{.id = "hysteresis",
                           .cause = "The reading trails the magnet by a fixed angle that changes "
                                    "sign with the sense of rotation.",
                           .stage = Stage::field,
                           .parameters = kParameters,
                           .correctable = true,
                           .separations = kSeparations,
                           .axis = "speed",
                           .pattern = Pattern::turn,
                           .remembers = true};

class Hysteresis final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    const double half = 0.5 * v[0] * kRadPerDeg;
    if (half == 0.0)
      return;
    const double ch = std::cos(half), sh = std::sin(half);
    for (std::size_t i = 0; i < w.n; ++i) {
      const double st = -sh * w.at.direction[i];
      const double x = w.fx[i];
      w.fx[i] = x * ch - w.fy[i] * st;
      w.fy[i] = x * st + w.fy[i] * ch;
    }
  }
  std::string invisible(const Residual &r) const override {
    if (!r.has_reference)
      return "without a reference a lag of the reading has nothing to lag behind";
    return r.both_directions ? "" : "the shaft turns in one direction only";
  }
};

} // namespace

const Effect &hysteresis() {
  static const Hysteresis effect;
  return effect;
}

} // namespace ada

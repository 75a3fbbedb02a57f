// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// s = A sin(psi + d/2), c = A cos(psi - d/2): an ellipse with its axes at 45 degrees.

#include "base/angle.h"
#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"delta_deg", "deg", 0.4, -75.0, 75.0, Role::fitted, 0.01}};

constexpr std::array<Separation, 2> kSeparations{
    {{"channel-skew", "capture a second speed or the other direction: a skew grows with speed and "
                      "changes sign with direction"},
     {"multiplexer-memory",
      "record VTEMP in the same scan: with a multiplexer memory it carries the angle"}}};

constexpr EffectInfo kInfo{.id = "quadrature-error",
                           .cause = "The two channels are not a quarter of a period apart.",
                           .stage = Stage::bridge,
                           .parameters = kParameters,
                           .correctable = true,
                           .separations = kSeparations,
                           .prior_rank = 0,
                           .affine = true};

class QuadratureError final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  bool fold(Values v, EllipseParts &e) const override {
    e.delta_rad = v[0] * kRadPerDeg;
    return true;
  }
  double channels_apart_rad(Values v) const override { return v[0] * kRadPerDeg; }
  void apply(Values v, Wave &w) const override {
    const double ch = std::cos(0.5 * v[0] * kRadPerDeg), sh = std::sin(0.5 * v[0] * kRadPerDeg);
    for (std::size_t i = 0; i < w.n; ++i) {
      const double s = w.s[i];
      w.s[i] = s * ch + w.c[i] * sh;
      w.c[i] = w.c[i] * ch + s * sh;
    }
  }
};

} // namespace

const Effect &quadrature_error() {
  static const QuadratureError effect;
  return effect;
}

} // namespace ada

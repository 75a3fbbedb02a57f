// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The shaft's own speed ripple, seen where no reference tells it from an error of the sensor:
// the shaft stands at alpha + a sin(n alpha + phase) when even rotation would put it at alpha.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 3> kParameters{
    ParameterInfo{"order", "per turn", 1.0, 0.25, 64.0, Role::chosen},
    ParameterInfo{"amplitude_deg", "deg", 0.2, 0.0, 45.0, Role::fitted, 0.01},
    ParameterInfo{"phase_deg", "deg", 0.0, -360.0, 360.0}};

constexpr std::array<Separation, 3> kSeparations{
    {{"stray-field", "record a reference angle, or repeat at another speed or in a coast-down"},
     {"sensor-off-axis", "record a reference angle, or repeat at another speed or in a coast-down"},
     {"field-direction-error",
      "record a reference angle, or repeat at another speed or in a coast-down"}}};

constexpr EffectInfo kInfo{
    .id = "rotation-nonuniformity",
    .cause = "The shaft itself does not turn evenly: its speed ripples with the turn.",
    .stage = Stage::motion,
    .parameters = kParameters,
    .correctable = false,
    .separations = kSeparations,
    .pattern = Pattern::turn,
    .repeats = true};

class RotationNonuniformity final : public PolarEffect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    const double a = v[1] * kRadPerDeg, phase = v[2] * kRadPerDeg;
    if (a == 0.0)
      return;
    double s[kWaveBlock], c[kWaveBlock];
    for (std::size_t i = 0; i < w.n; ++i)
      s[i] = v[0] * w.at.alpha[i] + phase;
    sincos_of(s, w.n, s, c);
    for (std::size_t i = 0; i < w.n; ++i)
      w.alpha[i] += a * s[i];
  }
  std::string invisible(const Residual &r) const override {
    return r.has_reference ? "the reference follows the shaft's true motion" : "";
  }
  std::vector<std::vector<double>> guesses(const Residual &r) const override {
    auto out = one_of_each(3, 0, 1, 12);
    // The motion is read off the pair by a spline with a knot a turn: of a slow wander it leaves
    // images at orders about 1, which are no ripple.
    ParameterInfo order = kParameters[0];
    order.minimum = 1.5;
    add_orders_seen(r, order, Orders::any, out);
    return out;
  }

protected:
  std::size_t amplitude_index() const override { return 1; }
  std::size_t phase_index() const override { return 2; }
};

} // namespace

const Effect &rotation_nonuniformity() {
  static const RotationNonuniformity effect;
  return effect;
}

} // namespace ada

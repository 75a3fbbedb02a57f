// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The shaft's own speed ripple, seen where no reference tells it from an error of the sensor:
// the shaft stands at alpha + a sin(n alpha + phase) when even rotation would put it at alpha.

#include "model/effects/common.h"
#include "motion/kinematics.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 4> kParameters{
    ParameterInfo{"order", "per turn", 1.0, 0.25, 64.0, Role::chosen},
    ParameterInfo{"amplitude_deg", "deg", 0.2, 0.0, 45.0, Role::fitted, 0.01},
    ParameterInfo{"phase_deg", "deg", 0.0, -360.0, 360.0},
    // Where the amplitude is as stated: it falls with the square of the speed above this, since a
    // torque has the less time the faster the shaft turns. Absent: it is the same at every speed.
    ParameterInfo{"speed_rpm", "rpm", std::numeric_limits<double>::quiet_NaN(), 1e-6, 1e7,
                  Role::chosen}};

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
    const double slowest = v[3] * kTwoPi / 60.0;
    for (std::size_t i = 0; i < w.n; ++i)
      w.alpha[i] += a * s[i] * (slowest > 0.0 ? ripple_at(w.at.omega[i], slowest) : 1.0);
  }
  std::string invisible(const Residual &r) const override {
    return r.has_reference ? "the reference follows the shaft's true motion" : "";
  }
  std::vector<std::vector<double>> guesses(const Residual &r) const override {
    auto out = one_of_each(4, 0, 1, 12);
    // The motion is read off the pair by a spline with a knot a turn: of a slow wander it leaves
    // images at orders about 1, which are no ripple.
    ParameterInfo order = kParameters[0];
    order.minimum = 1.5;
    add_orders_seen(r, order, Orders::any, out);
    // Two digits: the same in every part of a record.
    const double rpm = slowest_speed(r) * 60.0 / kTwoPi;
    const double digits = rpm > 0.0 ? std::pow(10.0, std::floor(std::log10(rpm)) - 1.0) : 1.0;
    for (auto &values : out)
      values[3] = rpm > 0.0 ? digits * std::round(rpm / digits) : std::nan("");
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

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The sensor sits beside the shaft axis. The field of a dipole m at in-plane offset s and gap z is
// 3 (m.r) r / r^5 - m / r^3: its component along s is weakened by rho = 3 s^2/(s^2 + z^2) against
// the one across. With a = rho/(2 - rho) the direction obeys tan(phi - beta) = tan(alpha - beta) (1
// + a)/(1 - a), so phi - alpha = a sin 2(alpha - beta) + (a^2/2) sin 4(alpha - beta) + ...: the
// parameter is exactly the first term. The Lissajous figure stays a circle.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 2> kParameters{
    ParameterInfo{"a_deg", "deg", 0.2, 0.0, 20.0, Role::fitted, 0.01},
    ParameterInfo{"direction_deg", "deg", 0.0, -360.0, 360.0}};

// With two periods a turn a second harmonic of both channels turns the vector as this does, and
// adds to its length what one of one channel can take out.
constexpr std::array<Separation, 4> kSeparations{
    {{"rotation-nonuniformity",
      "record a reference angle, or repeat at another speed or in a coast-down"},
     {"field-direction-error", "move the sensor by a known step: the error of an off-axis sensor "
                               "grows with the square of the distance"},
     {"reference-harmonic", kSteadySpin},
     {"harmonic-distortion", "move the sensor by a known step: the error of an off-axis sensor "
                             "grows with the square of the distance, that of a channel stays"}}};

constexpr EffectInfo kInfo{
    .id = "sensor-off-axis",
    .cause =
        "The sensor sits beside the shaft axis, where the magnet's field has another direction.",
    .stage = Stage::field,
    .parameters = kParameters,
    .correctable = true,
    .separations = kSeparations,
    .pattern = Pattern::turn,
    .prior_rank = 1};

class SensorOffAxis final : public PolarEffect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    const double a = v[0] * kRadPerDeg;
    if (a == 0.0)
      return;
    const double cb = std::cos(v[1] * kRadPerDeg), sb = std::sin(v[1] * kRadPerDeg);
    for (std::size_t i = 0; i < w.n; ++i) {
      const double along = (1.0 - a) * (w.fx[i] * cb + w.fy[i] * sb);
      const double across = (1.0 + a) * (w.fy[i] * cb - w.fx[i] * sb);
      w.fx[i] = along * cb - across * sb;
      w.fy[i] = along * sb + across * cb;
    }
  }
  bool refuted(Values, const Residual &r) const override { return !turns_with_poles(r).empty(); }
  std::string invisible(const Residual &r) const override {
    const std::string poles = turns_with_poles(r);
    return poles.empty() ? looks_like_ripple(r, " of order 2") : poles;
  }

protected:
  double multiplicity() const override { return 2.0; }
};

} // namespace

const Effect &sensor_off_axis() {
  static const SensorOffAxis effect;
  return effect;
}

} // namespace ada

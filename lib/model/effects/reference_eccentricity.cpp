// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The reference is off centre: it reads alpha + e sin(alpha + phi). Nothing is wrong with the
// sensor.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 2> kParameters{
    ParameterInfo{"e_deg", "deg", 0.2, 0.0, 20.0, Role::fitted, 0.01},
    ParameterInfo{"phase_deg", "deg", 0.0, -360.0, 360.0}};

constexpr std::array<Separation, 1> kSeparations{
    {{"stray-field", "capture a steady spin: whichever of sensor and reference keeps uniform time "
                     "is the innocent one; or turn the reference on the shaft by 90 degrees"}}};

constexpr EffectInfo kInfo{.id = "reference-eccentricity",
                           .cause = "The reference itself is off centre; the sensor is right.",
                           .stage = Stage::record,
                           .parameters = kParameters,
                           .correctable = false,
                           .separations = kSeparations};

class ReferenceEccentricity final : public PolarEffect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void shaft_from_reference(Values v, std::span<double> angle) const override {
    const double e = v[0] * kRadPerDeg, phase = v[1] * kRadPerDeg;
    if (e == 0.0)
      return;
    const std::size_t n = angle.size();
    double alpha[kWaveBlock], s[kWaveBlock], c[kWaveBlock];
    std::copy(angle.begin(), angle.end(), alpha);
    for (int k = 0; k < 3; ++k) { // contracts by e each time
      for (std::size_t i = 0; i < n; ++i)
        alpha[i] += phase;
      sincos_of(alpha, n, s, c);
      for (std::size_t i = 0; i < n; ++i)
        alpha[i] = angle[i] - e * s[i];
    }
    std::copy(alpha, alpha + n, angle.begin());
  }
  std::array<double, 2> reference_ripple(Values v) const override {
    const double e = v[0] * kRadPerDeg, phase = v[1] * kRadPerDeg;
    return {e * std::sin(phase), e * std::cos(phase)};
  }
  void record(Values v, Rng &, Capture &capture) const override {
    for (double &r : capture.reference_deg)
      r = wrap(r + v[0] * std::sin((r + v[1]) * kRadPerDeg), 360.0);
  }
  std::string invisible(const Residual &r) const override {
    return r.has_reference ? "" : "there is no reference";
  }
};

} // namespace

const Effect &reference_eccentricity() {
  static const ReferenceEccentricity effect;
  return effect;
}

} // namespace ada

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

constexpr std::array<Separation, 2> kSeparations{
    {{"stray-field", "capture a steady spin: whichever of sensor and reference keeps uniform time "
                     "is the innocent one; or turn the reference on the shaft by 90 degrees"},
     {"field-direction-error", kSteadySpin}}};

constexpr EffectInfo kInfo{.id = "reference-eccentricity",
                           .cause = "The reference itself is off centre; the sensor is right.",
                           .stage = Stage::record,
                           .parameters = kParameters,
                           .correctable = false,
                           .separations = kSeparations,
                           .pattern = Pattern::turn};

class ReferenceEccentricity final : public ReferenceError {
public:
  const EffectInfo &info() const override { return kInfo; }
  /// A ring that is off centre errs once a turn as well, and is the more likely to be.
  std::string invisible(const Residual &r) const override {
    const std::string none = ReferenceError::invisible(r);
    return !none.empty() || turns_with_poles(r).empty()
               ? none
               : "a ring of poles that is off centre looks the same";
  }

protected:
  double order(Values) const override { return 1.0; }
};

} // namespace

const Effect &reference_eccentricity() {
  static const ReferenceEccentricity effect;
  return effect;
}

} // namespace ada

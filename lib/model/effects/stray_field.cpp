// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A constant field of relative strength b in the housing's frame adds to the magnet's: an exact sum
// of vectors. To first order the angle error is b sin(gamma - alpha).

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 2> kParameters{
    ParameterInfo{"b", "1", 0.01, 0.0, 0.9, Role::fitted, 1e-4},
    ParameterInfo{"direction_deg", "deg", 0.0, -360.0, 360.0}};

constexpr std::array<Separation, 3> kSeparations{
    {{"reference-eccentricity",
      "capture a steady spin: whichever of sensor and reference keeps uniform time is the innocent "
      "one; or turn the reference on the shaft by 90 degrees"},
     {"rotation-nonuniformity",
      "record a reference angle, or repeat at another speed or in a coast-down"},
     {"field-direction-error", "turn the housing in space: a stray field stays where it is"}}};

constexpr EffectInfo kInfo{
    .id = "stray-field",
    .cause = "A constant field that does not turn with the magnet adds to the magnet's field.",
    .stage = Stage::field,
    .parameters = kParameters,
    .correctable = true,
    .separations = kSeparations,
    .pattern = Pattern::turn,
    .prior_rank = 1};

class StrayField final : public PolarEffect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    const double bx = v[0] * std::cos(v[1] * kRadPerDeg), by = v[0] * std::sin(v[1] * kRadPerDeg);
    for (std::size_t i = 0; i < w.n; ++i) {
      w.fx[i] += bx;
      w.fy[i] += by;
    }
  }
  bool refuted(Values, const Residual &r) const override { return !turns_with_poles(r).empty(); }
  std::string invisible(const Residual &r) const override {
    const std::string poles = turns_with_poles(r);
    return poles.empty() ? looks_like_ripple(r, " of order 1") : poles;
  }
};

} // namespace

const Effect &stray_field() {
  static const StrayField effect;
  return effect;
}

} // namespace ada

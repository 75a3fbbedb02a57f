// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The reference moves in steps: a counter of few lines. Found in its own column, before any fit.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"step_deg", "deg", 0.1, 0.0, 90.0, Role::chosen}};

constexpr std::array<Separation, 1> kSeparations{
    {{"angle-noise",
      "read the reference with finer steps, or turn slowly: steps repeat at the same places"}}};

constexpr EffectInfo kInfo{
    .id = "reference-resolution",
    .cause = "The reference moves in steps that are wide against the noise of the sensor.",
    .stage = Stage::record,
    .parameters = kParameters,
    .correctable = false,
    .evidence = Evidence::screening,
    .separations = kSeparations,
    .axis = "noise",
    .pattern = Pattern::turn};

class ReferenceResolution final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void record(Values v, Take &take) const override {
    if (v[0] <= 0.0)
      return;
    for (double &r : take.capture.reference_deg) {
      const double in_turn = wrap(r, 360.0);
      r += v[0] * std::round(in_turn / v[0]) - in_turn;
    }
  }
  double reference_step_rad(Values v) const override { return v[0] * kRadPerDeg; }
  std::string invisible(const Residual &r) const override {
    return r.has_reference ? "" : "there is no reference";
  }
  bool screen(Screened &look) const override {
    const double step = find_reference_step(look);
    if (!(step > 0.0))
      return false;
    look.findings.push_back({this, {step}, {0.0}, {}, {}});
    return true;
  }
};

} // namespace

const Effect &reference_resolution() {
  static const ReferenceResolution effect;
  return effect;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The reference is read tau after the signals (before them where it is negative): it shows the
// angle of tau later.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"tau_s", "s", 50e-6, -1.0, 1.0, Role::fitted, 1e-6}};

constexpr std::array<Separation, 4> kSeparations{
    {{"angle-slip",
      "go back to the first speed in the same capture: what is read late comes back, a slip stays"},
     {"propagation-delay",
      "use another reference, or measure the delay of the signal path by itself"},
     {"low-pass-rolloff",
      "capture at a higher speed: a low pass also lowers the amplitude, a late reference does not"},
     {"hysteresis",
      "capture a second speed: what is read late grows with it, hysteresis does not"}}};

constexpr EffectInfo kInfo{.id = "reference-delay",
                           .cause = "The reference is not read at the same moment as the signals, "
                                    "so it is off by an angle that grows with the speed.",
                           .stage = Stage::record,
                           .parameters = kParameters,
                           .correctable = false,
                           .separations = kSeparations,
                           .yields_to = "propagation-delay",
                           .axis = "speed",
                           .pattern = Pattern::turn,
                           .character = Character::dynamic};

class ReferenceDelay final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void shaft_from_reference(Values v, const Conditions &at,
                            std::span<double> angle) const override {
    if (at.omega == nullptr)
      return;
    for (std::size_t i = 0; i < angle.size(); ++i) {
      angle[i] -= v[0] * at.omega[i];
      if (at.accel != nullptr)
        angle[i] += 0.5 * v[0] * v[0] * static_cast<double>(at.accel[i]);
    }
  }
  void record(Values v, Take &take) const override {
    std::vector<double> &reference = take.capture.reference_deg;
    for (std::size_t i = 0; i < reference.size(); ++i)
      reference[i] += kDegPerRad * v[0] *
                      (take.at.omega[i] + 0.5 * v[0] * static_cast<double>(take.at.accel[i]));
  }
  std::string invisible(const Residual &r) const override {
    if (!r.has_reference)
      return "there is no reference";
    return r.several_speeds || r.both_directions
               ? ""
               : "one speed in one direction: a late reference is a part of the zero angle";
  }
};

} // namespace

const Effect &reference_delay() {
  static const ReferenceDelay effect;
  return effect;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A direction error of another order than a stray field's or an off-axis sensor's: anisotropy of
// the film, flaws of the magnet. phi = alpha + a sin(n alpha + phase); the circle stays a circle.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 3> kParameters{
    ParameterInfo{"order", "per turn", 3.0, 1.0, 64.0, Role::chosen},
    ParameterInfo{"a_deg", "deg", 0.2, 0.0, 20.0, Role::fitted, 0.01},
    ParameterInfo{"phase_deg", "deg", 0.0, -360.0, 360.0}};

constexpr std::array<Separation, 4> kSeparations{
    {{"rotation-nonuniformity",
      "record a reference angle, or repeat at another speed or in a coast-down"},
     {"reference-harmonic", kSteadySpin},
     {"stray-field", "turn the housing in space: a stray field stays where it is"},
     {"sensor-off-axis", "move the sensor by a known step: the error of an off-axis sensor grows "
                         "with the square of the distance"}}};

constexpr EffectInfo kInfo{.id = "field-direction-error",
                           .cause = "The direction of the field departs from the magnet's angle "
                                    "with a fixed order of the turn.",
                           .stage = Stage::field,
                           .parameters = kParameters,
                           .correctable = true,
                           .signature = true,
                           .separations = kSeparations,
                           .pattern = Pattern::turn,
                           .prior_rank = 3,
                           .repeats = true};

class FieldDirectionError final : public PolarEffect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    const double a = v[1] * kRadPerDeg, phase = v[2] * kRadPerDeg;
    if (a == 0.0)
      return;
    const auto make = [&](TurnsOfBlock::Turn &turn) {
      double by[kWaveBlock];
      for (std::size_t i = 0; i < w.n; ++i)
        by[i] = v[0] * w.alpha[i] + phase;
      sincos_of(by, w.n, turn.sin, turn.cos);
      for (std::size_t i = 0; i < w.n; ++i)
        by[i] = a * turn.sin[i];
      sincos_of(by, w.n, turn.sin, turn.cos);
    };
    TurnsOfBlock::Turn own;
    if (w.turns == nullptr)
      make(own);
    const TurnsOfBlock::Turn &turn =
        w.turns == nullptr ? own : w.turns->of({v[0], a, phase, w.delay_s}, own, make);
    for (std::size_t i = 0; i < w.n; ++i) {
      const double x = w.fx[i];
      w.fx[i] = x * turn.cos[i] - w.fy[i] * turn.sin[i];
      w.fy[i] = x * turn.sin[i] + w.fy[i] * turn.cos[i];
    }
  }
  std::string invisible(const Residual &r) const override { return looks_like_ripple(r, ""); }
  std::vector<std::vector<double>> guesses(const Residual &r) const override {
    auto out = one_of_each(3, 0, 1, 12);
    add_orders_seen(r, kParameters[0], Orders::whole, out);
    if (turns_with_poles(r).empty())
      out.erase(out.begin(), out.begin() + 2); // orders 1 and 2 have a cause of their own
    return out;
  }

protected:
  std::size_t amplitude_index() const override { return 1; }
  std::size_t phase_index() const override { return 2; }
};

} // namespace

const Effect &field_direction_error() {
  static const FieldDirectionError effect;
  return effect;
}

} // namespace ada

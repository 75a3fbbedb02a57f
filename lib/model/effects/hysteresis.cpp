// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The reading trails by half the width, by the sense of the rotation, whatever its speed. Where the
// shaft turns back the field of a play operator (M. A. Krasnosel'skii and A. V. Pokrovskii, Systems
// with Hysteresis, 1989) stays where it is until the shaft has gone the whole width; the plainest
// hysteresis changes over at once. Ways there and back of less than the width, in which a play does
// not reach its other side, are taken for whole ones.

#include "model/effects/common.h"

namespace ada {
namespace {

/// `play`: 1 where the reading crosses the loop as the shaft turns back; absent: at once.
constexpr std::array<ParameterInfo, 2> kParameters{
    ParameterInfo{"width_deg", "deg", 0.1, 0.0, 10.0, Role::fitted, 0.01},
    ParameterInfo{"play", "1", std::numeric_limits<double>::quiet_NaN(), 0.0, 1.0, Role::chosen}};

constexpr std::array<Separation, 2> kSeparations{
    {{"propagation-delay", "capture a second speed: a delay grows with it, hysteresis does not"},
     {"low-pass-rolloff",
      "capture a second speed: a filter lag grows with it, hysteresis does not"}}};

constexpr EffectInfo kInfo{.id = "hysteresis",
                           .cause = "The reading trails the magnet by a fixed angle that changes "
                                    "sign with the sense of rotation.",
                           .stage = Stage::field,
                           .parameters = kParameters,
                           .correctable = true,
                           .separations = kSeparations,
                           .axis = "speed",
                           .pattern = Pattern::turn,
                           .remembers = true};

class Hysteresis final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    const double half = 0.5 * v[0] * kRadPerDeg;
    if (half == 0.0)
      return;
    const bool crosses = v[1] > 0.0 && w.at.travel != nullptr;
    double lag[kWaveBlock], sh[kWaveBlock], ch[kWaveBlock];
    for (std::size_t i = 0; i < w.n; ++i) {
      // With a negative width, where a fit may wander, the loop has the same length.
      const double gone = crosses ? w.at.travel[i] - std::abs(half) : std::abs(half);
      lag[i] = -w.at.direction[i] * std::copysign(1.0, half) * std::min(std::abs(half), gone);
    }
    sincos_of(lag, w.n, sh, ch);
    for (std::size_t i = 0; i < w.n; ++i) {
      const double x = w.fx[i];
      w.fx[i] = x * ch[i] - w.fy[i] * sh[i];
      w.fy[i] = x * sh[i] + w.fy[i] * ch[i];
    }
  }
  std::vector<std::vector<double>> choices(Values v) const override {
    return {{v[0], v[1] > 0.0 ? std::nan("") : 1.0}};
  }
  std::string invisible(const Residual &r) const override {
    if (!r.has_reference)
      return "without a reference a lag of the reading has nothing to lag behind";
    return r.both_directions ? "" : "the shaft turns in one direction only";
  }
};

} // namespace

const Effect &hysteresis() {
  static const Hysteresis effect;
  return effect;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Each conversion keeps a part m of the channel converted before it, in the scan order VSIN, VCOS,
// VTEMP. Where VTEMP is not in the scan, VSIN keeps a part of the VCOS of the frame before.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"m", "1", 0.005, 0.0, 0.5, Role::fitted, 1e-4}};

constexpr std::array<Separation, 2> kSeparations{
    {{"quadrature-error", "record VTEMP in the same scan: with a multiplexer memory it carries the "
                          "angle; or change the scan order"},
     {"channel-skew", "record VTEMP in the same scan: with a multiplexer memory it carries the "
                      "angle; or capture a second speed"}}};

constexpr EffectInfo kInfo{
    .id = "multiplexer-memory",
    .cause = "The converter's sampling capacitor keeps a part of the channel converted before.",
    .stage = Stage::converter,
    .parameters = kParameters,
    .correctable = true,
    .separations = kSeparations,
    .remembers = true};

class MultiplexerMemory final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    const double m = v[0];
    if (m == 0.0)
      return;
    double turned_c[kWaveBlock], turned_s[kWaveBlock];
    for (std::size_t i = 0; i < w.n; ++i)
      turned_s[i] = w.at.omega ? w.periods * (w.at.omega[i] * w.at.frame_period_s) : 0.0;
    sincos_of(turned_s, w.n, turned_s, turned_c);
    for (std::size_t i = 0; i < w.n; ++i) {
      // The pair one frame ago: turned back by the step of psi. What is kept of VCOS has itself kept
      // a part of VSIN; m^2 of a volt still is more than the noise.
      const double c = w.c[i] - w.mid_v, s = w.s[i] - w.mid_v;
      const double cos_before = c * turned_c[i] + s * turned_s[i];
      const double sin_before = s * turned_c[i] - c * turned_s[i];
      double before = w.mid_v + cos_before + m * (sin_before - cos_before);
      if (w.at.vtemp_scan != nullptr) // VTEMP has kept a part of it
        before = w.at.vtemp_scan[i] + m * (before - w.at.vtemp_scan[i]);
      w.s[i] += m * (before - w.s[i]);
      w.c[i] += m * (w.s[i] - w.c[i]);
    }
  }
  double vtemp_on_vcos(Values v) const override { return v[0]; }
  void record(Values v, Take &take) const override {
    Capture &capture = take.capture;
    for (std::size_t i = 0; i < capture.vtemp_v.size(); ++i)
      capture.vtemp_v[i] += v[0] * (capture.vcos_v[i] - capture.vtemp_v[i]);
  }
};

} // namespace

const Effect &multiplexer_memory() {
  static const MultiplexerMemory effect;
  return effect;
}

} // namespace ada

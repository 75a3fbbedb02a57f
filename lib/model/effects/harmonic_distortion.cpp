// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// One channel carries a harmonic of psi that no transfer error explains:
// adds A a sin(n psi + phase) to it. A signature, whose physical cause is open.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 4> kParameters{
    ParameterInfo{"order", "of psi", 2.0, 2.0, 32.0, Role::chosen},
    ParameterInfo{"channel", "channel", 0.0, 0.0, 1.0, Role::chosen},
    ParameterInfo{"amplitude", "1", 0.005, 0.0, 1.0, Role::fitted, 1e-4},
    ParameterInfo{"phase_deg", "deg", 0.0, -360.0, 360.0}};

constexpr EffectInfo kInfo{.id = "harmonic-distortion",
                           .cause = "One channel carries a harmonic of the electrical angle.",
                           .stage = Stage::chain,
                           .parameters = kParameters,
                           .correctable = true,
                           .signature = true,
                           .prior_rank = 3,
                           .repeats = true};

class HarmonicDistortion final : public PolarEffect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    const double a = v[2] * w.amplitude_v;
    if (a == 0.0)
      return;
    const double in_phase = a * std::cos(v[3] * kRadPerDeg);
    const double quadrature = a * std::sin(v[3] * kRadPerDeg);
    double *channel = channel_of(w, v[1]);
    double x[kWaveBlock], y[kWaveBlock], c[kWaveBlock], s[kWaveBlock];
    std::copy(w.ex, w.ex + w.n, x);
    std::copy(w.ey, w.ey + w.n, y);
    to_power(w.n, static_cast<unsigned>(v[0]), x, y, c, s);
    for (std::size_t i = 0; i < w.n; ++i)
      channel[i] += in_phase * s[i] + quadrature * c[i];
  }
  std::vector<std::vector<double>> guesses(const Residual &) const override {
    std::vector<std::vector<double>> out;
    for (double channel : {0.0, 1.0})
      for (auto v : one_of_each(4, 0, 2, 8)) {
        v[1] = channel;
        out.push_back(v);
      }
    return out;
  }
  /// Order n of a channel lengthens the vector with orders n - 1 and n + 1. Of order 2 the lower
  /// one is an offset's, of order 3 that of mismatch and quadrature error: what is left are a size
  /// and a phase for one order of the length, which whatever has that order fits as well.
  bool shows(Values v, const Residual &r) const override { return !r.own_motion || v[0] >= 4.0; }
  std::string invisible_part(const Residual &r) const override {
    return r.own_motion ? "order 2 and 3: only the length of the vector is judged, where of each "
                          "one order is left beside offsets, mismatch and quadrature error"
                        : "";
  }
  std::optional<OneLine> one_line(Values v) const override {
    return OneLine{OneLine::Per::electrical_period, v[0]};
  }
  /// A channel with more than one part in n of order n turns back within each period: what it reads
  /// then is no sensor's harmonic.
  bool refuted(Values v, const Residual &) const override { return v[2] * v[0] > 1.0; }

protected:
  std::size_t amplitude_index() const override { return 2; }
  std::size_t phase_index() const override { return 3; }
};

} // namespace

const Effect &harmonic_distortion() {
  static const HarmonicDistortion effect;
  return effect;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A first-order low pass before the sampler. Its impulse response exp(-u) du, u = t/tau, is
// replaced by the nodes of Gauss-Laguerre quadrature, so the filter becomes a sum of delayed copies
// of the signal, each evaluated on the true motion; five nodes are exact to 1e-7 of the amplitude
// up to omega tau = 0.4.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"corner_hz", "Hz", 600.0, 0.01, kInf, Role::fitted, 1.0}};

constexpr std::array<Separation, 1> kSeparations{
    {{"propagation-delay",
      "capture at a higher speed: a low pass also lowers the amplitude, a delay does not"}}};

constexpr EffectInfo kInfo{
    .id = "low-pass-rolloff",
    .cause = "A low pass before the sampler weakens and delays the signals as the speed grows.",
    .stage = Stage::chain,
    .parameters = kParameters,
    .correctable = true,
    .separations = kSeparations,
    .yields_to = "propagation-delay",
    .axis = "speed",
    .character = Character::dynamic};

class LowPassRolloff final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void dynamics(Values v, Taps &taps) const override {
    if (!std::isfinite(v[0]) || v[0] == 0.0)
      return;
    static constexpr double node[] = {0.26356031971814091020, 1.4134030591065167922,
                                      3.5964257710407220812, 7.0858100058588375569,
                                      12.640800844275782659};
    static constexpr double weight[] = {0.52175561058280865248, 0.39866681108317592745,
                                        0.075942449681707595388, 0.0036117586799220484545,
                                        0.000023369972385776227891};
    const double tau = 1.0 / (kTwoPi * v[0]);
    std::array<Tap, 5> system;
    for (std::size_t k = 0; k < system.size(); ++k)
      system[k] = {node[k] * tau, weight[k]};
    taps.pass(system);
  }
  /// Fitted as its time constant: zero is no filter.
  std::vector<double> to_coordinates(Values v) const override {
    return {std::isfinite(v[0]) && v[0] != 0.0 ? 1.0 / (kTwoPi * v[0]) : 0.0};
  }
  std::vector<double> from_coordinates(Values, std::span<const double> x) const override {
    return {x[0] != 0.0 ? 1.0 / (kTwoPi * x[0]) : kInf};
  }
  std::vector<double> steps(Values) const override { return {1e-6}; }
  std::string invisible(const Residual &r) const override {
    return r.several_speeds ? "" : "one speed only: amplitude and lag cannot change with speed";
  }
  std::vector<std::vector<double>> guesses(const Residual &r) const override {
    // The lag shows with the square of what the amplitude shows: start from visible sizes.
    const double highest = r.fastest_omega * r.periods / kTwoPi;
    return {{1.5 * highest}, {3.0 * highest}, {6.0 * highest}, {20.0 * highest}};
  }
};

} // namespace

const Effect &low_pass_rolloff() {
  static const LowPassRolloff effect;
  return effect;
}

} // namespace ada

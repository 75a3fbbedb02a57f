// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A first-order low pass before the sampler. Its impulse response exp(-u) du, u = t/tau, is
// replaced by the nodes of Gauss-Laguerre quadrature, so the filter becomes a sum of delayed copies
// of the signal, each evaluated on the true motion. The ten nodes are made as few as the speed
// allows (model/taps).

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
    static constexpr double node[] = {0.099747507032597466, 0.52685764885190323, 1.3006291212514964,
                                      2.4308010787308443,   3.9321028222932184,  5.8255362183017088,
                                      8.140240141565144,    10.916499507366019,  14.210805011161289,
                                      18.104892220218098};
    static constexpr double weight[] = {0.23181557714485496,    0.35378469159754822,
                                        0.25873461024543143,    0.11548289355692445,
                                        0.033192092159337667,   0.0061928694370066784,
                                        0.00073989037786739145, 5.4907194668417462e-05,
                                        2.4095857640854112e-06, 5.8015439816765811e-08};
    const double tau = 1.0 / (kTwoPi * v[0]);
    std::array<Tap, std::size(node)> system;
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
    return r.several_speeds ? ""
           : r.own_motion
               ? "whole periods show one speed only, with which amplitude and lag could change"
               : "one speed only: amplitude and lag cannot change with speed";
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

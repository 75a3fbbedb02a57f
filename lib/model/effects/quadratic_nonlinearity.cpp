// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Even (bow) transfer error of the chain: each channel adds q2 A x^2, x = signal/A about
// mid-supply.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 2> kParameters{
    ParameterInfo{"q2", "1", 0.01, -0.3, 0.3, Role::fitted, 1e-4}, kOrigin};

constexpr std::array<Separation, 2> kSeparations{
    {{"harmonic-distortion", "change the amplitude (gain control, supply) and capture again: a "
                             "transfer error changes with it"},
     {"clipping",
      "capture at another amplitude (gain control, supply): clipping keeps its level in volts"}}};

constexpr EffectInfo kInfo{.id = "quadratic-nonlinearity",
                           .cause =
                               "The transfer of the signal chain is bent like a bow (even order).",
                           .stage = Stage::chain,
                           .parameters = kParameters,
                           .correctable = true,
                           .separations = kSeparations};

class QuadraticNonlinearity final : public TransferError {
public:
  const EffectInfo &info() const override { return kInfo; }

protected:
  int order() const override { return 2; }
};

} // namespace

const Effect &quadratic_nonlinearity() {
  static const QuadraticNonlinearity effect;
  return effect;
}

} // namespace ada

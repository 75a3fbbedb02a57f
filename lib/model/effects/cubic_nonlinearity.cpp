// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Odd transfer error of the chain: each channel adds q3 A x^3, x = signal/A about mid-supply.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 2> kParameters{
    ParameterInfo{"q3", "1", 0.01, -0.3, 0.3, Role::fitted, 1e-4}, kOrigin};

constexpr std::array<Separation, 2> kSeparations{
    {{"weak-field",
      "change the air gap (the field) or the amplitude (the gain control) and capture again"},
     {"harmonic-distortion", "change the amplitude (gain control, supply) and capture again: a "
                             "transfer error changes with it"}}};

constexpr EffectInfo kInfo{.id = "cubic-nonlinearity",
                           .cause =
                               "The transfer of the signal chain is bent like an S (odd order).",
                           .stage = Stage::chain,
                           .parameters = kParameters,
                           .correctable = true,
                           .separations = kSeparations};

class CubicNonlinearity final : public TransferError {
public:
  const EffectInfo &info() const override { return kInfo; }

protected:
  int order() const override { return 3; }
};

} // namespace

const Effect &cubic_nonlinearity() {
  static const CubicNonlinearity effect;
  return effect;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Samples are missing and the time column does not show it: the rows are gone and the clock of the
// record runs on as though nothing were missing.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 2> kParameters{
    ParameterInfo{"count", "1", 2.0, 1.0, 1e6, Role::chosen},
    ParameterInfo{"samples", "1", 40.0, 1.0, 1e9, Role::chosen}};

constexpr std::array<Separation, 1> kSeparations{
    {{"angle-slip", "record a hardware sample counter, or the reference beside the sensor"}}};

constexpr EffectInfo kInfo{.id = "sample-loss",
                           .cause = "Samples are missing and the time column does not show it.",
                           .stage = Stage::record,
                           .parameters = kParameters,
                           .correctable = false,
                           .evidence = Evidence::screening,
                           .separations = kSeparations,
                           .axis = "time",
                           .pattern = Pattern::turn,
                           .character = Character::event,
                           .spoils = Spoils::rows};

class SampleLoss final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void record(Values v, Take &take) const override {
    drop_rows(static_cast<std::size_t>(v[0]), static_cast<std::size_t>(v[1]), take.rng,
              take.capture);
  }
  bool screen(Screened &look) const override { return screen_losses(look, *this); }
};

} // namespace

const Effect &sample_loss() {
  static const SampleLoss effect;
  return effect;
}

} // namespace ada

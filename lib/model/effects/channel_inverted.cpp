// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The sign of a channel is reversed about mid-supply.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"channel", "channel", 0.0, 0.0, 1.0, Role::chosen}};

constexpr std::array<Separation, 1> kSeparations{
    {{"channel-swap", "look at the wiring, and whether sensor and reference are mounted the same "
                      "way round; or compare one known zero angle"}}};

constexpr EffectInfo kInfo{.id = "channel-inverted",
                           .cause = "The sign of a channel is reversed.",
                           .stage = Stage::record,
                           .parameters = kParameters,
                           .correctable = true,
                           .evidence = Evidence::screening,
                           .separations = kSeparations};

class ChannelInverted final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  bool fold(Values v, EllipseParts &e) const override {
    (v[0] == 0.0 ? e.sin_inverted : e.cos_inverted) = true;
    return true;
  }
  void apply(Values v, Wave &w) const override {
    double *channel = channel_of(w, v[0]);
    for (std::size_t i = 0; i < w.n; ++i)
      channel[i] = 2.0 * w.mid_v - channel[i];
  }
};

} // namespace

const Effect &channel_inverted() {
  static const ChannelInverted effect;
  return effect;
}

} // namespace ada

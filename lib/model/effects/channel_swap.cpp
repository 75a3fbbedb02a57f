// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// VSIN and VCOS are exchanged, so the angle runs backwards.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<Separation, 1> kSeparations{
    {{"channel-inverted", "look at the wiring, and whether sensor and reference are mounted the "
                          "same way round; or compare one known zero angle"}}};

constexpr EffectInfo kInfo{.id = "channel-swap",
                           .cause = "VSIN and VCOS are exchanged, so the angle runs backwards.",
                           .stage = Stage::record,
                           .parameters = {},
                           .correctable = true,
                           .evidence = Evidence::screening,
                           .separations = kSeparations};

class ChannelSwap final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  bool fold(Values, EllipseParts &e) const override {
    e.swapped = true;
    return true;
  }
  void apply(Values, Wave &w) const override {
    for (std::size_t i = 0; i < w.n; ++i)
      std::swap(w.s[i], w.c[i]);
  }
  bool screen(Screened &look) const override { return screen_orientation(look, *this); }
};

} // namespace

const Effect &channel_swap() {
  static const ChannelSwap effect;
  return effect;
}

} // namespace ada

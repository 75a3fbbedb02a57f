// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A channel stops following the angle and holds its last value.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 2> kParameters{
    ParameterInfo{"channel", "channel", 0.0, 0.0, 1.0, Role::chosen},
    ParameterInfo{"time_s", "s", 1.0, -kInf, kInf, Role::chosen}};

constexpr EffectInfo kInfo{
    .id = "stuck-channel",
    .cause = "A channel stopped following the angle: a broken wire or a dead amplifier.",
    .stage = Stage::record,
    .parameters = kParameters,
    .correctable = false,
    .evidence = Evidence::screening,
    .axis = "time",
    .character = Character::event,
    .spoils = Spoils::channel,
    .repeats = true};

class StuckChannel final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void record(Values v, Take &take) const override {
    Capture &capture = take.capture;
    std::vector<double> &channel = channel_of(capture, v[0]);
    std::size_t i = 0;
    while (i < capture.size() && capture.time_s[i] < v[1])
      ++i;
    for (std::size_t k = i; k < channel.size(); ++k)
      channel[k] = channel[i > 0 ? i - 1 : 0];
  }
  bool screen(Screened &look) const override { return screen_stuck(look, *this); }
};

} // namespace

const Effect &stuck_channel() {
  static const StuckChannel effect;
  return effect;
}

} // namespace ada

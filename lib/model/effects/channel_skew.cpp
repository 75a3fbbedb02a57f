// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A multiplexed converter: VCOS is sampled dt later than VSIN (negative when earlier).

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 1> kParameters{
    ParameterInfo{"dt_s", "s", 10e-6, -1.0, 1.0, Role::fitted, 1e-6}};

constexpr std::array<Separation, 2> kSeparations{
    {{"quadrature-error", "capture a second speed or the other direction: a skew grows with speed "
                          "and changes sign with direction"},
     {"multiplexer-memory", "capture a second speed: a skew grows with it"}}};

constexpr EffectInfo kInfo{.id = "channel-skew",
                           .cause = "The converter samples the two channels one after the other.",
                           .stage = Stage::sampler,
                           .parameters = kParameters,
                           .correctable = true,
                           .separations = kSeparations,
                           .axis = "speed",
                           .character = Character::dynamic,
                           .prior_rank = 1};

class ChannelSkew final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  /// Within a frame one channel is late by less than its period; by just one where a frame is
  /// paired with the one before. By more it is where the channels have converters, or filters, of
  /// their own: that is believed where several speeds show it.
  bool refuted(Values v, const Residual &r) const override {
    constexpr double kMostPeriods = 1.5, kMostSeen = 8.0;
    const double most = r.several_speeds ? kMostSeen : kMostPeriods;
    return r.sample_period_s > 0.0 && std::abs(v[0]) > most * r.sample_period_s;
  }
  void dynamics(Values v, Taps &taps) const override {
    for (Tap &tap : taps.cos)
      tap.delay_s -= v[0];
  }
};

} // namespace

const Effect &channel_skew() {
  static const ChannelSkew effect;
  return effect;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// An offset jumps at one moment and stays there.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 3> kParameters{
    ParameterInfo{"time_s", "s", 1.0, -kInf, kInf, Role::chosen},
    ParameterInfo{"step_sin_v", "V", 0.01, -5.0, 5.0, Role::fitted, 1e-3},
    ParameterInfo{"step_cos_v", "V", 0.0, -5.0, 5.0, Role::fitted, 1e-3}};

constexpr EffectInfo kInfo{
    .id = "offset-step",
    .cause = "An offset jumped at one moment: a contact, a solder joint or a stressed package.",
    .stage = Stage::chain,
    .parameters = kParameters,
    .correctable = false,
    .axis = "time",
    .pattern = Pattern::offset,
    .character = Character::event,
    .repeats = true};

class OffsetStep final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  void apply(Values v, Wave &w) const override {
    for (std::size_t i = 0; i < w.n; ++i)
      if (w.at.time[i] >= v[0])
        w.add_offset(i, v[1], v[2]);
  }
  bool leaves_behind(Values v, Baseline &baseline) const override {
    baseline.offset_sin_v += v[1];
    baseline.offset_cos_v += v[2];
    return true;
  }
  std::vector<std::vector<double>> guesses(const Residual &r) const override {
    std::vector<std::vector<double>> out;
    for (const StepGuess &step : find_steps(r, StepIn::offsets))
      out.push_back({step.time_s, step.first, step.second});
    return out;
  }
};

} // namespace

const Effect &offset_step() {
  static const OffsetStep effect;
  return effect;
}

} // namespace ada

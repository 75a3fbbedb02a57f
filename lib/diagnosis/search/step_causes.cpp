// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/search/step_causes.h"

#include <algorithm>
#include <map>

#include "diagnosis/criteria.h"
#include "model/effect.h"
#include "model/effect_text.h"

namespace ada {

namespace {

/// What of a step an effect that is an event makes, V^2.
double made_by(const EffectInfo &info, const PairStep &step) {
  if (info.pattern == Pattern::offset)
    return std::norm(step.offset);
  if (info.pattern == Pattern::turn)
    return step.pair.imag() * step.pair.imag();
  return 0.0;
}

bool is_event(const EffectInfo &info) {
  return info.evidence == Evidence::signal && info.character == Character::event;
}

} // namespace

std::vector<PairStep> steps_of(const Anonymous &unnamed, int periods_per_turn) {
  const Selection &all = unnamed.selection;
  std::map<double, std::map<int, std::complex<double>>> change; // by moment and exponent, V
  for (std::size_t k = 0; k + 1 < all.columns.size(); ++k) {
    const auto term = static_cast<std::size_t>(all.columns[k] / 2);
    const Basis::Term &t = unnamed.basis.terms()[term];
    if (t.modulation.kind != Modulation::step || all.columns[k] % 2 != 0)
      continue;
    const auto at = static_cast<Eigen::Index>(k);
    change[t.modulation.at][t.exponent] = {all.values[at], all.values[at + 1]};
  }
  std::vector<PairStep> out;
  for (auto &[moment, of] : change)
    out.push_back({moment, of[0], of[periods_per_turn], of[-periods_per_turn]});
  return out;
}

std::vector<EffectInstance> causes_of_steps(const Anonymous &unnamed, const Model &model) {
  std::vector<EffectInstance> out;
  for (const PairStep &step : steps_of(unnamed, model.periods_per_turn))
    for (const Effect *effect : catalogue()) {
      const EffectInfo &info = effect->info();
      const double all = step.square_v2();
      if (!is_event(info) || all - made_by(info, step) > criteria::kLittle * all)
        continue;
      EffectInstance cause{effect, {}, {}};
      for (const ParameterInfo &p : info.parameters)
        cause.values.push_back(p.name == "time_s" ? step.moment_s : 0.0);
      if (std::none_of(model.effects.begin(), model.effects.end(),
                       [&](const EffectInstance &e) { return repeats(e, cause); }))
        out.push_back(std::move(cause));
    }
  return out;
}

} // namespace ada

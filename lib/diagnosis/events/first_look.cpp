// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/events/first_look.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/angle.h"
#include "base/pick.h"
#include "base/robust.h"
#include "conversion/angle_solver.h"
#include "diagnosis/events/change_points.h"
#include "diagnosis/search/fit.h"
#include "motion/kinematics.h"
#include "motion/surroundings.h"

namespace ada {

namespace {

/// The pair's own angle with what is known of the sensor taken out, unwrapped.
std::vector<double> corrected_angle(const Screened &look, const Model &known,
                                    const Observations &surroundings) {
  const Capture &c = look.capture;
  const Kinematics rough = differentiate(c.time_s, look.angle, 8);
  Observations every;
  every.time = time_with_losses(look);
  every.vsin = as_floats(c.vsin_v);
  every.vcos = as_floats(c.vcos_v);
  every.alpha = rough.alpha;
  every.omega = as_floats(rough.omega);
  every.accel.assign(c.size(), 0.0f);
  every.direction = rough.direction;
  every.temp = surroundings.temp;
  every.supply = surroundings.supply;
  take_derivatives(c.time_s, every);
  every.frame_period_s = median_step(c.time_s);
  every.vtemp_scanned = c.has_vtemp();
  // What no conversion corrects, a step of an offset or a tone, would bend the motion all the same.
  Model lasting = known;
  std::erase_if(lasting.effects, [](const EffectInstance &e) {
    const EffectInfo &info = e.effect->info();
    return info.evidence == Evidence::signal && !info.correctable && info.stage != Stage::motion;
  });
  std::vector<double> vsin = c.vsin_v, vcos = c.vcos_v;
  if (lasting.effects.size() < known.effects.size()) {
    const ResidualColumns with = residual_columns(every, known);
    const ResidualColumns without = residual_columns(every, lasting);
    for (std::size_t i = 0; i < c.size(); ++i) {
      vsin[i] -= with.model_sin[i] - without.model_sin[i];
      vcos[i] -= with.model_cos[i] - without.model_cos[i];
    }
  }
  const AngleSolver solver(known);
  std::vector<double> angle(c.size()), radius(c.size());
  solver.start(vsin, vcos, angle);
  const double period = kTwoPi / c.meta.periods_per_turn;
  for (std::size_t i = 0; i < angle.size(); ++i)
    angle[i] += period * std::round((look.angle[i] - angle[i]) / period);
  solver.solve(every.conditions(), vsin, vcos, angle, radius);
  // Bad samples keep what the pair says, a wrong half turn is put right.
  for (std::size_t i = 0; i < angle.size(); ++i)
    angle[i] = std::isfinite(angle[i])
                   ? angle[i] + period * std::round((look.angle[i] - angle[i]) / period)
                   : look.angle[i];
  return angle;
}

/// The model with each step of its own moved to a jump that was seen within a turn of it: what
/// remains of the jump then is none of the step. False: no step lies at a jump.
bool put_steps_at_jumps(const Screened &look, Model &model) {
  const std::vector<double> &time = look.capture.time_s;
  bool moved = false;
  for (EffectInstance &e : model.effects) {
    if (!has_moment(*e.effect))
      continue;
    const auto later = std::lower_bound(time.begin(), time.end(), e.values[0]);
    const double there =
        look.angle[std::min(time.size() - 1, static_cast<std::size_t>(later - time.begin()))];
    for (std::size_t jump : look.jumps)
      if (std::abs(look.angle[jump] - there) < kTwoPi) {
        e.values[0] = 0.5 * (time[jump] + time[jump - 1]);
        moved = true;
      }
  }
  return moved;
}

} // namespace

void take_derivatives(const std::vector<double> &time_s, Observations &data) {
  if (data.supply.empty())
    return;
  Derivatives of(time_s, data.supply);
  data.supply_rate = std::move(of.rate);
  data.supply_bend = std::move(of.bend);
}

Screened screen(const Capture &capture, const Model *known, const Observations &surroundings,
                std::vector<char> usable) {
  Screened look = first_look(capture, std::move(usable));
  if (!known || capture.has_reference()) {
    look_at_record(look);
    return look;
  }
  Screened anew = look;
  look_at_record(look);
  const bool steps = std::any_of(known->effects.begin(), known->effects.end(),
                                 [](const EffectInstance &e) { return has_moment(*e.effect); });
  Model exact = *known;
  const bool at_jumps = steps && put_steps_at_jumps(look, exact);
  anew.angle = corrected_angle(look, exact, surroundings);
  if (steps && !at_jumps) {
    look.angle = std::move(anew.angle);
    return look;
  }
  for (std::size_t k = 0; k < look.jumps.size(); ++k)
    if (look.jump_lost[k] > 0)
      anew.lost_before.push_back(look.jumps[k]);
  look_at_record(anew);
  return anew;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/lines/one_line.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

#include "base/angle.h"
#include "diagnosis/criteria.h"
#include "diagnosis/search/fit.h"

namespace ada {

namespace {

/// Mean speed, rad/s: the slope of the angle over the time.
double mean_speed(const Observations &data) {
  const double n = static_cast<double>(data.size());
  double t0 = 0.0, a0 = 0.0, tt = 0.0, ta = 0.0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    t0 += data.time[i] / n;
    a0 += data.alpha[i] / n;
  }
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double t = data.time[i] - t0;
    tt += t * t;
    ta += t * (data.alpha[i] - a0);
  }
  return ta / tt;
}

/// Part of a line of the angle, of `order` periods a turn, that a line of `omega` rad/s holds.
double in_common(const Observations &data, double order, double omega) {
  std::complex<double> sum;
  for (std::size_t i = 0; i < data.size(); ++i)
    sum += std::polar(1.0, order * data.alpha[i] - omega * data.time[i]);
  return std::norm(sum) / std::pow(static_cast<double>(data.size()), 2);
}

EffectInstance with_its_line_at(const Effect &effect, double periods) {
  EffectInstance out{&effect, {}, {}};
  for (const ParameterInfo &p : effect.info().parameters)
    out.values.push_back(is_place(p) ? periods : p.fallback);
  return out;
}

} // namespace

std::vector<const Effect *> same_line(const Observations &data, const Model &model,
                                      std::size_t effect, double variance_v2) {
  const EffectInstance &e = model.effects[effect];
  const std::optional<OneLine> mine = e.effect->one_line(e.values);
  const double speed = mine && data.size() > 1 ? mean_speed(data) : 0.0;
  if (!std::isfinite(speed) || speed == 0.0)
    return {};
  const bool of_angle = mine->per == OneLine::Per::electrical_period;
  const double turns = std::abs(speed) * model.periods_per_turn / kTwoPi;
  const double other = of_angle ? mine->periods * turns : std::round(mine->periods / turns);
  const double order = (of_angle ? mine->periods : other) * model.periods_per_turn;
  const double omega = (of_angle ? other : mine->periods) * std::copysign(kTwoPi, speed);
  const double part = moved_rms_v(data, model, effect);
  const double nats = static_cast<double>(data.size()) * part * part / variance_v2 *
                      (1.0 - in_common(data, order, omega));
  if (!(nats < criteria::kRivalNats))
    return {};
  std::vector<const Effect *> out;
  for (const Effect *candidate : catalogue()) {
    const EffectInstance there = with_its_line_at(*candidate, other);
    const std::optional<OneLine> line = candidate->one_line(there.values);
    if (line && line->per != mine->per && in_range(there))
      out.push_back(candidate);
  }
  return out;
}

} // namespace ada

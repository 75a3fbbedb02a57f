// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/naming/own_law.h"

#include <cmath>
#include <vector>

#include "diagnosis/anonymous/beside_anonymous.h"
#include "diagnosis/criteria.h"
#include "diagnosis/noise/along_and_across.h"

namespace ada {

namespace {

std::vector<double> left_along(const Observations &own, const Model &model) {
  std::vector<double> along, across;
  along_and_across(own, residual_columns(own, model), along, across);
  return along;
}

/// Mean square of y beside a straight line over x.
double beside_line(const std::vector<double> &x, const std::vector<double> &y) {
  const double n = static_cast<double>(x.size());
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sx += x[i];
    sy += y[i];
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = x[i] - sx / n, dy = y[i] - sy / n;
    sxx += dx * dx;
    sxy += dx * dy;
    syy += dy * dy;
  }
  return (sxx > 0.0 ? syy - sxy * sxy / sxx : syy) / n;
}

} // namespace

void drop_what_a_line_describes_better(const DataSplit &split, SearchResult &found) {
  if (split.has_reference)
    return;
  for (std::size_t place = found.order.size(); place-- > 0;) {
    const Model &model = found.fit.model;
    const EffectInfo &info = model.effects[found.order[place]].effect->info();
    if (info.character != Character::dynamic || info.axis != "speed")
      continue;
    const Observations own = at_own_angle(split.train, model);
    const double by_law = mean_square(left_along(own, model));
    const Model less = fit(split.train, model.without(found.order[place]), kRefit).model;
    const Observations beside = at_own_angle(split.train, less);
    std::vector<double> speed;
    for (std::size_t i = 0; i < beside.size(); ++i)
      speed.push_back(std::abs(static_cast<double>(beside.omega[i])));
    const double by_line = beside_line(speed, left_along(beside, less));
    const double n = static_cast<double>(own.size());
    if (n * std::log(by_law / std::max(by_line, criteria::kLeastMeanSquare)) < criteria::kRivalNats)
      continue;
    found.forget(place);
    found.fit.model = less;
  }
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/naming/own_law.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "diagnosis/anonymous/beside_anonymous.h"
#include "diagnosis/criteria.h"
#include "diagnosis/noise/along_and_across.h"

namespace ada {

namespace {

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

/// Mean squares of what is left along the vector, V^2.
struct Left {
  double v2 = 0.0;
  double beside_line = 0.0; ///< over the speed, whatever its sense
};

Left left_of(const DataSplit &split, const Model &model) {
  const Observations own = at_own_angle(split.train, model);
  std::vector<double> along, across, speed;
  along_and_across(own, residual_columns(own, model), along, across);
  for (std::size_t i = 0; i < own.size(); ++i)
    speed.push_back(std::abs(static_cast<double>(own.omega[i])));
  return {mean_square(along), beside_line(speed, along)};
}

} // namespace

void drop_what_a_line_describes_better(const DataSplit &split, SearchResult &found) {
  if (split.has_reference)
    return;
  for (std::size_t place = found.order.size(); place-- > 0;) {
    const Model &model = found.fit.model;
    const EffectInfo &info = model.effects[found.order[place]].effect->info();
    if (info.character != Character::dynamic || info.axis != axis_name(Axis::speed))
      continue;
    FitResult less = fit(split.train, model.without(found.order[place]), kRefit);
    const Left with = left_of(split, model), without = left_of(split, less.model);
    const double n = static_cast<double>(split.train.size());
    const auto nats = [n](double by, double than) {
      return n * std::log(than / std::max(by, criteria::kLeastMeanSquare));
    };
    // What is left for other reasons is as large beside both.
    if (nats(without.beside_line, with.v2) < criteria::kRivalNats ||
        nats(with.beside_line, without.beside_line) > criteria::kRivalNats)
      continue;
    found.forget(place);
    found.fit = std::move(less);
  }
}

} // namespace ada

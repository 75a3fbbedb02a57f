// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/travel.h"

#include <algorithm>
#include <cmath>

#include "base/robust.h"
#include "diagnosis/criteria.h"

namespace ada {

Travel::Travel(double noise_rad) : play_rad_(criteria::kPlayNoise * noise_rad) {}

double Travel::to(double angle_rad) {
  if (!std::isfinite(angle_rad))
    return way_rad_;
  if (!began_) {
    began_ = true;
    at_rad_ = angle_rad;
  }
  const double next = std::clamp(at_rad_, angle_rad - play_rad_, angle_rad + play_rad_);
  way_rad_ += std::abs(next - at_rad_);
  at_rad_ = next;
  return way_rad_;
}

double travel_of(std::span<const double> angle_rad) {
  Travel travel(noise_between(angle_rad));
  double way = 0.0;
  for (double a : angle_rad)
    way = travel.to(a);
  return way;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// How far a shaft went, there and back alike. An angle that is noisy goes to and fro by itself, in
// ten thousand rows many turns of a shaft that stands: what lies within the noise is no way.
#pragma once

#include <span>

namespace ada {

class Travel {
public:
  /// `noise_rad`: standard deviation of the angle at rest.
  explicit Travel(double noise_rad);
  /// The way until the next angle, unwrapped, rad.
  double to(double angle_rad);

private:
  double play_rad_, at_rad_ = 0.0, way_rad_ = 0.0;
  bool began_ = false;
};

/// The whole way of an unwrapped angle, rad; its noise is found by itself.
double travel_of(std::span<const double> angle_rad);

} // namespace ada

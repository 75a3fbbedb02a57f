// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// An angle that is read in coarse steps, between the steps.
#pragma once

#include <span>
#include <vector>

namespace ada {

struct BetweenSteps {
  std::vector<double> angle; ///< rad; as it was read where it is not known better
  std::vector<char> known;   ///< whether it is
};

/// Readings of an unwrapped angle, each within half of `step` (rad) of it, by the plainest motion
/// that agrees with them: a spline whose pieces are halved where one does not. Where a shaft turns
/// through many steps that is far closer to it than the readings are. Nothing more is known of what
/// is not usable, and of what agrees with no piece that holds enough readings.
BetweenSteps between_steps(std::span<const double> time, std::span<const double> angle,
                           std::span<const char> usable, double step);

} // namespace ada

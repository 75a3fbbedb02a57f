// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A shaft whose speed goes its own way in each turn, as one that is turned by hand: what of it repeats
// with the turn repeats by chance, and says nothing of the sensor or of the drive.
#pragma once

#include <span>

#include "motion/kinematics.h"

namespace ada {

/// Whether the largest ripple (by its part of the speed) is no larger than what chance would leave in
/// the mean of so many turns: of what the smooth motion itself does at the same order, turn by turn,
/// or of what it leaves of the `angle` (unwrapped, rad, of the shaft, one value a sample of the
/// motion), which differs from turn to turn. Needs two whole turns in one sense; false of fewer, and
/// of a ripple within the noise.
bool ripples_by_chance(const SmoothMotion &smooth, std::span<const double> angle);

} // namespace ada

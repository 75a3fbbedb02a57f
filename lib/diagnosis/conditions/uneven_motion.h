// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A shaft whose speed goes its own way in each turn, as one that is turned by hand: what of it repeats
// with the turn repeats by chance, and says nothing of the sensor or of the drive.
#pragma once

#include <span>
#include <vector>

#include "motion/kinematics.h"

namespace ada {

/// Part of the power of a ripple of this order of the turn that a motion with these knots cannot
/// follow. One time, angle (rad, of the shaft), mark and size of the ripple a sample; no sizes: it
/// is as large everywhere.
double beyond_knots(const std::vector<double> &knots, std::span<const double> time,
                    std::span<const double> angle, std::span<const char> usable, double order,
                    std::span<const double> size = {});

/// Whether the largest ripple (by its part of the speed) is no larger than what chance would leave in
/// the mean of so many turns: of what the smooth motion itself does at the same order, turn by turn,
/// or of what it leaves of the `angle` (unwrapped, rad, of the shaft, one value a sample of the
/// motion), which differs from turn to turn. Or whether the knots of the motion, which lie close
/// where a shaft changes its speed, can follow most of any such ripple: then the one that was fitted
/// beside them is what they left to it. Needs two whole turns in one sense; false of fewer, and of a
/// ripple within the noise. One time and one mark a sample.
bool ripples_by_chance(const SmoothMotion &smooth, std::span<const double> time,
                       std::span<const double> angle, std::span<const char> usable);

/// Whether an order of what is left of an angle beside a smooth motion differs from turn to turn by
/// more than its mean over the turns would by chance. `angle`: rad of the shaft, the motion and
/// what is left of it; `usable`: 0 where nothing is known; `falls`: with the speed, as a ripple of
/// the shaft does and an error of the field does not.
bool differs_from_turn_to_turn(const Kinematics &motion, std::span<const double> angle,
                               std::span<const char> usable, int order, bool falls);

} // namespace ada

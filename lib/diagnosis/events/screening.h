// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The first look at a capture, before any fit: dead channels, wiring, lost samples, spikes.
#pragma once

#include <span>
#include <vector>

#include "diagnosis/conditions/own_jumps.h"
#include "model/residual.h"
#include "motion/kinematics.h"

namespace ada {

/// Dead channels and spikes, and the angle of the pair itself. `usable`: 0 where a sample is no
/// number or not the sensor's.
Screened first_look(const Capture &capture, std::vector<char> usable);

/// Lets every other effect of the catalogue have its first look, at `look.angle` as it is.
void look_at_record(Screened &look);

/// Jumps of the pair's own angle beside a smooth motion that no finding of the looks accounts for.
OwnJumps unnamed_jumps(const Screened &look);

/// The reference, rad, unwrapped.
std::vector<double> reference_angle(const Capture &capture);

/// Share of the electrical circle, by sectors of 10 degrees, that mechanical angles in rad reach.
double share_of_circle(std::span<const double> angle, int periods);

/// Spread of what is left of the pair's radius without what repeats with the angle, relative to it.
double radius_left_rad(const Screened &look);

/// The time column with the samples put back that it does not know to be lost: a tone went on while
/// they were.
std::vector<double> time_with_losses(const Screened &look);

/// The smooth motion of a capture without reference, with the jumps at lost samples and slips
/// taken as what they are.
SmoothMotion smooth_motion_with_losses(Screened &look, int orders);

} // namespace ada

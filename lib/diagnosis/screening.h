// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The first look at a capture, before any fit: dead channels, wiring, lost samples, spikes.
#pragma once

#include "model/residual.h"
#include "motion/kinematics.h"

namespace ada {

/// Lets every effect of the catalogue have its first look.
Screened screen(const Capture &capture);

/// The reference, rad, unwrapped.
std::vector<double> reference_angle(const Capture &capture);

/// The smooth motion of a capture without reference, with the jumps at lost samples and slips
/// taken as what they are.
SmoothMotion smooth_motion_with_losses(Screened &look, int orders);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// How the shaft moved in a record, by its reference or by the pair itself, and which rows say
// nothing of it.
#pragma once

#include <cstdint>
#include <vector>

#include "diagnosis/conditions/observations.h"
#include "motion/kinematics.h"

namespace ada {

struct Screened;

/// The motion that a reference gives. Rows in which it alone errs, and those where the speed or the
/// sense changes, are used no longer; what the reference shows of itself goes into the scene.
Kinematics motion_by_reference(Screened &look, Scene &scene);

/// The motion that the pair itself gives: smooth over time where the shaft turned smoothly enough
/// to be its own reference, else the pair's own angle, of which only the radius can be judged.
/// `rough`: what is left out of the smooth motion, at the pair's own angle.
Kinematics motion_by_pair(Screened &look, Scene &scene, std::vector<std::uint32_t> &rough);

} // namespace ada

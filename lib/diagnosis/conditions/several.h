// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include "diagnosis/conditions/observations.h"

namespace ada {

/// `prepare` of a capture that several records were joined to (join.h): each is screened and gets
/// its motion by itself, and the zero of its reference is moved to that of the first, since a
/// sensor that was mounted anew reads another one. From three records on every third of them is
/// held out as a whole; of two each is split by itself.
Scene prepare_several(const Capture &joined, bool needs_split, const Model *known,
                      std::optional<double> vdd_level_v);

/// Moves the angle of everything that a scene holds; by how much stays known beside it (`moved`).
void move_angle(Scene &scene, double by_rad);

} // namespace ada

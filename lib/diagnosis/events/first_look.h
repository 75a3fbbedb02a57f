// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The first looks at a capture, at the angle of the pair as it is and, once something is known of
// the sensor, at the angle that it then gives.
#pragma once

#include "diagnosis/conditions/observations.h"
#include "diagnosis/events/screening.h"

namespace ada {

/// `known`: jumps are looked for once more at the angle that this model gives, as what bends the
/// pair hides them. A step of the model's own would leave a jump there when its moment is not
/// exact. `surroundings`: temperature and supply of every sample of the capture. `usable`: 0 where
/// a sample is no number or not the sensor's.
Screened screen(const Capture &capture, const Model *known, const Observations &surroundings,
                std::vector<char> usable);

/// Rate and bend of the supply, for a capture that has one.
void take_derivatives(const std::vector<double> &time_s, Observations &data);

} // namespace ada

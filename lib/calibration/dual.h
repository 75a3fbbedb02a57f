// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The application note's two-temperature calibration: offsets (and amplitude) as straight lines
// over VTEMP.
#pragma once

#include "calibration/pair_estimate.h"
#include "model/model.h"

namespace ada {

/// Least distance of the two captures in VTEMP, as a fraction of the supply. VTEMP of the ADA4571
/// moves by about a third of a percent of the supply a kelvin, so this is some ten kelvin.
inline constexpr double kMinVtempSpan = 0.03;

/// The order of the two does not matter: the one with the lower VTEMP is the cold one.
Model calibrate_dual(const Recording &cold, const Recording &hot, CalibrationMethod method);
Model calibrate_dual(const Capture &cold, const Capture &hot, CalibrationMethod method);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Captures that show no pair of a turning vector: both stand still, or move along one line.
#pragma once

#include "diagnosis/conditions/observations.h"
#include "recording/capture.h"

namespace ada {

/// Whether neither channel moves beyond its noise and a little hum or creep.
bool stands_still(const Capture &capture, double noise_v);

/// Whether VSIN and VCOS move along one line: by the variance across it over that along it, or
/// because it is no more than noise.
bool on_one_line(const Observations &data, double noise_v);

} // namespace ada

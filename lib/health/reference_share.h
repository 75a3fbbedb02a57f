// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Does the reference turn with the shaft that the pair shows? Whatever a sensor does wrong, most of
// what its pair does goes with the cosine and the sine of its shaft: an offset, an ellipse of one
// to ten, harmonics of a third, a channel that is dead. A reference that tells less than half of it
// is that of another shaft or of another time, stands still, or does not count degrees. Held
// against it nothing is learnt about the sensor.
#pragma once

#include <string>

#include "recording/capture.h"

namespace ada {

/// Part of what the pair does, in variance, that goes with the cosine and the sine of `periods`
/// times the reference: the coefficient of determination, with the degrees of freedom taken off,
/// over stretches in which the pair goes twice round. From one stretch to the next a reference may
/// slip, drift or lag as it will. 0 or less: nothing; not a number where there are too few rows.
double share_by_reference(const Capture &capture, double periods);

/// Why the reference is not that of the shaft that the pair shows, as the end of a sentence; empty
/// where it may be. It is about the reference only where the pair draws its circle by itself.
std::string why_of_no_shaft(const Capture &capture);

} // namespace ada

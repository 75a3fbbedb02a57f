// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What makes a capture unfit for any calibration, each with its own reason. All of them throw
// ADA4571_ERROR_UNUSABLE_DATA.
#pragma once

#include "calibration/ellipse_fit.h"
#include "recording/capture.h"

namespace ada {

/// Both channels at rest, or a channel that stays put while the other moves, always or for a part
/// of the capture. To be called before a fit.
void refuse_dead_channels(const Capture &capture);

/// More samples off the ellipse than spikes account for: a step, or another fault in time.
void refuse_scattered(const Capture &capture, const EllipseFit &fit);

/// A channel that stops short of its peak. Near a peak of one channel the other one crosses
/// mid-scale and tells the angle, hence how the first should bend: the slope of measured against
/// expected volts is 1 when sound and 0 when clipped, and a clipped peak has no spread but noise.
void refuse_clipped(const Capture &capture, const EllipseFit &fit);

} // namespace ada

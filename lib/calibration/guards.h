// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What makes a capture unfit for any calibration, each with its own reason. Those that refuse throw
// ADA4571_ERROR_UNUSABLE_DATA; those that return a reason return it empty where there is none.
#pragma once

#include <string>

#include "calibration/ellipse_fit.h"
#include "recording/capture.h"

namespace ada {

/// Both channels at rest, or a channel that stays put while the other moves. To be called before a
/// fit.
void refuse_dead_channels(const Capture &capture);
/// The same for a part of the capture, whose samples must be neighbours.
void refuse_stuck_stretches(const Capture &capture);

/// Two signals that do not turn with a magnet: noise, or levels that they only jump between. A
/// magnet leaves no sample near the centre. Where kOutlierSigmas of the scatter about the ellipse
/// reach from the curve to its centre, no sample could be told from one there, and the curve is no
/// finding; of samples spread evenly over a square, a disc or a normal distribution the scatter is
/// 0.35 to 0.52 of the radius, more than twice that limit. And a curve through no more angles than
/// it has free parameters proves nothing.
std::string why_no_circle(const EllipseFit &fit);

/// Rms of what an ellipse leaves that turns with the angle, of the radius: a sound sensor's
/// accuracy is 0.017 at its worst angle, and effects of the catalogue at their usual size leave
/// 0.007 at most. A triangle in the place of a sine leaves 0.11.
inline constexpr double kRoundness = 0.05;

/// Share of the samples off the ellipse: more than these is no matter of spikes.
inline constexpr double kMaxRejected = 0.10;

/// More samples off the ellipse than spikes account for: a step, or another fault in time.
void refuse_scattered(const Capture &capture, const EllipseFit &fit);

/// A channel that stops short of its peak. Near a peak of one channel the other one crosses
/// mid-scale and tells the angle, hence how the first should bend: the slope of measured against
/// expected volts is 1 when sound and 0 when clipped, and a clipped peak has no spread but noise.
std::string why_clipped(const Capture &capture, const EllipseFit &fit);

/// Throws the reason, if there is one.
void refuse(const std::string &why);

} // namespace ada

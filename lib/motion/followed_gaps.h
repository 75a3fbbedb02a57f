// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The motion between the stretches of a long recording that a diagnosis holds in memory: how far
// the pair turned there, told by the samples that are not held.
#pragma once

#include <span>
#include <vector>

#include "recording/recording.h"

namespace ada {

/// The samples before and after what is left out.
struct LeftOut {
  std::size_t before, after;
};

/// Middle and half range of the two channels: near enough to say on which side of the circle a
/// sample lies.
struct RoughCircle {
  double middle_sin_v, middle_cos_v, half_sin_v, half_cos_v;
  explicit RoughCircle(const Capture &some);
};

/// Electrical angle, rad, by which the pair turns in each of these, ascending and apart: one pass
/// over the recording.
std::vector<double> turned_in(const Recording &recording, const RoughCircle &circle,
                              std::span<const LeftOut> left_out);

/// Adds to an angle that was unwrapped over `period` the whole periods that went by in the gaps of
/// its capture, where Capture::turned_rad tells them.
void follow_through_gaps(const Capture &capture, double period, std::span<double> angle);

} // namespace ada

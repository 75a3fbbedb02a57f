// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A record that is read faster than its converter converts holds each pair for several rows. Those
// are no readings of their own: beside a reference that goes on they trail it in a saw tooth.
#pragma once

#include <optional>

#include "recording/capture.h"

namespace ada {

struct FreshReadings {
  Capture capture;             ///< the first row of each reading
  double rows_a_reading = 1.0; ///< mean
  bool of_reference = false;   ///< of the reference alone: the pair goes on between them
};

/// The readings of a capture that holds each pair for the same number of rows, or for two numbers
/// next to each other; nothing where rows are readings. A coarse converter before a slow shaft
/// repeats values as well, but not evenly, and one channel at a time. A reference that is read less
/// often than the pair trails it in the same way: the rows in which it is fresh are the readings.
std::optional<FreshReadings> fresh_readings(const Capture &capture);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A record that is read faster than its converter converts holds each pair for several rows. Those
// are no readings of their own: beside a reference that goes on they trail it in a saw tooth.
#pragma once

#include <optional>
#include <vector>

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

/// Rows here and there that repeat the reading before them.
struct StaleRows {
  std::size_t count = 0;
  double squares_v2 = 0.0; ///< of how far the pair had gone on, both channels, V^2
  StaleRows &operator+=(const StaleRows &more) {
    count += more.count;
    squares_v2 += more.squares_v2;
    return *this;
  }
};

/// Takes rows out of `usable` in which both channels are those of the row before, to the last bit,
/// where that happens far more often than a converter of this step would have it by chance, at the
/// pace and the noise of the rows around: the reading is not of that moment.
StaleRows leave_out_stale_rows(const Capture &capture, std::vector<char> &usable);

} // namespace ada

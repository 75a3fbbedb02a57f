// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Stretches of rows that are not of their moment, as the values themselves prove it: a reference
// that keeps its value while the pair turns, and blocks of rows that a driver delivered twice.
#pragma once

#include <cstddef>
#include <vector>

#include "recording/capture.h"

namespace ada {

struct RowRange {
  std::size_t first = 0, end = 0;
  std::size_t size() const { return end - first; }
};

/// Rows in which the reference keeps its value, but for its noise, while the pair goes on by
/// several times as far as it does for nearly all other values of the reference, and by several
/// times as many rows; then it catches up at once, or the record ends: a counter that is read
/// before a transfer is done, a cable, an encoder without power. A reference of few lines holds its
/// values as far alike, and one that is read less often than the pair as long. Without those where
/// the record, or a record of several, begins or goes on after a gap. O(samples).
std::vector<RowRange> held_reference(const Capture &capture);

/// Rows that are those of an earlier block, both channels to the last bit, in the same order, and
/// between which and the rows beside them the pair leaves its course: a buffer that was delivered
/// twice, or read before it was filled. No noise repeats itself so; of coarse readings chance makes
/// ever fewer of the longer runs, and a motion that comes again without noise leaves no course.
/// O(samples).
std::vector<RowRange> repeated_blocks(const Capture &capture);

/// All rows of them.
std::size_t rows_of(const std::vector<RowRange> &ranges);

} // namespace ada

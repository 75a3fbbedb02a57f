// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Time stamps of a host that wakes up late, and at times before it should, while the converter
// reads at an even clock: the pair goes on evenly from row to row, and unevenly by the stamps.
#pragma once

#include <optional>

#include "recording/capture.h"

namespace ada {

struct EvenRows {
  Capture capture;    ///< with the times of an even clock
  double rms_s = 0.0; ///< of the stamps against it
  double rms_v = 0.0; ///< what they would make of each channel
};

/// A capture by the number of its rows, where these tell the motion better than their stamps do,
/// and the stamps come back to one even clock. Nothing where the stamps are as good, where a stamp
/// shows rows that are missing, and of several records.
std::optional<EvenRows> even_rows(const Capture &capture);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A capture played back as a Source.
#pragma once

#include <memory>

#include "acquisition/source.h"
#include "recording/capture.h"

namespace ada {

inline constexpr double kMostSpeed = 1e6; ///< of a replay

/// Shares the capture. Each frame comes `speed` times as fast as it was recorded, 0: as fast as it
/// is read. start() begins anew. Gaps that the capture marks are counted in statistics().
std::unique_ptr<Source> make_recording_source(std::shared_ptr<const Capture> capture,
                                              double speed = 0.0);

/// Throws Error(ADA4571_ERROR_INVALID_ARGUMENT) unless it is in (0, kMostSpeed].
void check_speed(double speed);

} // namespace ada

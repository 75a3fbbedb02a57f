// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Samples that stand alone: a moment before and after them everything is as it was.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calibration/ellipse_fit.h"
#include "recording/capture.h"

namespace ada::health {

/// Of the pair. With an ellipse as distance from it and as angle about it, both in volts: neither
/// moves much from sample to sample, however fast the magnet turns. Without, channel by channel.
std::vector<std::size_t> pair_spikes(const Capture &capture,
                                     const std::optional<EllipseFit> &ellipse);

/// Of one column that changes slowly.
std::vector<std::size_t> column_spikes(std::span<const double> column);

} // namespace ada::health

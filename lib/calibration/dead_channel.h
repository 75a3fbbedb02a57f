// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Channels that do not move, or not with the magnet.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace ada {

/// A channel that moves less than this part of the other channel's travel is stuck.
inline constexpr double kStuckRatio = 0.02;

/// Distance between the 1 % and 99 % points: a few spikes do not count as motion.
double travel(const std::vector<double> &v);

/// First sample of a stretch in which `v` stays put while `other` crosses most of its travel;
/// nothing when there is none. On a circle no channel can: its peak is flat only for a short part
/// of the other's way.
std::optional<std::size_t> stuck_from(const std::vector<double> &v, double own_travel,
                                      const std::vector<double> &other, double other_travel);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Channels that do not move, or not with the magnet.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace ada {

/// A channel that moves less than this part of the other channel's travel is stuck.
inline constexpr double kStuckRatio = 0.02;

/// Distance from end to end of the bulk (base/robust.h): a few spikes do not count as motion.
double travel(const std::vector<double> &v);

/// A stretch in which one channel stays put while the other moves on.
struct Stuck {
  std::size_t first = 0;   ///< sample with which the first such stretch begins
  std::size_t samples = 0; ///< in all such stretches together
};

/// One of them: samples from `first` to before `end`, those that are no numbers included.
struct StuckStretch {
  std::size_t first = 0, end = 0, samples = 0;
};

/// The stretches in which `v` stays within kStuckRatio of its travel while the other channel
/// crosses half of its own. On a circle none can: a channel stays within 2 % of its travel only
/// about its peak, for 16 electrical degrees to either side, and the other crosses 28 % of its
/// travel then. Two thirds of the samples must span that half, so that up to a sixth of them may be
/// wild on either side, and a stretch holds 20 samples at least, of which three are less than a
/// sixth. And most of `v` there stays within what a stop leaves, a quarter of kStuckRatio or noise:
/// beside noise, or a signal of several periods, a sound channel's peaks would look like stops.
std::vector<StuckStretch> each_stuck_stretch(std::span<const double> v, double own_travel,
                                             std::span<const double> other, double other_travel);
/// The first of them, and how long they are together; nothing where there is none.
std::optional<Stuck> stuck_stretches(const std::vector<double> &v, double own_travel,
                                     const std::vector<double> &other, double other_travel);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What is held out of every fit. The parts that judge must be like the parts that train in speed,
// direction, temperature and time, and unlike them in noise: the unit that is held out fits the
// capture.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "recording/capture.h"

namespace ada {

enum class HoldoutUnit {
  turns,   ///< whole turns, where there are many
  periods, ///< whole electrical periods: a ring of many poles turned a few times
  records, ///< whole captures of several
  stops,   ///< whole stops of a shaft that stands while it is read
  arcs,    ///< runs of a few samples: a part of a turn, a single one, a few by hand
};

/// A shaft that stands in nearly all samples and moves between a few of them.
struct Stops {
  std::vector<std::uint32_t> of; ///< number of the stop of each sample, ascending; empty: none
  std::size_t count = 0;
  explicit operator bool() const { return count > 0; }
};

/// `alpha`: unwrapped mechanical angle, rad; `noise_rad`: what it scatters by at rest.
Stops find_stops(std::span<const double> alpha, double noise_rad);
/// The same of a capture by its reference, unwrapped, where the pair stands at them as well: a
/// reference that is read now and then stands while the shaft goes on.
Stops find_stops(const Capture &capture, std::span<const double> reference_rad);

struct Holdout {
  HoldoutUnit unit = HoldoutUnit::turns;
  std::vector<std::uint32_t> train, heldout; ///< places in the columns given, ascending
};

/// Every third unit judges, the others train. Units of motion are counted by travel, so that every
/// speed and direction lends its share to both parts.
Holdout hold_out(std::span<const double> alpha, int periods, const Stops &stops);

} // namespace ada

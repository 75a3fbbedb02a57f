// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// How large a jump of an angle over time is, once its place is known.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace ada {

struct Gap {
  double size = 0.0, error = 0.0; ///< rad
  double speed = 0.0;             ///< rad/s, at the jump
};

/// The gap at sample `at` of an angle that turns with constant acceleration on both sides, from as
/// many samples as that fits: the error falls with their number. `usable` 0: not to be used.
/// Without enough samples `error` is 0.
Gap gap_at(std::span<const double> time, std::span<const double> angle,
           std::span<const char> usable, std::size_t at);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// An angle that is read in coarse steps, between the steps.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace ada {

/// The plainest motion that agrees with the readings of an unwrapped angle to within half of `step`
/// (rad) each: a spline whose pieces are halved where one does not. Where a shaft turns through
/// many steps it is far closer to it than the readings are. Nothing where no piece that holds
/// enough readings agrees: then the step is not all that a reading is off by.
std::optional<std::vector<double>> between_steps(std::span<const double> time,
                                                 std::span<const double> angle,
                                                 std::span<const char> usable, double step);

} // namespace ada

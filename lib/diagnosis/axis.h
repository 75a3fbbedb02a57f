// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The axes of the budget.
#pragma once

#include <cstddef>
#include <string_view>

namespace ada {

/// Where a discrepancy lives, in the order in which the budget asks: each axis holds what none
/// before it explains.
enum class Axis { angle, speed, temperature, supply, time, frequency, noise };
inline constexpr std::size_t kAxes = 7;

std::string_view axis_name(Axis axis);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Rows of a table with a number that was typed wrong.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "recording/capture.h"

namespace ada {

/// Single wild rows of a short table against a reference, a number that was typed wrong: among so
/// few one alone is where the bulk ends, and many harmonics would follow it. Held against what all
/// but they leave of the lowest orders, as far as those tell what is there, and with a gap below
/// them.
/// `angle`: of the reference, rad; `usable`: 0 where a row does not count. Their places.
std::vector<std::size_t> wild_rows(const Capture &c, std::span<const char> usable,
                                   const std::vector<double> &angle);

} // namespace ada

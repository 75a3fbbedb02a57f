// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What a reference shows against the pair of signals and against time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace ada {

/// Rows, three side by side at most, in which a reference leaves both its neighbours and the angle of
/// the pair: a bit error, a reading that was missed, or a mean taken across the wrap. None where more
/// than one row in ten is so: what is not rare is structure.
struct RowsApart {
  std::vector<std::uint32_t> rows;
  std::vector<double> by_rad; ///< of each, how far
};

/// `reference` as it is read, within a turn, and the unwrapped angle of the pair, both rad and
/// mechanical; `step`: the resolution of the reference, rad. Puts what lies between its neighbours
/// into those rows.
RowsApart mend_rows(std::vector<double> &reference, std::span<const double> pair, double step);

/// Ripple of one order against smooth time, a cos(n alpha) + b sin(n alpha), rad, with the standard
/// error of either from its scatter between parts of the record.
struct Ripple {
  double cos = 0.0, sin = 0.0, error = 0.0;
};

/// Of an unwrapped angle, orders 1 to `orders` of the turn; empty where fewer than three parts have
/// enough turns. A rough motion makes the errors large, which says that it proves nothing.
std::vector<Ripple> ripples_against_time(std::span<const double> time,
                                         std::span<const double> angle,
                                         std::span<const char> usable, int orders);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Edges: what changes from one sample to the next and stays so. What a field, a bridge or a chain
// makes of the angle is smoother, so an edge tells of an event where the shaft came round once, or
// not even that.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace ada {

struct Edge {
  std::size_t at;       ///< the first sample behind it
  double first, second; ///< what the two columns change by
};

/// Samples on either side that straight lines are laid through: a quarter of a wave of the highest
/// order of the turn that a named cause may have, where a capture of so many samples holds so many
/// rounds; no fewer than kFewestOfEdge.
std::size_t reach_of_edges(std::size_t samples, double rounds, int periods_per_turn);
inline constexpr std::size_t kFewestOfEdge = 8;

/// The sharpest edges of two columns of one length, of some thousand samples, the largest first, at
/// places about which the shaft turns in one sense, which at rest is that of the way there. An edge
/// stands out by criteria::kJump of what the lines on either side are usually apart, is as large
/// however short they are, down to where noise hides it, and is not undone by another beside it.
/// Time in proportion to the length.
std::vector<Edge> find_edges(std::span<const double> time, std::span<const double> first,
                             std::span<const double> second, std::span<const signed char> sense,
                             std::size_t reach, std::size_t most);

} // namespace ada

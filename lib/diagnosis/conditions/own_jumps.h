// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Jumps of the pair's own angle from one reading to the next: no shaft turns so.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "recording/capture.h"

namespace ada {

struct OwnJumps {
  std::size_t forward = 0, backward = 0;
  double largest_rad = 0.0, first_s = 0.0, squares_rad2 = 0.0; ///< mechanical; the sum over all
  std::vector<std::uint32_t> rows; ///< of the capture, rising: the first on the other side of each
  std::size_t even = 0;            ///< of them, those about which the shaft goes on evenly
  OwnJumps &operator+=(const OwnJumps &more) {
    first_s = forward + backward != 0 ? first_s : more.first_s;
    forward += more.forward;
    backward += more.backward;
    even += more.even;
    largest_rad = std::max(largest_rad, more.largest_rad);
    squares_rad2 += more.squares_rad2;
    const bool rising = rows.empty() || more.rows.empty() || rows.back() <= more.rows.front();
    rows.insert(rows.end(), more.rows.begin(), more.rows.end());
    if (!rising)
      std::sort(rows.begin(), rows.end());
    return *this;
  }
  /// From places among some rows of the capture to these.
  void number_by(std::span<const std::uint32_t> of_capture) {
    for (std::uint32_t &at : rows)
      at = of_capture[at];
  }
  /// Rows that are lost let the angle jump in one sense only.
  bool to_and_fro() const { return forward != 0 && backward != 0; }
  /// Beside a motion that is followed every jump without a name is worth a word. Where the angle is
  /// the pair's own one alone may be a jerk of the hand, unless the shaft has the same speed up to
  /// it and from it on.
  bool count_as_structure(bool radius_only) const {
    return forward + backward > (radius_only && even == 0 ? 1 : 0);
  }
};

/// Steps of an unwrapped angle, rad, that differ from those around them by far more than these do
/// among themselves, and than a shaft changes its speed from one to the next, at an even clock.
/// `of_counts`: by how much one count of each converter turns the angle, rad, at each sample; what
/// two of them do is no jump. With `spared` only at samples that are not of them: where a smooth
/// motion leaves out what it cannot follow, that has to be said.
OwnJumps own_jumps(std::span<const double> time, std::span<const double> angle,
                   std::span<const double> of_counts, std::span<const char> spared = {});

/// The same of the pair as it was read, about its centre, at some rows of the capture; with the
/// recorded supply divided out where the outputs follow it.
OwnJumps own_jumps(const Capture &capture, std::span<const std::uint32_t> rows, double centre_sin_v,
                   double centre_cos_v, bool at_one_supply);

/// By how much one count of each converter turns the mechanical angle of a pair about its centre,
/// rad, at each sample; none where the readings show no counts, half a period at the centre itself.
std::vector<double> turned_by_counts(const std::vector<double> &vsin_v,
                                     const std::vector<double> &vcos_v, double centre_sin_v,
                                     double centre_cos_v, int periods_per_turn);

} // namespace ada

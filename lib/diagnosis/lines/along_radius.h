// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <span>
#include <vector>

#include "diagnosis/lines/spectrum.h"
#include "model/residual.h"

namespace ada {

/// Along the radius alone a tone is two lines, one on either side of the pair's frequency, which
/// follow the pair's speed; a gain that swings is one that stands still, and two in the channels. A
/// tone that turns, seen from a pair of one speed, is such a gain.
class AlongRadius {
public:
  /// Keeps `r` by reference.
  explicit AlongRadius(const Residual &r);

  /// Whether the residual says little across the vector: nothing is left there where the angle is
  /// the pair's own, and not much where the motion is hardly known.
  bool is_most() const;

  /// Whether the line at a frequency in Hz is a gain that swings, or no more a tone than that.
  /// `slow`: from the pair one of a tone's two lines lies where whatever changes slowly does.
  bool is_gain(double frequency, bool slow) const;

private:
  template <int N, class Columns>
  double taken(std::span<const double> sine, std::span<const double> cosine, Columns columns) const;
  template <int N, class Columns> double most_taken(double frequency, Columns columns) const;
  double of_tone(double frequency) const;
  double strongest_of_gain(double from_hz, double to_hz) const;

  const Residual &r_;
  std::vector<double> cos_, sin_, along_;
  double fastest_hz_ = 0.0, along_v2_ = 0.0, across_v2_ = 0.0;
  PowerOverTime spectrum_;
};

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// How a line stands to the turning pair: whether it is a tone, or a gain or an angle that swings
// and so comes with the pair.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "diagnosis/lines/line.h"

namespace ada {

/// The residual as it would be if the model's pair drew a circle: what turns with the vector then
/// has two equal channels a quarter of a period apart, however unlike those of the pair are.
struct Rounded {
  std::array<std::vector<double>, 4> column;
  Residual view;

  explicit Rounded(const Residual &r);
};

/// The samples at the speed that the shaft has most, with the frequency of the pair there, Hz.
struct MostlyAt {
  std::vector<std::size_t> samples;
  double turning;
};

MostlyAt mostly_at(const Residual &r);

/// Whether the shaft turns both ways.
bool goes_to_and_fro(const Residual &r);

/// Whether a line rotates with the pair. Of a shaft that goes to and fro it does so one way and
/// then the other, which together is a line that stands: it is asked in one sense.
bool rotates_with_pair(const Residual &r, const MostlyAt &at, double frequency, const Line &line);

/// Whether a line that rotates is a gain or an angle that wanders: seen from the turning pair that
/// lies along the radius or across it, while a pickup turns about the pair and shows in both alike.
bool one_sided(const Residual &r, const MostlyAt &at, double frequency);

/// Whether a line has a fellow on the other side of the pair's own frequency: something then
/// modulates the pair, and neither is a tone.
bool has_fellow(const Residual &r, const MostlyAt &at, double frequency);

/// Whether for most of the record a frequency lies so near to that of the pair that from the
/// turning vector it is seen as a slow change of gain and angle, which what is slow in time holds
/// as well.
bool slow_beside_pair(const Residual &r, double frequency);

} // namespace ada

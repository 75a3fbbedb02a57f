// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <cstddef>

namespace ada {

/// Whether two angles turn the same way, 1, or each against the other, -1, as a pair does that is
/// mounted or wired the other way round. `a_step(i)`, `b_step(i)`: from row i to the next, of
/// `steps`. Most rows say so, and not the widest steps, which may be gaps; what is no number says
/// nothing.
template <class Step, class OtherStep>
double common_sense(std::size_t steps, Step a_step, OtherStep b_step) {
  double together = 0.0;
  for (std::size_t i = 0; i < steps; ++i) {
    const double both = a_step(i) * b_step(i);
    together += both > 0.0 ? 1.0 : both < 0.0 ? -1.0 : 0.0;
  }
  return together < 0.0 ? -1.0 : 1.0;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Bridges of AMR stripes in a field that does not saturate them.
#pragma once

#include <cstddef>

namespace ada {

/// The two channels (amplitude 1 where the field saturates) of a cosine bridge with stripes at 0 and
/// 90 degrees and a sine bridge at 45 and 135. A stripe with easy axis theta lies at phi, where
/// sin(alpha - phi) = (h/2) sin 2(phi - theta), h = Hk/H; its resistance goes with cos 2(phi - theta).
/// Solved to 1e-12 for h up to 0.5. `ex`, `ey`: cos 2alpha and sin 2alpha of the field's direction;
/// `fx`, `fy`: the field, for which `h` is given at magnitude 1. All of length n; c and s are written.
void balance_stripes(double h, const double *fx, const double *fy, const double *ex,
                     const double *ey, std::size_t n, double *c, double *s);

} // namespace ada

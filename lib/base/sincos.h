// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Sine and cosine of many numbers at once, by the best vector unit of the machine.
#pragma once

#include <cstddef>

namespace ada {

/// sine[i], cosine[i] of x[i], rad; within 4e-16 for |x| up to 1e8 (beyond: as exact as the
/// argument allows, about |x| * 1e-16). Not finite gives NaN. Either output may be x itself.
void sincos_of(const double *x, std::size_t n, double *sine, double *cosine);

} // namespace ada

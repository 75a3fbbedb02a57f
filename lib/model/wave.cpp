// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "model/wave.h"

#include <algorithm>

namespace ada {

namespace {
template <class T> void advance(T *&p, std::size_t by) {
  if (p)
    p += by;
}

/// (re, im) times (x, y), as complex numbers.
void multiply(std::size_t n, const double *x, const double *y, double *re, double *im) {
  for (std::size_t i = 0; i < n; ++i) {
    const double product = re[i] * x[i] - im[i] * y[i];
    im[i] = re[i] * y[i] + im[i] * x[i];
    re[i] = product;
  }
}
} // namespace

Conditions Conditions::slice(std::size_t first, std::size_t count) const {
  Conditions out = *this;
  out.n = count;
  for (const double **p : {&out.time, &out.alpha})
    advance(*p, first);
  for (const float **p :
       {&out.omega, &out.temp, &out.vtemp_scan, &out.supply, &out.supply_rate, &out.supply_bend})
    advance(*p, first);
  advance(out.accel, first);
  advance(out.direction, first);
  advance(out.travel, first);
  advance(out.moved, first);
  advance(out.temp_rate, first);
  return out;
}

void to_power(std::size_t n, unsigned power, double *x, double *y, double *re, double *im) {
  std::fill_n(re, n, 1.0);
  std::fill_n(im, n, 0.0);
  for (;;) {
    if ((power & 1u) != 0)
      multiply(n, x, y, re, im);
    if ((power >>= 1) == 0)
      break;
    for (std::size_t i = 0; i < n; ++i) {
      const double square = x[i] * x[i] - y[i] * y[i];
      y[i] *= 2.0 * x[i];
      x[i] = square;
    }
  }
}

} // namespace ada

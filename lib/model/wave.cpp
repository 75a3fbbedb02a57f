// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "model/wave.h"

namespace ada {

namespace {
template <class T> void advance(T *&p, std::size_t by) {
  if (p)
    p += by;
}

std::vector<Tap> convolve(const std::vector<Tap> &a, std::span<const Tap> b) {
  std::vector<Tap> out;
  out.reserve(a.size() * b.size());
  for (const Tap &x : a)
    for (const Tap &y : b)
      out.push_back({x.delay_s + y.delay_s, x.weight * y.weight});
  return out;
}
} // namespace

Conditions Conditions::slice(std::size_t first, std::size_t count) const {
  Conditions out = *this;
  out.n = count;
  for (const double **p : {&out.time, &out.alpha, &out.omega, &out.temp, &out.vtemp_scan})
    advance(*p, first);
  for (const float **p : {&out.supply, &out.supply_rate, &out.supply_bend})
    advance(*p, first);
  advance(out.accel, first);
  advance(out.direction, first);
  advance(out.travel, first);
  advance(out.temp_rate, first);
  return out;
}

void Taps::pass(std::span<const Tap> system) {
  sin = convolve(sin, system);
  cos = convolve(cos, system);
}

} // namespace ada

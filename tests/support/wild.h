// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Wild samples: single readings that have nothing to do with the signal.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "recording/capture.h"

namespace ada::test {

/// Puts `count` wild samples anywhere into the pair, one channel or both: at a rail, or off by
/// anything from a millivolt to a million volts. Returns their places, ascending.
inline std::vector<std::size_t> add_wild(Capture &capture, std::size_t count,
                                         std::mt19937_64 &rng) {
  std::uniform_int_distribution<std::size_t> anywhere(0, capture.size() - 1);
  std::uniform_real_distribution<double> decades(-3, 6);
  std::uniform_int_distribution<int> four(0, 3);
  std::vector<std::size_t> places;
  while (places.size() < count) {
    const std::size_t i = anywhere(rng);
    if (std::find(places.begin(), places.end(), i) != places.end())
      continue;
    places.push_back(i);
    const auto strike = [&](double &v) {
      const int kind = four(rng);
      const double off = std::pow(10.0, decades(rng));
      v = kind == 0 ? 0.0 : kind == 1 ? capture.meta.supply_v : kind == 2 ? v + off : v - off;
      v = std::clamp(v, -1e6, 1e6);
    };
    const int channels = four(rng);
    if (channels != 0)
      strike(capture.vsin_v[i]);
    if (channels != 1)
      strike(capture.vcos_v[i]);
  }
  std::sort(places.begin(), places.end());
  return places;
}

} // namespace ada::test

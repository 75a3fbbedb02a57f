// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Captures made of numbers that no converter gives: what a file may hold all the same, and beyond
// that what only a program can hand in.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "support/sensor_pair.h"

namespace ada::test {

/// One way to fill one column.
enum class Hostile {
  denormal,
  huge,
  constant,
  alternating, ///< between plus and minus the largest that a file may hold
  decreasing,
  equal_pairs,
  sprinkled, ///< a sound column with some values from all over the range
  not_finite,
  tiny, ///< a sound column, so small that its squares vanish
  vast, ///< and so large that little of a sample is left beside it
};
inline constexpr std::array kHostile = {
    Hostile::denormal,   Hostile::huge,        Hostile::constant,  Hostile::alternating,
    Hostile::decreasing, Hostile::equal_pairs, Hostile::sprinkled, Hostile::not_finite,
    Hostile::tiny,       Hostile::vast};
inline constexpr std::array kHostileColumns = {&Capture::time_s, &Capture::vsin_v,
                                               &Capture::vcos_v, &Capture::vtemp_v,
                                               &Capture::vdd_v,  &Capture::reference_deg};

inline std::string name_of(Hostile kind) {
  static const char *const names[] = {"denormal",   "huge",        "constant",  "alternating",
                                      "decreasing", "equal_pairs", "sprinkled", "not_finite",
                                      "tiny",       "vast"};
  return names[static_cast<int>(kind)];
}

inline double hostile_value(Hostile kind, std::size_t i, double sound, std::mt19937_64 &rng) {
  const auto x = static_cast<double>(i);
  const auto draw = [&rng](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(rng);
  };
  switch (kind) {
  case Hostile::denormal:
    return 5e-324 * x;
  case Hostile::huge:
    return 1e300 * draw(-1, 1);
  case Hostile::constant:
    return 1.25;
  case Hostile::alternating:
    return i % 2 ? 1e6 : -1e6;
  case Hostile::decreasing:
    return -sound;
  case Hostile::equal_pairs:
    return std::floor(x / 2) * 1e-4;
  case Hostile::sprinkled:
    return rng() % 10 ? sound : std::copysign(std::pow(10.0, draw(-320, 308)), draw(-1, 1));
  case Hostile::not_finite:
    return rng() % 3 ? sound : rng() % 2 ? std::nan("") : std::copysign(INFINITY, draw(-1, 1));
  case Hostile::tiny:
    return 1e-310 * sound;
  case Hostile::vast:
    return 1e12 * sound;
  }
  return sound;
}

/// A sound capture with every channel, of which the columns of the bit mask are filled that way.
inline Capture hostile_capture(Hostile kind, unsigned columns, std::size_t samples,
                               std::mt19937_64 &rng) {
  Capture c = Sampler(SensorPair{}, rng())
                  .capture(1000, static_cast<double>(samples) / 1000, constant_speed(2.3),
                           [](double t) { return 20 + t; });
  c.vdd_v.assign(c.size(), 5.0);
  c.meta.noise_rms_v = 0.0005;
  c.meta.adc_bits = 16;
  c.meta.adc_reference_v = 5.0;
  for (std::size_t k = 0; k < kHostileColumns.size(); ++k)
    if (columns >> k & 1u) {
      auto &column = c.*kHostileColumns[k];
      for (std::size_t i = 0; i < column.size(); ++i)
        column[i] = hostile_value(kind, i, column[i], rng);
    }
  return c;
}

} // namespace ada::test

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// Random numbers that are the same on every machine.
///
/// The standard fixes the bits of std::mt19937_64 but not what the distributions make of
/// them, and a seed that was printed here must hide the same effect elsewhere.

#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

namespace truth {

class Random {
public:
  /// \p stream separates uses of one seed, so that drawing one thing more in one place does
  /// not change everything drawn after it elsewhere.
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0)
      : engine_(mix(seed + 0x9e3779b97f4a7c15ULL * (stream + 1))) {}

  /// Uniform in [0, 1): the upper 53 bits.
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * unit(); }
  /// Evenly spread over the decades, for sizes.
  double log_uniform(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }
  bool chance(double probability) { return unit() < probability; }
  double sign() { return chance(0.5) ? 1.0 : -1.0; }
  /// 0 .. count-1.
  std::size_t index(std::size_t count) {
    return static_cast<std::size_t>(unit() * static_cast<double>(count));
  }
  template <class T> const T &pick(const std::vector<T> &from) { return from[index(from.size())]; }

  /// Standard normal (Box and Muller; the second value is kept for the next call).
  double normal() {
    if (have_spare_) {
      have_spare_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2.0 * std::log(1.0 - unit()));
    const double angle = 2.0 * std::numbers::pi * unit();
    spare_ = radius * std::sin(angle);
    have_spare_ = true;
    return radius * std::cos(angle);
  }

private:
  /// splitmix64: neighbouring seeds must not give related sequences.
  static std::uint64_t mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
  }

  std::mt19937_64 engine_;
  double spare_ = 0.0;
  bool have_spare_ = false;
};

} // namespace truth

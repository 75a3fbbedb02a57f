// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Linear dynamics before the sampler as a sum of delayed copies: out(t) = sum w_i in(t - d_i).
#pragma once

#include <span>
#include <vector>

namespace ada {

struct Tap {
  double delay_s, weight;
  bool operator==(const Tap &) const = default;
};

struct Taps {
  std::vector<Tap> sin{{0.0, 1.0}}, cos{{0.0, 1.0}};
  bool trivial() const {
    return sin.size() == 1 && cos.size() == 1 && sin[0].delay_s == 0.0 && cos[0].delay_s == 0.0;
  }
  /// Passes both channels through another such system.
  void pass(std::span<const Tap> system);
  /// As few copies as do the same, to a millionth, to signals of up to `fastest` rad/s and to what
  /// goes with the square of the delay: each copy costs the whole way from the magnet to the
  /// sampler.
  Taps fewest(double fastest) const;
  bool operator==(const Taps &) const = default;
};

} // namespace ada

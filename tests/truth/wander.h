// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// Random courses over time: walks, smooth wander, 1/f noise.

#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace truth {

class Random;

/// A random function of time by its values at even steps, straight lines in between.
class Track {
public:
  Track(double duration, std::vector<double> values)
      : step_(duration / static_cast<double>(values.size() - 1)), values_(std::move(values)) {}
  double operator()(double t) const {
    const double x = std::clamp(t / step_, 0.0, static_cast<double>(values_.size()) - 1.001);
    const auto i = static_cast<std::size_t>(x);
    return values_[i] + (x - static_cast<double>(i)) * (values_[i + 1] - values_[i]);
  }

private:
  double step_;
  std::vector<double> values_;
};

/// About a mean of zero, with the wanted rms; straight from point to point.
Track random_walk(Random &random, double duration, std::size_t points, double rms);

/// 1/f noise of the wanted rms, up to a twelfth of the points' rate; it falls faster above.
Track flicker(Random &random, double duration, std::size_t points, double rms);

/// A walk of a dozen steps with its corners rounded, so that all of it is slower than a tenth of
/// the duration; mean zero, the wanted rms.
Track smooth_walk(Random &random, double duration, double rms);

/// Slow changes of the sensor over a capture; nothing where not set.
struct Wander {
  using Course = std::function<double(double t)>;
  static double nothing(double) { return 0.0; }
  Course sine = nothing, cosine = nothing; // V, added to the offsets
  Course gain = nothing;                   // relative, of both amplitudes
};

} // namespace truth

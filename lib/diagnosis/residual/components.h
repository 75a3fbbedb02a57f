// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The residual as its tests look at it: by channel, along the vector and across it, and for how
// long its noise remembers itself.
#pragma once

#include <cmath>
#include <vector>

#include "base/angle.h"
#include "diagnosis/conditions/observations.h"
#include "diagnosis/search/fit.h"

namespace ada {

/// Components of the residual: VSIN, VCOS, radial, tangential.
struct Components {
  std::vector<double> of[4];
  std::vector<double> cos2, sin2; ///< of twice the electrical angle
  std::vector<int> judged; ///< without a reference only the radius is no matter of the motion
  /// Noise of each from sample to sample over that of a channel in the mean.
  double noise[4] = {1.0, 1.0, 1.0, 1.0};
};

Components components(const Scene &scene, const ResidualColumns &r);

/// How long noise remembers itself: a converter that averages, or a filter before it, makes it
/// alike in neighbouring samples. Its autocorrelation is what that of the residual has at short
/// lags above its plateau, as structure is still the same some samples later. White: nothing.
class Memory {
public:
  Memory(const Scene &scene, const Observations &data, const Components &split);

  /// Rms of noise that remembers itself, V; 0: it is white.
  double rms_v() const { return rms_v_; }
  /// Variance of a mean over that of as many independent samples.
  double of_means() const { return density(0.0); }
  /// The same of a mean of squares, whose correlation is the square.
  double of_squares() const {
    double out = 1.0;
    for (double r : correlation_)
      out += 2.0 * r * r;
    return out;
  }
  /// Power at a frequency, in cycles a sample, over that of white noise.
  double density(double cycles) const {
    double out = 1.0;
    for (std::size_t k = 0; k < correlation_.size(); ++k)
      out += 2.0 * correlation_[k] * std::cos(kTwoPi * cycles * static_cast<double>(k + 1));
    return std::max(out, kLeastDensity);
  }

private:
  Memory(const Observations &data, const std::vector<double> &noise);

  static constexpr double kLeastDensity = 0.05; ///< what few lags leave negative
  std::vector<double> correlation_;             ///< at lags 1, 2, ...
  double rms_v_ = 0.0;
};

} // namespace ada

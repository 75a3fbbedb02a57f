// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/extrema_method.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "base/angle.h"
#include "base/error.h"

namespace ada {

namespace {

/// Spread of the extreme of the samples near a peak, in sigmas: between 0.3 and 0.5 for tens to
/// thousands of samples (Gumbel).
constexpr double kExtremeSpread = 0.5;

struct Extremes {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
};

/// The samples with the noise of each held to what noise does: farther from the curve than the
/// largest of so many normal deviates, sqrt(2 ln n) sigmas, a sample counts as if it stood there
/// (winsorised). A spike just below the fit's own limit would else make an extreme of its own.
class Winsorised {
public:
  Winsorised(const Capture &capture, const EllipseFit &fit)
      : capture_(capture), inverse_(invert(fit.value)),
        band_(std::sqrt(2 * std::log(static_cast<double>(std::max<std::size_t>(fit.used, 2)))) *
              fit.residual_rms_v / fit.value.amplitude_v) {}

  /// VSIN and VCOS of sample i.
  std::pair<double, double> at(std::size_t i) const {
    const double vsin = capture_.vsin_v[i], vcos = capture_.vcos_v[i];
    const double radius = std::hypot(inverse_.sine(vsin, vcos), inverse_.cosine(vsin, vcos));
    if (!(std::abs(radius - 1) > band_))
      return {vsin, vcos};
    const double scale = std::clamp(radius, 1 - band_, 1 + band_) / radius;
    return {inverse_.centre_sin_v + scale * (vsin - inverse_.centre_sin_v),
            inverse_.centre_cos_v + scale * (vcos - inverse_.centre_cos_v)};
  }

private:
  const Capture &capture_;
  EllipseInverse inverse_;
  double band_; ///< of the relative radius
};

/// Mean of one figure over the pieces, and how well it is known.
class PieceMean {
public:
  void add(double v) {
    n_ += 1;
    const double d = v - mean_;
    mean_ += d / n_;
    square_ += d * (v - mean_);
  }
  double mean() const { return mean_; }
  /// What noise leaves, or what the pieces scatter by where that is more: few samples a period miss
  /// the peaks by more than noise moves them.
  double error(double noise_error) const {
    const double scatter = n_ > 1 ? std::sqrt(square_ / (n_ - 1) / n_) : 0.0;
    return std::max(noise_error, scatter);
  }

private:
  double n_ = 0, mean_ = 0, square_ = 0;
};

struct PeakSums {
  PieceMean offset_sin, offset_cos, amplitude_sin, amplitude_cos;
  double pieces = 0;
  void add(const Extremes &s, const Extremes &c) {
    offset_sin.add(0.5 * (s.high + s.low));
    offset_cos.add(0.5 * (c.high + c.low));
    amplitude_sin.add(0.5 * (s.high - s.low));
    amplitude_cos.add(0.5 * (c.high - c.low));
    pieces += 1;
  }
};

/// A capture of "one turn" ends one sample before it.
constexpr double kNearlyWhole = 0.98;

/// One pair of extremes for every `span` radians that the magnet goes on from the last piece.
PeakSums by_pieces(const Winsorised &samples, const AnglePath &path, double span) {
  PeakSums sums;
  Extremes s, c;
  double from = path.psi.front(), low = from, high = from;
  for (std::size_t i = 0; i < path.psi.size(); ++i) {
    const auto [vsin, vcos] = samples.at(path.sample[i]);
    s.add(vsin);
    c.add(vcos);
    low = std::min(low, path.psi[i]);
    high = std::max(high, path.psi[i]);
    // To and fro counts by the range that was seen, so every piece has seen both peaks.
    if (high - low >= kNearlyWhole * span) {
      sums.add(s, c);
      s = c = Extremes();
      low = high = path.psi[i];
    }
  }
  return sums;
}

} // namespace

void estimate_by_extrema(const Capture &capture, const EllipseFit &fit, PairEstimate &estimate) {
  const int p = capture.meta.periods_per_turn;
  const AnglePath path = unwrap(capture, fit);
  const Winsorised samples(capture, fit);
  PeakSums sums = by_pieces(samples, path, kTwoPi * p);
  if (sums.pieces == 0) // less than a mechanical turn: a period has both peaks, at least
    sums = by_pieces(samples, path, kTwoPi);
  if (sums.pieces == 0) {
    char text[160];
    const auto [low, high] = std::minmax_element(path.psi.begin(), path.psi.end());
    std::snprintf(text, sizeof text,
                  "the method extrema needs a whole electrical period, the capture holds %.2f; use "
                  "the method fit",
                  (*high - *low) / kTwoPi);
    throw Error(ADA4571_ERROR_UNUSABLE_DATA, text);
  }
  const double a_sin = sums.amplitude_sin.mean(), a_cos = sums.amplitude_cos.mean();
  EllipseParameters &e = estimate.value;
  e.amplitude_v = 0.5 * (a_sin + a_cos);
  e.centre_sin_v = sums.offset_sin.mean();
  e.centre_cos_v = sums.offset_cos.mean();
  const double noise = kExtremeSpread * fit.residual_rms_v / std::sqrt(2 * sums.pieces);
  const double both = std::hypot(sums.amplitude_sin.error(noise), sums.amplitude_cos.error(noise));
  const double k = (a_sin - a_cos) / e.amplitude_v, k_error = both / e.amplitude_v;
  estimate.has_mismatch = std::abs(k) > kSignificant * k_error;
  e.k = estimate.has_mismatch ? k : 0.0;
  e.delta_rad = 0;
  estimate.std_error = {0.5 * both, k_error, 0.0, sums.offset_sin.error(noise),
                        sums.offset_cos.error(noise)};
}

} // namespace ada

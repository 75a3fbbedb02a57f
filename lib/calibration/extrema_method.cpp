// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/extrema_method.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/angle.h"
#include "base/error.h"

namespace ada {

namespace {

constexpr double kSignificant = 5.0;
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

struct Sums {
  double offset_sin = 0, offset_cos = 0, amplitude_sin = 0, amplitude_cos = 0, pieces = 0;
  void add(const Extremes &s, const Extremes &c) {
    offset_sin += 0.5 * (s.high + s.low);
    offset_cos += 0.5 * (c.high + c.low);
    amplitude_sin += 0.5 * (s.high - s.low);
    amplitude_cos += 0.5 * (c.high - c.low);
    pieces += 1;
  }
};

/// A capture of "one turn" ends one sample before it.
constexpr double kNearlyWhole = 0.98;

/// One pair of extremes for every `span` radians that the magnet goes on from the last piece.
Sums by_pieces(const Capture &capture, const AnglePath &path, double span) {
  Sums sums;
  Extremes s, c;
  double from = path.psi.front(), low = from, high = from;
  for (std::size_t i = 0; i < path.psi.size(); ++i) {
    s.add(capture.vsin_v[path.sample[i]]);
    c.add(capture.vcos_v[path.sample[i]]);
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
  Sums sums = by_pieces(capture, path, kTwoPi * p);
  if (sums.pieces == 0) // less than a mechanical turn: a period has both peaks, at least
    sums = by_pieces(capture, path, kTwoPi);
  if (sums.pieces == 0) {
    char text[160];
    const auto [low, high] = std::minmax_element(path.psi.begin(), path.psi.end());
    std::snprintf(text, sizeof text,
                  "the method extrema needs a whole electrical period, the capture holds %.2f; use "
                  "the method fit",
                  (*high - *low) / kTwoPi);
    throw Error(ADA4571_ERROR_UNUSABLE_DATA, text);
  }
  const double a_sin = sums.amplitude_sin / sums.pieces, a_cos = sums.amplitude_cos / sums.pieces;
  EllipseParameters &e = estimate.value;
  e.amplitude_v = 0.5 * (a_sin + a_cos);
  e.centre_sin_v = sums.offset_sin / sums.pieces;
  e.centre_cos_v = sums.offset_cos / sums.pieces;
  const double error = kExtremeSpread * fit.residual_rms_v / std::sqrt(2 * sums.pieces);
  const double k = (a_sin - a_cos) / e.amplitude_v;
  const double k_error = std::sqrt(2.0) * error / e.amplitude_v;
  estimate.has_mismatch = std::abs(k) > kSignificant * k_error;
  e.k = estimate.has_mismatch ? k : 0.0;
  e.delta_rad = 0;
  estimate.std_error = {error / std::sqrt(2.0), k_error, 0.0, error, error};
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/mean_method.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/angle.h"
#include "base/error.h"

namespace ada {

namespace {

/// A path that ends less than this part of a turn short of its beginning is closed by a straight
/// step: a capture of "one turn" ends one sample before it.
constexpr double kClosable = 0.02;

/// Radians that a segment may span: the weights of its ends are exact for any sinusoid below half a
/// period, and grow without bound there. Where samples were left out, at a fast place, a segment
/// may be of more; and beyond 2 rad its ends tell little of what lies between.
constexpr double kLongestSegment = 3.0, kLongestGap = 2.0;
constexpr double kPieceOfGap = 0.5; ///< rad

/// The part of a path between its two turning points that are farthest apart.
struct Stretch {
  std::size_t first, last;
  double turns; ///< mechanical
};

Stretch longest_stretch(const AnglePath &path, int periods) {
  const auto [low, high] = std::minmax_element(path.psi.begin(), path.psi.end());
  const auto at = [&](auto it) { return static_cast<std::size_t>(it - path.psi.begin()); };
  return {std::min(at(low), at(high)), std::max(at(low), at(high)),
          (*high - *low) / (kTwoPi * periods)};
}

struct Moments {
  double sin = 0, cos = 0, sin_sin = 0, cos_cos = 0, sin_cos = 0; ///< about the present centre
};

/// Weights with which the products of a segment's ends give the integral of a product of two
/// sinusoids over its h radians: `same` for those of one end, `across` for those of both. Exact
/// whatever the step; h/3 and h/6, the integral of straight lines, where it is small.
struct SegmentWeights {
  double same, across;
  explicit SegmentWeights(double h) : same(h / 3), across(h / 6) {
    constexpr double small = 1e-3; // there both agree to h^2/15, and 1/sin^2 h costs digits
    if (std::abs(h) < small)
      return;
    const double s = std::sin(h), c = std::cos(h);
    same = (h - s * c) / (2 * s * s);
    across = (s - h * c) / (2 * s * s);
  }
};

/// Adds a segment of h radians to integrals.
void add_segment(Moments &m, double h, double s1, double c1, double s2, double c2) {
  const double w = 2 * std::tan(h / 2);
  const SegmentWeights of(h);
  m.sin += 0.5 * w * (s1 + s2);
  m.cos += 0.5 * w * (c1 + c2);
  m.sin_sin += of.same * (s1 * s1 + s2 * s2) + of.across * 2 * s1 * s2;
  m.cos_cos += of.same * (c1 * c1 + c2 * c2) + of.across * 2 * c1 * c2;
  m.sin_cos += of.same * (s1 * c1 + s2 * c2) + of.across * (s1 * c2 + s2 * c1);
}

/// The same of the ellipse itself, which is all that is known of a segment whose ends are far
/// apart.
void add_gap(Moments &m, double from, double h, const EllipseParameters &e) {
  const int pieces = static_cast<int>(std::ceil(std::abs(h) / kPieceOfGap));
  const auto s = [&](double psi) {
    return e.amplitude_v * (1 + e.k / 2) * std::sin(psi + e.delta_rad / 2);
  };
  const auto c = [&](double psi) {
    return e.amplitude_v * (1 - e.k / 2) * std::cos(psi - e.delta_rad / 2);
  };
  for (int i = 0; i < pieces; ++i) {
    const double a = from + h * i / pieces, b = from + h * (i + 1) / pieces;
    add_segment(m, b - a, s(a), c(a), s(b), c(b));
  }
}

/// Integrals over psi/(2 pi), along the path from its first point to `end` radians further on. A
/// segment of h radians of a sinusoid has the exact integral tan(h/2) (v1 + v2).
Moments integrate(const Capture &capture, const std::vector<std::size_t> &sample,
                  const std::vector<double> &psi, double end, const EllipseParameters &e) {
  Moments m;
  const double direction = end > psi.front() ? 1.0 : -1.0;
  for (std::size_t i = 0; i + 1 < psi.size(); ++i) {
    const double a = psi[i], b = psi[i + 1];
    const bool last = direction * (b - end) >= 0;
    // Weights of the two ends; the last segment ends between its samples.
    const double part = last && b != a ? (end - a) / (b - a) : 1.0;
    const double s1 = capture.vsin_v[sample[i]] - e.centre_sin_v;
    const double c1 = capture.vcos_v[sample[i]] - e.centre_cos_v;
    double s2 = capture.vsin_v[sample[i + 1]] - e.centre_sin_v;
    double c2 = capture.vcos_v[sample[i + 1]] - e.centre_cos_v;
    s2 = s1 + part * (s2 - s1);
    c2 = c1 + part * (c2 - c1);
    const double h = part * (b - a);
    const double most = sample[i + 1] - sample[i] == 1 ? kLongestSegment : kLongestGap;
    if (std::abs(h) <= most)
      add_segment(m, h, s1, c1, s2, c2);
    else
      add_gap(m, a, h, e);
    if (last)
      break;
  }
  const double range = end - psi.front();
  for (double *x : {&m.sin, &m.cos, &m.sin_sin, &m.cos_cos, &m.sin_cos})
    *x /= range;
  return m;
}

} // namespace

void estimate_by_mean(const Capture &capture, const EllipseFit &fit, PairEstimate &estimate) {
  const int p = capture.meta.periods_per_turn;
  const AnglePath path = unwrap(capture, fit);
  const Stretch stretch = longest_stretch(path, p);
  const double turns = std::floor(stretch.turns + kClosable);
  if (turns < 1) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "the method mean needs a whole mechanical turn, the capture holds %.2f; use the "
                  "method fit",
                  stretch.turns);
    throw Error(ADA4571_ERROR_UNUSABLE_DATA, text);
  }
  const std::vector<std::size_t> sample(
      path.sample.begin() + static_cast<std::ptrdiff_t>(stretch.first),
      path.sample.begin() + static_cast<std::ptrdiff_t>(stretch.last) + 1);

  EllipseParameters e;
  e.amplitude_v = fit.value.amplitude_v;
  e.centre_sin_v = 0.5 * capture.meta.supply_v;
  e.centre_cos_v = e.centre_sin_v;
  // An offset as large as the amplitude leaves no angle to integrate over: start near the middle.
  if (std::hypot(fit.value.centre_sin_v - e.centre_sin_v, fit.value.centre_cos_v - e.centre_cos_v) >
      0.5 * e.amplitude_v)
    e = {fit.value.amplitude_v, 0, 0, fit.value.centre_sin_v, fit.value.centre_cos_v};
  std::vector<std::size_t> closed = sample;
  closed.push_back(sample.front());
  const bool closing = stretch.turns < turns;
  const double n = static_cast<double>(sample.size());
  const double moment_error = std::sqrt(8 / n) * fit.residual_rms_v / e.amplitude_v;
  for (int round = 0; round < 60; ++round) {
    std::vector<double> psi = path_of(capture, sample, e).psi;
    const double end = psi.front() + std::copysign(kTwoPi * p * turns, psi.back() - psi.front());
    if (closing)
      psi.push_back(end);
    const Moments m = integrate(capture, closing ? closed : sample, psi, end, e);
    const double a_sin = std::sqrt(2 * (m.sin_sin - m.sin * m.sin));
    const double a_cos = std::sqrt(2 * (m.cos_cos - m.cos * m.cos));
    if (!(a_sin > 0 && a_cos > 0))
      throw Error(ADA4571_ERROR_UNUSABLE_DATA,
                  "the mean over the turns does not settle: use the method fit");
    const double before_sin = e.centre_sin_v, before_cos = e.centre_cos_v;
    e.centre_sin_v += m.sin;
    e.centre_cos_v += m.cos;
    e.amplitude_v = 0.5 * (a_sin + a_cos);
    const double k = (a_sin - a_cos) / e.amplitude_v;
    const double delta =
        std::asin(std::clamp(2 * (m.sin_cos - m.sin * m.cos) / (a_sin * a_cos), -0.9, 0.9));
    estimate.has_mismatch = std::abs(k) > kSignificant * moment_error;
    estimate.has_quadrature = std::abs(delta) > kSignificant * moment_error;
    e.k = estimate.has_mismatch ? k : 0.0;
    e.delta_rad = estimate.has_quadrature ? delta : 0.0;
    if (std::hypot(e.centre_sin_v - before_sin, e.centre_cos_v - before_cos) < 1e-9 * e.amplitude_v)
      break;
  }
  estimate.value = e;
  const double sigma = fit.residual_rms_v / std::sqrt(n);
  // Those of evenly spread samples; uneven speed makes them larger.
  estimate.std_error = {sigma, moment_error, moment_error, std::sqrt(2.0) * sigma,
                        std::sqrt(2.0) * sigma};
}

} // namespace ada

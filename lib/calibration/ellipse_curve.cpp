// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/ellipse_curve.h"

#include <algorithm>

#include "base/error.h"

namespace ada::ellipse {

namespace {

void hold_circle(Matrix5 &m, double diagonal) {
  for (const auto held : {kMismatch, kDelta}) {
    m.row(held).setZero();
    m.col(held).setZero();
    m(held, held) = diagonal;
  }
}

/// Scaled to a unit diagonal: volts and pure numbers then weigh alike in the factorisation.
Vector5 unit_diagonal(const Matrix5 &m) {
  return m.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
}

} // namespace

void Structure::judge(std::size_t free_parameters) {
  double n = 0, occupied = 0, between = 0, count_square = 0;
  for (std::size_t b = 0; b < kBins; ++b)
    if (count[b] > 0) {
      n += count[b];
      occupied += 1;
      between += sum[b] * sum[b] / count[b];
      count_square += count[b] * count[b];
    }
  const double freedom = occupied - static_cast<double>(free_parameters);
  variance = noise_variance = 0;
  if (freedom < 4 || n <= occupied + 4)
    return;
  noise_variance = std::max(square - between, 0.0) / (n - occupied);
  // Under noise alone `between` is noise_variance times a chi-square of `freedom`: believe in
  // structure only five standard deviations above that, so that white data keep equal weights.
  const double excess = between - freedom * noise_variance;
  if (excess > 5 * std::sqrt(2 * freedom) * noise_variance)
    variance = excess / (n - count_square / n);
}

double Structure::weight(std::size_t bin) const {
  return noise_variance > 0 ? 1 / (1 + count[bin] * variance / noise_variance)
                            : 1 / std::max(count[bin], 1.0);
}

Vector5 solve(const Matrix5 &information, const Vector5 &gradient, double damping, bool circle) {
  Matrix5 m = information;
  m.diagonal() *= 1 + damping;
  Vector5 g = gradient;
  if (circle) {
    hold_circle(m, 1);
    g[kMismatch] = g[kDelta] = 0;
  }
  const Vector5 scale = unit_diagonal(m);
  const Vector5 x =
      (scale.asDiagonal() * m * scale.asDiagonal()).ldlt().solve(scale.cwiseProduct(g));
  return scale.cwiseProduct(x);
}

double heldout_rms(const Shares &shares, double amplitude_v, bool circle) {
  constexpr double kFewest = 3 * 5; // of a part, as a fit needs them
  // Of the amplitude: what is left out is of second order in it. An arc that one part alone shows
  // makes the other two no curve, and this no step.
  constexpr double kFarthest = 0.05;
  Share all;
  for (const Share &s : shares) {
    all.weighed_information += s.weighed_information;
    all.weighed_gradient += s.weighed_gradient;
    all.count += s.count;
  }
  double square = 0;
  for (const Share &s : shares) {
    if (s.count < kFewest)
      return 0;
    const Vector5 step = solve(all.weighed_information - s.weighed_information,
                               all.weighed_gradient - s.weighed_gradient, 0, circle);
    Vector5 relative = step;
    for (const auto volts : {kAmplitude, kCentreSin, kCentreCos})
      relative[volts] /= amplitude_v;
    if (!(relative.cwiseAbs().maxCoeff() < kFarthest)) // no number either
      return 0;
    square += s.square - 2 * step.dot(s.gradient) + step.dot(s.information * step);
  }
  return square > 0 ? std::sqrt(square / all.count) : 0;
}

EllipseParameters moved(const EllipseParameters &e, const Vector5 &step) {
  EllipseParameters m = e;
  m.amplitude_v += step[kAmplitude];
  m.k += step[kMismatch];
  m.delta_rad += step[kDelta];
  m.centre_sin_v += step[kCentreSin];
  m.centre_cos_v += step[kCentreCos];
  return m;
}

bool valid(const EllipseParameters &e) {
  return std::isfinite(e.amplitude_v + e.k + e.delta_rad + e.centre_sin_v + e.centre_cos_v) &&
         e.amplitude_v > 0 && std::abs(e.k) < 1.9 && std::abs(e.delta_rad) < 1.4;
}

void describe(EllipseFit &fit, const EllipseParameters &curve, Matrix5 information,
              const Structure &structure, bool circle) {
  fit.free_parameters = circle ? 3 : 5;
  const double freedom = static_cast<double>(fit.used) - static_cast<double>(fit.free_parameters);
  const double variance = structure.square / std::max(freedom, 1.0);
  fit.residual_rms_v = std::sqrt(variance);
  const double noise = fit.structure_rms_v > 0 ? structure.noise_variance : variance;
  fit.value = curve;
  fit.value.amplitude_v -= 0.5 * noise / curve.amplitude_v; // curvature, see ellipse_fit.h
  Eigen::Map<Eigen::Matrix<double, 5, 5, Eigen::RowMajor>> out(fit.covariance.data());
  const Vector5 scale = unit_diagonal(information);
  if (circle)
    hold_circle(information, 1);
  const Matrix5 scaled = scale.asDiagonal() * information * scale.asDiagonal();
  // With bins of unequal weight the weights already are noise/(variance of the bin mean) / n.
  Matrix5 covariance = scale.asDiagonal() * scaled.ldlt().solve(Matrix5::Identity()) *
                       scale.asDiagonal() * std::max(noise, 1e-300);
  if (circle)
    hold_circle(covariance, 0);
  out = covariance;
}

void describe_coverage(EllipseFit &fit, const std::array<bool, kCoverageBins> &seen) {
  std::size_t longest = 0, run = 0, begin = 0;
  for (std::size_t i = 0; i < 2 * kCoverageBins; ++i) {
    run = seen[i % kCoverageBins] ? 0 : run + 1;
    if (run > longest) {
      longest = run;
      begin = i + 1;
    }
  }
  longest = std::min(longest, kCoverageBins);
  constexpr double bin_deg = 360.0 / kCoverageBins;
  fit.coverage_deg = 360.0 - bin_deg * static_cast<double>(longest);
  constexpr auto apart = static_cast<std::size_t>(kDirectionDeg / bin_deg);
  fit.directions = 0;
  for (std::size_t i = 0; i + apart <= kCoverageBins;)
    if (seen[(begin + i) % kCoverageBins]) {
      ++fit.directions;
      i += apart;
    } else {
      ++i;
    }
}

void no_ellipse(const std::string &why) {
  throw Error(ADA4571_ERROR_UNUSABLE_DATA, "no ellipse can be fitted: " + why);
}

} // namespace ada::ellipse

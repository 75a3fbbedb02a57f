// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What the fit of samples and that of whole recordings share: the ellipse near a sample, the normal
// equations, and what their residual shows. Eigen stays in here and in the files of the fits.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Dense>

#include "base/angle.h"
#include "calibration/ellipse_fit.h"

namespace ada::ellipse {

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

inline constexpr std::size_t kBins = 72; ///< of psi, for the structure of the residual
inline constexpr std::size_t kCoverageBins = 360;
inline constexpr double kSigmaPerMad = 1.482602218505602; ///< of a Gaussian

/// One sample against the curve.
struct FootPoint {
  double distance; ///< outward, volts
  Vector5 normal;  ///< n . df/dtheta
  double sin_psi, cos_psi;
};

/// The curve at one set of parameters, compiled for many samples.
class Curve {
public:
  explicit Curve(const EllipseParameters &e)
      : e_(e), inverse_(invert(e)), cos_h_(std::cos(e.delta_rad / 2)),
        sin_h_(std::sin(e.delta_rad / 2)) {}

  FootPoint foot(double vsin, double vcos) const {
    const double y = inverse_.sine(vsin, vcos), x = inverse_.cosine(vsin, vcos);
    const double r = std::sqrt(x * x + y * y);
    return at(r > 0 ? y / r : 0.0, r > 0 ? x / r : 1.0, r);
  }

  /// At a relative radius: with psi held, a sample moves along a straight line from the centre, so
  /// that its distance is that of the radius from 1, times amplitude and normal[kAmplitude].
  FootPoint at(double sin_psi, double cos_psi, double radius) const {
    FootPoint p;
    p.sin_psi = sin_psi;
    p.cos_psi = cos_psi;
    const double s = sin_psi * cos_h_ + cos_psi * sin_h_; // sin(psi + h)
    const double c = cos_psi * cos_h_ + sin_psi * sin_h_; // cos(psi - h)
    const double ds = cos_psi * cos_h_ - sin_psi * sin_h_;
    const double dc = -sin_psi * cos_h_ + cos_psi * sin_h_;
    const double a = e_.amplitude_v, gs = 1 + e_.k / 2, gc = 1 - e_.k / 2;
    const double ts = gs * ds, tc = gc * dc;
    const double length = std::sqrt(ts * ts + tc * tc); // of order 1: nothing to overflow
    const double ns = -tc / length, nc = ts / length;
    p.normal[kAmplitude] = ns * gs * s + nc * gc * c;
    p.normal[kMismatch] = 0.5 * a * (ns * s - nc * c);
    p.normal[kDelta] = 0.5 * a * (ns * gs * ds - nc * gc * dc);
    p.normal[kCentreSin] = ns;
    p.normal[kCentreCos] = nc;
    p.distance = a * (radius - 1) * p.normal[kAmplitude];
    return p;
  }

private:
  EllipseParameters e_;
  EllipseInverse inverse_;
  double cos_h_, sin_h_;
};

/// Sums of the residual in bins of psi, and what they show.
struct Structure {
  std::array<double, kBins> count{}, sum{};
  double square = 0;         ///< of all distances
  double variance = 0;       ///< of the bin means, beyond what noise explains
  double noise_variance = 0; ///< within bins

  /// From the sums to the variances.
  void judge(std::size_t free_parameters);
  /// Weight of a bin in the fit: a random effect of `variance` in each bin, so that one of n
  /// samples carries the information 1/(variance + noise/n) rather than n/noise.
  double weight(std::size_t bin) const;
};

/// The step to the minimum; rows of k and d held where only a circle is fitted.
Vector5 solve(const Matrix5 &information, const Vector5 &gradient, double damping, bool circle);
EllipseParameters moved(const EllipseParameters &e, const Vector5 &step);
bool valid(const EllipseParameters &e);

/// What one part of the samples gives to a fit of all: normal equations under the weights of the
/// fit, and the same without weights with the sum of squares, about one curve.
struct Share {
  Matrix5 weighed_information = Matrix5::Zero(), information = Matrix5::Zero();
  Vector5 weighed_gradient = Vector5::Zero(), gradient = Vector5::Zero();
  double square = 0, count = 0;
};
inline constexpr std::size_t kParts = 3;      ///< of the samples, for a fit without each in turn
inline constexpr std::size_t kStretches = 30; ///< of the record, every third of which is one part
/// Which of them a sample lies in, of more samples than stretches.
inline std::size_t stretch_of(std::size_t sample, std::size_t samples) {
  return sample * kStretches / samples;
}
inline std::size_t stretch_begin(std::size_t stretch, std::size_t samples) {
  return (stretch * samples + kStretches - 1) / kStretches;
}
using Shares = std::array<Share, kParts>;

/// Rms distance of all samples, each from the curve that is fitted to the other parts: from the
/// normal equations, exact to first order in how far the curve moves. 0: too few to say it, or a
/// part holds what the others do not know.
double heldout_rms(const Shares &shares, double amplitude_v, bool circle);

/// Fills value, covariance and residual of a fit that is done: from its curve, the information of
/// the samples under their weights, and their residual.
void describe(EllipseFit &fit, const EllipseParameters &curve, Matrix5 information,
              const Structure &structure, bool circle);

/// What of the circle holds samples: all but the longest stretch without, and how many angles
/// kDirectionDeg apart can be picked from it, going round from the end of that stretch.
void describe_coverage(EllipseFit &fit, const std::array<bool, kCoverageBins> &seen);

[[noreturn]] void no_ellipse(const std::string &why);

} // namespace ada::ellipse

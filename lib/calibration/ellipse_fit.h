// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Maximum-likelihood fit of the ellipse of conversion/ellipse.h to pairs of samples.
//
// Model: v_i = f(psi_i; theta) + n_i with theta = (A, k, d, C_sin, C_cos), white Gaussian noise of
// equal variance sigma^2 in both channels, and every psi_i unknown: neither a time base, nor a
// constant speed, nor a full turn is assumed. Maximising over psi_i leaves the distance of the
// sample from the curve,
//
//   e_i(theta) = n(psi_i) . (v_i - f(psi_i; theta)),     de_i/dtheta = -n(psi_i) . df/dtheta,
//
// with n the unit normal at the foot point. psi_i is taken from the closed inverse of the ellipse;
// it differs from the foot point by second order in e_i / A, which changes e_i by third order.
// The Fisher information of theta, psi_i eliminated, is sum J_i^T J_i / sigma^2, J_i =
// -de_i/dtheta: its inverse is both the Cramer-Rao bound and the covariance that is reported. For N
// samples spread evenly: var C = 2 sigma^2/N, var A = sigma^2/N, var k = var d = 8 sigma^2/(A^2 N).
//
// Second order: noise pushes the mean distance outward by sigma^2/(2 A), which is taken off.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "conversion/ellipse.h"

namespace ada {

/// Order of the parameters in covariances and gradients.
enum EllipseIndex : std::size_t { kAmplitude, kMismatch, kDelta, kCentreSin, kCentreCos };
inline constexpr std::size_t kEllipseSize = 5;

/// Samples farther off the curve than this many robust sigmas take no part. Of a million samples of
/// normal noise 0.002 lie farther off, so that a sound capture loses none.
inline constexpr double kOutlierSigmas = 6.0;
/// Angles nearer than this count as one, electrical degrees: the least arc that is fitted (90
/// degrees) holds nine, more than the five free parameters.
inline constexpr double kDirectionDeg = 10.0;

struct EllipseFitOptions {
  bool circle = false;         ///< hold k = d = 0
  std::size_t iterations = 60; ///< of Gauss-Newton, over all rounds of rejection
};

struct EllipseFit {
  EllipseParameters value;
  /// Row-major; rows of parameters that were held are 0.
  std::array<double, kEllipseSize * kEllipseSize> covariance{};
  double residual_rms_v = 0;  ///< of the distances of the samples used, sqrt(sum e^2/(N - q))
  /// Of distances from fits that did not see the sample: of three, each without one of three parts
  /// of the record, which are spread over it. 0 where a part is too small for it, or
  /// holds what the others do not know.
  double heldout_rms_v = 0;
  double structure_rms_v = 0; ///< part of the residual that depends on psi; 0 where not seen
  double coverage_deg = 0;    ///< electrical degrees that hold samples, of 360
  std::size_t directions = 0; ///< angles at which samples stand, kDirectionDeg apart at least
  std::size_t free_parameters = 0;
  std::size_t used = 0, rejected = 0;
  double limit_v = 0;                  ///< distance beyond which samples were rejected
  std::vector<unsigned char> accepted; ///< one a sample

  double std_error(EllipseIndex i) const;
  /// Rms over the whole turn of the electrical angle error that the covariance predicts, rad.
  double predicted_error_rad() const;
};

/// Fits. Starts from a circle by Taubin's method through what the fences of both channels hold
/// (base/robust.h), and where much is off the curve then, from the circle that most places lie on
/// (calibration/circle_start.h); rejects outliers, and where the residual shows
/// structure along psi beyond the noise (a distortion that is no ellipse) weighs angles rather
/// than samples, so that a dwell at one angle does not bend the curve there.
/// Throws ADA4571_ERROR_UNUSABLE_DATA when there are too few samples or no ellipse is found.
EllipseFit fit_ellipse(std::span<const double> vsin, std::span<const double> vcos,
                       const EllipseFitOptions &options = {});

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What every method of calibration gives: the ellipse at one temperature, and how well it is known.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "calibration/recording_fit.h"

namespace ada {

enum class CalibrationMethod { fit, mean, extrema };

/// Beyond this many standard errors a mismatch or quadrature error is taken for real; the note's
/// model leaves both out.
inline constexpr double kSignificant = 5.0;

/// Degrees of the shaft, rms, by which noise may leave a calibration uncertain.
inline constexpr double kMaxErrorDeg = 0.1;

const char *method_name(CalibrationMethod method);

struct PairEstimate {
  EllipseParameters value;                      ///< centres absolute
  std::array<double, kEllipseSize> std_error{}; ///< by EllipseIndex; 0 where not estimated
  bool has_mismatch = false, has_quadrature = false;
  double noise_rms_v = 0;    ///< of one channel, as far as it is not a function of the angle
  double residual_rms_v = 0; ///< distance from the ellipse
  /// The same of samples that the fit did not see; 0 where that is not known (EllipseFit).
  double heldout_rms_v = 0;
  std::optional<double> vtemp_mean_v, vtemp_min_v, vtemp_max_v;
};

/// Calibrates one capture by one method. The reference column is never looked at.
/// Throws ADA4571_ERROR_UNUSABLE_DATA with the reason when the data cannot carry the method.
/// Mean and extrema hold a recording in memory, the fit, which the first one makes, does not.
/// `most_deg`: by which a fit may be uncertain.
PairEstimate estimate_pair(const RecordingToFit &what, CalibrationMethod method,
                           double most_deg = kMaxErrorDeg);
PairEstimate estimate_pair(const Capture &capture, CalibrationMethod method);

} // namespace ada

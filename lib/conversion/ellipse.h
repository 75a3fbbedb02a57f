// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The ellipse that VSIN and VCOS draw, and its inverse.
//
//   vsin = C_sin + A (1 + k/2) sin(psi + d/2)        psi = p (alpha + zero)
//   vcos = C_cos + A (1 - k/2) cos(psi - d/2)
//
// The symmetric convention: a mismatch k leaves the mean amplitude, a quadrature error d leaves
// the mean phase. With S = (vsin - C_sin)/(A (1 + k/2)), C likewise and h = d/2,
//
//   [S]   [cos h  sin h] [sin psi]            [sin psi]     1   [ cos h  -sin h] [S]
//   [C] = [sin h  cos h] [cos psi]  so that   [cos psi] = ----- [-sin h   cos h] [C]
//                                                         cos d
//
// and psi = atan2 of the two. The length of that vector is the relative radius, 1 for a sound
// sample.
#pragma once

#include <string>
#include <string_view>

#include "model/model.h"

namespace ada {

/// The five numbers of the ellipse at one temperature.
struct EllipseParameters {
  double amplitude_v = 1.0;  ///< mean of both channels
  double k = 0.0;            ///< amplitude mismatch A_sin/A_mean - A_cos/A_mean
  double delta_rad = 0.0;    ///< quadrature error, electrical
  double centre_sin_v = 0.0; ///< absolute volts: mid-supply plus offset
  double centre_cos_v = 0.0;
};

/// The compiled inverse: what a sample goes through.
struct EllipseInverse {
  double centre_sin_v, centre_cos_v;
  double sin_from_sin, sin_from_cos; ///< 1/V: sin psi = these times volts about the centre
  double cos_from_sin, cos_from_cos; ///< 1/V: cos psi

  double sine(double vsin, double vcos) const {
    return sin_from_sin * (vsin - centre_sin_v) + sin_from_cos * (vcos - centre_cos_v);
  }
  double cosine(double vsin, double vcos) const {
    return cos_from_sin * (vsin - centre_sin_v) + cos_from_cos * (vcos - centre_cos_v);
  }
};

EllipseInverse invert(const EllipseParameters &ellipse);

/// The same ellipse with the channels exchanged, or one of them mirrored about mid-supply, as
/// wrong wiring does.
EllipseInverse swap_channels(const EllipseInverse &inverse);
EllipseInverse mirror_sin(const EllipseInverse &inverse, double supply_v);
EllipseInverse mirror_cos(const EllipseInverse &inverse, double supply_v);

/// What of a model folds into the ellipse: the baseline, amplitude mismatch, quadrature error,
/// wrong wiring, and offsets and amplitude that follow VTEMP in straight lines. Effects that a
/// reader does not take out of the angle (EffectInfo::correctable) do not matter here.
class EllipseModel {
public:
  /// First effect of the model that this class cannot take out, or "periodic-remainder"; empty when
  /// there is neither.
  static std::string_view beyond(const Model &model);

  /// Throws ADA4571_ERROR_UNSUPPORTED when beyond() names an effect.
  explicit EllipseModel(const Model &model);

  int periods_per_turn() const { return periods_; }
  double supply_v() const { return supply_v_; }
  /// Mechanical angle of psi = 0 is minus this.
  double zero_rad() const { return zero_rad_; }
  bool follows_temperature() const {
    return parts_.tc_sin != 0.0 || parts_.tc_cos != 0.0 || parts_.tc_amplitude != 0.0;
  }

  /// The ellipse of the sensor itself, wiring not folded in.
  EllipseParameters parameters_at(double vtemp_v) const;
  /// The inverse at this VTEMP, which is not looked at when nothing follows temperature.
  EllipseInverse at(double vtemp_v) const { return wired(invert(parameters_at(vtemp_v))); }
  /// An inverse of the sensor, with the wiring folded in.
  EllipseInverse wired(EllipseInverse inverse) const;

private:
  int periods_;
  double supply_v_, zero_rad_, vtemp_reference_v_;
  EllipseParameters reference_; ///< at vtemp_reference_v_
  EllipseParts parts_;
};

} // namespace ada

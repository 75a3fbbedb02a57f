// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Blocks of raw samples, in any layout that a buffer may have, to mechanical angles in radians and
// relative radii. Offsets, amplitudes and quadrature error are taken out in the same pass, a
// periodic remainder by a table behind it.
#pragma once

#include <cstddef>
#include <optional>

#include "ada4571.h"
#include "conversion/angle_table.h"
#include "conversion/ellipse.h"

namespace ada {

class RawConverter {
public:
  /// Throws ADA4571_ERROR_UNSUPPORTED for a model that goes beyond one fixed ellipse: further
  /// effects, a remainder that no AngleTable holds, or a calibration that follows VTEMP.
  explicit RawConverter(const Model &model);

  /// Throws ADA4571_ERROR_INVALID_ARGUMENT for a layout that makes no sense. `radius` may be null.
  /// Interleaved 16-bit pairs, and packed channels of 16-bit numbers or of the output's type, are
  /// converted in place; everything else is brought into that form block by block.
  void convert(const ada4571_layout &layout, const void *sin, const void *cos, std::size_t count,
               float *angle, float *radius) const;
  void convert(const ada4571_layout &layout, const void *sin, const void *cos, std::size_t count,
               double *angle, double *radius) const;

private:
  template <class T>
  void convert_by_table(const ada4571_layout &layout, const void *sin, const void *cos,
                        std::size_t count, T *angle, T *radius) const;
  void by_ellipse(const ada4571_layout &layout, const void *sin, const void *cos, std::size_t count,
                  float *angle, float *radius) const;
  void by_ellipse(const ada4571_layout &layout, const void *sin, const void *cos, std::size_t count,
                  double *angle, double *radius) const;

  EllipseInverse inverse_; ///< zero angle folded in
  int periods_;
  std::optional<AngleTable> table_; ///< of the periodic remainder
};

} // namespace ada

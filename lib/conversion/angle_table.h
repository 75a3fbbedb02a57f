// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A periodic remainder on the raw path: from the angle and radius that the ellipse alone gives to
// those under the remainder, by a table over one period.
#pragma once

#include <cstddef>
#include <vector>

#include "conversion/ellipse.h"

namespace ada {

class AngleTable {
public:
  /// Interpolation error that the size of the table aims at, rad electrical.
  static constexpr double kInterpolationRad = 1e-9;

  /// `inverse` of the model's ellipse, zero angle folded in. Throws ADA4571_ERROR_UNSUPPORTED where
  /// no table holds the remainder: where it differs between the parts of a turn that a pair cannot
  /// tell apart, or bends the curve so far that the ellipse's angle stands for several.
  AngleTable(const Model &model, const EllipseInverse &inverse);

  /// `angle` in [0, 2 pi/p), in place; one that is no number stays so. `radius` may be null.
  void correct(std::size_t count, float *angle, float *radius) const;
  void correct(std::size_t count, double *angle, double *radius) const;

private:
  /// What is added to the angle and what the radius is multiplied by, each with a sixth of its
  /// second difference.
  template <class T> struct Node { T shift, shift_bend, factor, factor_bend; };
  template <class T>
  void correct(const std::vector<Node<T>> &nodes, std::size_t count, T *angle, T *radius) const;

  double period_;
  std::vector<Node<double>> nodes_; ///< the first one again at the end
  std::vector<Node<float>> nodes_f32_;
};

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Least-squares cubic B-spline with given knots, together with further linear terms that are
// fitted beside it and so cannot leak into it.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace ada {

class CubicSpline {
public:
  /// `knots`: strictly increasing, at least two; the spline lives on [front, back] and goes on as
  /// the end pieces do outside.
  explicit CubicSpline(std::vector<double> knots);

  /// Fits y(x) = spline(x) + sum_k c_k term_k(i). `x` ascending. `terms` writes the values of the
  /// further terms for sample i; `term_count` may be 0. Samples with weight 0 are left out.
  void fit(std::span<const double> x, std::span<const double> y, std::span<const char> usable,
           std::size_t term_count, const std::function<void(std::size_t, double *)> &terms);

  double value(double x) const { return evaluate(x, 0); }
  double slope(double x) const { return evaluate(x, 1); }
  double curvature(double x) const { return evaluate(x, 2); }
  const std::vector<double> &term_coefficients() const { return terms_; }

  /// Knots for n equal pieces.
  static std::vector<double> uniform(double from, double to, std::size_t pieces);

private:
  std::size_t piece(double x) const;
  /// The four basis functions (or a derivative of them) that live on a piece.
  void basis(double x, std::size_t piece, int derivative, double out[4]) const;
  double evaluate(double x, int derivative) const;

  std::vector<double> knots_; ///< the given ones, with three of each end repeated
  std::vector<double> coefficients_;
  std::vector<double> terms_;
};

} // namespace ada

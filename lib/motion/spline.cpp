// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "motion/spline.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <utility>

namespace ada {

CubicSpline::CubicSpline(std::vector<double> knots) {
  knots_.assign(3, knots.front());
  knots_.insert(knots_.end(), knots.begin(), knots.end());
  knots_.insert(knots_.end(), 3, knots.back());
  coefficients_.assign(knots.size() + 2, 0.0);
}

std::vector<double> CubicSpline::uniform(double from, double to, std::size_t pieces) {
  std::vector<double> knots(pieces + 1);
  for (std::size_t i = 0; i <= pieces; ++i)
    knots[i] = from + (to - from) * static_cast<double>(i) / static_cast<double>(pieces);
  return knots;
}

std::size_t CubicSpline::piece(double x) const {
  const auto first = knots_.begin() + 3, last = knots_.end() - 4;
  const auto after = std::upper_bound(first + 1, last, x);
  return static_cast<std::size_t>(after - knots_.begin()) - 1;
}

void CubicSpline::basis(double x, std::size_t k, int derivative, double out[4]) const {
  // Cox-de Boor up to the degree that the derivative needs, then differences of coefficients.
  const int degree = 3 - derivative;
  double b[4] = {1.0, 0.0, 0.0, 0.0};
  for (int d = 1; d <= degree; ++d) {
    double saved = 0.0;
    for (int r = 0; r < d; ++r) {
      const double right = knots_[k + static_cast<std::size_t>(r) + 1];
      const double left = knots_[k + 1 + static_cast<std::size_t>(r) - static_cast<std::size_t>(d)];
      const double part = b[r] / (right - left);
      b[r] = saved + (right - x) * part;
      saved = (x - left) * part;
    }
    b[d] = saved;
  }
  for (int d = degree + 1; d <= 3; ++d) { // derivative of a basis function of degree d
    double next[4] = {0.0, 0.0, 0.0, 0.0};
    for (int r = 0; r <= d; ++r) {
      const std::size_t i = k - static_cast<std::size_t>(d) + static_cast<std::size_t>(r);
      const std::size_t span = static_cast<std::size_t>(d);
      if (r > 0)
        next[r] += d * b[r - 1] / (knots_[i + span] - knots_[i]);
      if (r < d)
        next[r] -= d * b[r] / (knots_[i + span + 1] - knots_[i + 1]);
    }
    std::copy(next, next + 4, b);
  }
  std::copy(b, b + 4, out);
}

double CubicSpline::evaluate(double x, int derivative) const {
  const std::size_t k = piece(x);
  double b[4];
  basis(x, k, derivative, b);
  double sum = 0.0;
  for (std::size_t r = 0; r < 4; ++r)
    sum += b[r] * coefficients_[k - 3 + r];
  return sum;
}

void CubicSpline::fit(std::span<const double> x, std::span<const double> y,
                      std::span<const char> usable, std::size_t term_count,
                      const std::function<void(std::size_t, double *)> &terms) {
  const std::size_t m = coefficients_.size(), n = m + term_count;
  Eigen::MatrixXd band = Eigen::MatrixXd::Zero(4, static_cast<Eigen::Index>(m)); // (offset, column)
  Eigen::MatrixXd cross = // (term, piece): what one sample adds lies side by side
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(term_count), static_cast<Eigen::Index>(m));
  Eigen::MatrixXd inner = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(term_count),
                                                static_cast<Eigen::Index>(term_count));
  Eigen::VectorXd right = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n));
  // The terms of many samples are multiplied at once.
  constexpr Eigen::Index kAtOnce = 64;
  Eigen::MatrixXd some(static_cast<Eigen::Index>(term_count), kAtOnce);
  Eigen::Index held = 0;
  const auto multiply = [&] {
    if (held == 0)
      return;
    inner.selfadjointView<Eigen::Lower>().rankUpdate(some.leftCols(std::exchange(held, 0)));
  };
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!usable.empty() && !usable[i])
      continue;
    const std::size_t k = piece(x[i]);
    double b[4];
    basis(x[i], k, 0, b);
    auto t = some.col(held);
    if (term_count > 0)
      terms(i, t.data());
    const Eigen::Index base = static_cast<Eigen::Index>(k) - 3;
    for (Eigen::Index p = 0; p < 4; ++p) {
      for (Eigen::Index q = p; q < 4; ++q)
        band(q - p, base + p) += b[p] * b[q];
      right[base + p] += b[p] * y[i];
      if (term_count > 0)
        cross.col(base + p) += b[p] * t;
    }
    if (term_count > 0) {
      right.tail(static_cast<Eigen::Index>(term_count)) += y[i] * t;
      if (++held == kAtOnce)
        multiply();
    }
  }
  multiply();
  // A little stiffness keeps pieces without data determined: it pulls them straight, not to zero.
  const double stiffness = 1e-7 * std::max(1.0, band.row(0).maxCoeff());
  const auto greville = [&](std::size_t i) {
    return (knots_[i + 1] + knots_[i + 2] + knots_[i + 3]) / 3.0;
  };
  for (std::size_t i = 0; i + 2 < m; ++i) {
    const double a = greville(i + 1) - greville(i), b = greville(i + 2) - greville(i + 1);
    const double unit = std::min(a, b);
    const double row[3] = {unit / a, -unit / a - unit / b, unit / b};
    for (Eigen::Index p = 0; p < 3; ++p)
      for (Eigen::Index q = p; q < 3; ++q)
        band(q - p, static_cast<Eigen::Index>(i) + p) += stiffness * row[p] * row[q];
  }
  const double ridge = 1e-9 * stiffness;
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index c = 0; c < static_cast<Eigen::Index>(m); ++c)
    for (Eigen::Index d = 0; d < 4 && c + d < static_cast<Eigen::Index>(m); ++d)
      entries.emplace_back(c + d, c, band(d, c) + (d == 0 ? ridge : 0.0));
  for (Eigen::Index r = 0; r < static_cast<Eigen::Index>(term_count); ++r) {
    for (Eigen::Index c = 0; c < static_cast<Eigen::Index>(m); ++c)
      if (cross(r, c) != 0.0)
        entries.emplace_back(static_cast<Eigen::Index>(m) + r, c, cross(r, c));
    for (Eigen::Index c = 0; c <= r; ++c)
      entries.emplace_back(static_cast<Eigen::Index>(m) + r, static_cast<Eigen::Index>(m) + c,
                           inner(r, c) + (r == c ? ridge : 0.0));
  }
  Eigen::SparseMatrix<double> normal(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  normal.setFromTriplets(entries.begin(), entries.end());
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver(normal);
  const Eigen::VectorXd solution = solver.solve(right);
  std::copy_n(solution.data(), m, coefficients_.data());
  terms_.assign(solution.data() + m, solution.data() + n);
}

} // namespace ada

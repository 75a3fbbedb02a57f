// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "model/taps.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace ada {

namespace {

std::vector<Tap> convolve(const std::vector<Tap> &a, std::span<const Tap> b) {
  std::vector<Tap> out;
  out.reserve(a.size() * b.size());
  for (const Tap &x : a)
    for (const Tap &y : b)
      out.push_back({x.delay_s + y.delay_s, x.weight * y.weight});
  return out;
}

/// The Gauss quadrature of the copies taken as a measure on the delays: n nodes hold its first 2 n
/// moments, and of e^(-jwd) err by h_n w^(2n) / (2n)! at the most, h_n being the square of the
/// n-th monic orthogonal polynomial under the measure (Gautschi, Orthogonal Polynomials, 2004,
/// sections 1.4.2, 2.2.3 and 3.1.1). Two nodes at least: an acceleration and a supply that ripples
/// go with the square of the delay, however slow the shaft.
std::vector<Tap> fewest_of(const std::vector<Tap> &copies, double fastest) {
  constexpr double kTolerance = 1e-6, kAtRest = 1e-9;
  constexpr Eigen::Index kSquares = 2;
  const auto most = static_cast<Eigen::Index>(copies.size());
  const double unit = std::max(fastest, kAtRest); // 1/s
  if (most < 3 ||
      std::any_of(copies.begin(), copies.end(), [](const Tap &t) { return t.weight < 0.0; }))
    return copies;
  Eigen::ArrayXd x(most), w(most);
  for (Eigen::Index k = 0; k < most; ++k) {
    x[k] = unit * copies[static_cast<std::size_t>(k)].delay_s;
    w[k] = copies[static_cast<std::size_t>(k)].weight;
  }
  const double sum = w.sum();
  Eigen::ArrayXd before = Eigen::ArrayXd::Zero(most), here = Eigen::ArrayXd::Ones(most);
  Eigen::VectorXd diagonal(most), beside(most);
  double square = sum, bound = 1.0;
  Eigen::Index n = 0;
  do { // Stieltjes
    const double middle = (w * x * here * here).sum() / square;
    const double ratio = n > 0 ? beside[n - 1] : 0.0;
    const Eigen::ArrayXd next = (x - middle) * here - ratio * before;
    diagonal[n] = middle;
    before = here;
    here = next;
    const double next_square = (w * here * here).sum();
    beside[n] = next_square / square;
    square = next_square;
    ++n;
    bound /= static_cast<double>((2 * n - 1) * (2 * n));
  } while (n < most && square > 0.0 && (n < kSquares || square * bound > kTolerance * sum));
  if (n >= most)
    return copies;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal.head(n), beside.head(n - 1).cwiseSqrt());
  if (solver.info() != Eigen::Success)
    return copies;
  std::vector<Tap> out;
  for (Eigen::Index k = 0; k < n; ++k)
    out.push_back({solver.eigenvalues()[k] / unit, sum * std::pow(solver.eigenvectors()(0, k), 2)});
  return out;
}

} // namespace

void Taps::pass(std::span<const Tap> system) {
  sin = convolve(sin, system);
  cos = convolve(cos, system);
}

Taps Taps::fewest(double fastest) const {
  Taps out;
  out.sin = fewest_of(sin, fastest);
  out.cos = cos == sin ? out.sin : fewest_of(cos, fastest);
  return out;
}

} // namespace ada

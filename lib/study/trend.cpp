// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>

#include <boost/math/distributions/students_t.hpp>

#include "study/statistics.h"

namespace ada::study {

namespace {

constexpr double kHuber = 1.345; ///< 95 % efficient under a normal distribution
constexpr int kRounds = 50;

struct Line {
  double intercept, slope, spread_x; ///< spread_x: sum of squares of x about its mean
};

/// Weighted least squares.
Line weighted_line(std::span<const double> x, std::span<const double> y,
                   const std::vector<double> &w) {
  double sum = 0.0, mx = 0.0, my = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += w[i];
    mx += w[i] * x[i];
    my += w[i] * y[i];
  }
  mx /= sum;
  my /= sum;
  double xx = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += w[i] * (x[i] - mx) * (x[i] - mx);
    xy += w[i] * (x[i] - mx) * (y[i] - my);
  }
  const double slope = xx > 0.0 ? xy / xx : 0.0;
  return {my - slope * mx, slope, xx};
}

std::vector<double> residuals(std::span<const double> x, std::span<const double> y, const Line &l) {
  std::vector<double> r(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    r[i] = y[i] - l.intercept - l.slope * x[i];
  return r;
}

double root_mean_square(const std::vector<double> &r) {
  double sum = 0.0;
  for (double v : r)
    sum += v * v;
  return std::sqrt(sum / static_cast<double>(r.size()));
}

/// Sum of the squares of psi and the mean of its derivative, with psi Huber's function.
struct Influence {
  double squares = 0.0, slope = 0.0;
};

Influence influence(const std::vector<double> &r, double scale) {
  Influence out;
  for (double v : r) {
    const double u = v / scale, psi = std::clamp(u, -kHuber, kHuber);
    out.squares += psi * psi;
    out.slope += std::abs(u) <= kHuber ? 1.0 / static_cast<double>(r.size()) : 0.0;
  }
  return out;
}

} // namespace

std::optional<Trend> robust_trend(std::span<const double> x, std::span<const double> y,
                                  std::size_t lost) {
  const auto n = static_cast<double>(x.size());
  const double freedom = n - 2.0 - static_cast<double>(lost);
  std::vector<double> w(x.size(), 1.0);
  if (freedom < 1.0)
    return std::nullopt;
  Line line = weighted_line(x, y, w);
  const double spread_x = line.spread_x;
  if (!(spread_x > 0.0))
    return std::nullopt;
  double scale = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<double> r = residuals(x, y, line);
    scale = median_deviation(r);
    if (!(scale > 0.0)) // more than half lie on the line
      scale = root_mean_square(r);
    if (!(scale > 0.0))
      return Trend{line.slope, line.intercept, 0.0, 0.0};
    for (std::size_t i = 0; i < r.size(); ++i)
      w[i] = std::abs(r[i]) <= kHuber * scale ? 1.0 : kHuber * scale / std::abs(r[i]);
    const Line next = weighted_line(x, y, w);
    const double change = std::abs(next.slope - line.slope);
    line = next;
    if (change <= 1e-10 * std::abs(line.slope))
      break;
  }
  const Influence i = influence(residuals(x, y, line), scale);
  const double m = std::max(i.slope, 0.1);
  const double correction = 1.0 + 2.0 / n * (1.0 - m) / m; // K of Huber & Ronchetti 7.6
  const double error =
      correction * scale * std::sqrt(i.squares / freedom) / m / std::sqrt(spread_x);
  Trend out{line.slope, line.intercept, error, 1.0};
  if (error > 0.0)
    out.p = 2.0 * boost::math::cdf(boost::math::complement(boost::math::students_t(freedom),
                                                           std::abs(line.slope) / error));
  return out;
}

} // namespace ada::study

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/along_and_across.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

#include <Eigen/Dense>

#include "base/robust.h"
#include "diagnosis/criteria.h"

namespace ada {

namespace {

constexpr std::size_t kDifference = 3; ///< order of the differences: a motion is smooth over four

} // namespace

double mean_square(const std::vector<double> &x) {
  double sum = 0.0;
  for (double v : x)
    sum += v * v;
  return sum / static_cast<double>(std::max<std::size_t>(1, x.size()));
}

void split(const Observations &data, const ResidualColumns &rest, std::vector<double> &along,
           std::vector<double> &across) {
  for (std::size_t i = 0; i < data.size(); ++i) {
    const auto [s, c] = data.outward(rest.model_sin[i], rest.model_cos[i]);
    const double vs = rest.model_sin[i] - data.centre_sin_v,
                 vc = rest.model_cos[i] - data.centre_cos_v,
                 length = std::max(std::hypot(vs, vc), 1e-12);
    const double tangent = rest.sin[i] * c - rest.cos[i] * s;
    // The figure bends: where the angle is off by much the pair lies on it and inside its tangent.
    const double out = rest.sin[i] * s + rest.cos[i] * c + 0.5 * tangent * tangent / length;
    // A gain moves along the vector, an angle along the figure, which is at right angles to it
    // only where that is a circle.
    const double both = std::max((vs * s + vc * c) / length, 1e-3);
    along.push_back(out / both);
    across.push_back(tangent - out * (vs * c - vc * s) / length / both);
  }
}

void keep_radial(const Observations &data, ResidualColumns &rest) {
  for (std::size_t i = 0; i < rest.sin.size(); ++i) {
    const double s = rest.model_sin[i] - data.centre_sin_v;
    const double c = rest.model_cos[i] - data.centre_cos_v;
    const double radial = (rest.sin[i] * s + rest.cos[i] * c) / std::max(s * s + c * c, 1e-12);
    rest.sin[i] = radial * s;
    rest.cos[i] = radial * c;
  }
}

std::optional<Directions> by_differences(const Observations &whole, const Model &model) {
  constexpr std::array<double, kDifference + 1> kWeights{1.0, -3.0, 3.0, -1.0};
  constexpr double kSquares = 20.0; // of the weights
  constexpr double kTogether = 2.3; // squares of such differences are worth so many times fewer
  constexpr double kOutlier = 36.0; // of the median square, 5 standard deviations of noise: a jerk
  std::vector<std::uint32_t> rows(std::min(whole.size(), criteria::kFlickerRows));
  std::iota(rows.begin(), rows.end(), static_cast<std::uint32_t>((whole.size() - rows.size()) / 2));
  Observations data = whole.select(rows);
  data.coloured.reset();
  data = at_own_angle(std::move(data), model);
  const ResidualColumns rest = residual_columns(data, model);
  std::vector<double> along, across, radial;
  split(data, rest, radial, across);
  across.clear();
  std::vector<double> turned;
  for (std::size_t i = kDifference; i < data.size(); ++i) {
    if (data.time[i] - data.time[i - kDifference] > 1.5 * kDifference * data.frame_period_s)
      continue;
    double a = 0.0, b = 0.0;
    for (std::size_t k = 0; k <= kDifference; ++k) {
      a += kWeights[k] * radial[i - k];
      b += kWeights[k] * data.alpha[i - k];
    }
    b *= model.periods_per_turn * model.baseline.amplitude_v;
    along.push_back(a * a / kSquares);
    across.push_back(b * b / kSquares);
    turned.push_back(std::cos(2.0 * model.periods_per_turn * data.alpha[i - 1]));
  }
  if (static_cast<double>(along.size()) < criteria::kFewestForNoise)
    return std::nullopt;
  const double most_along = kOutlier * quantile(along, 0.5),
               most_across = kOutlier * quantile(across, 0.5);
  double n = 0.0, sum_along = 0.0, sum_across = 0.0;
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  double squares = 0.0;
  for (std::size_t i = 0; i < along.size(); ++i) {
    if (along[i] > most_along || across[i] > most_across)
      continue;
    n += 1.0;
    sum_along += along[i];
    sum_across += across[i];
    const Eigen::Vector2d x(1.0, turned[i]);
    const double y = along[i] - across[i];
    normal += x * x.transpose();
    right += y * x;
    squares += y * y;
  }
  if (n < criteria::kFewestForNoise)
    return std::nullopt;
  const Eigen::Matrix2d inverse = normal.inverse();
  const Eigen::Vector2d of = inverse * right;
  const double variance = std::max(squares - of.dot(right), 0.0) / n;
  return Directions{sum_along / n, sum_across / n, of[0],
                    std::sqrt(kTogether * variance * inverse(0, 0))};
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/noise/along_and_across.h"

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

namespace {

/// The directions of one sample: of its vector, and out of the figure there.
struct Axes {
  double vector_s, vector_c, out_s, out_c;
  double length_v, both; ///< of the vector; cosine of the angle between the two
};

Axes axes_at(const Observations &data, double sin_v, double cos_v) {
  const auto [s, c] = data.outward(sin_v, cos_v);
  const double vs = sin_v - data.centre_sin_v, vc = cos_v - data.centre_cos_v,
               length = std::max(std::hypot(vs, vc), 1e-12);
  return {vs / length, vc / length, s, c, length, std::max((vs * s + vc * c) / length, 1e-3)};
}

/// How far a residual leads out of the figure. The figure bends, here as a circle about its centre:
/// where the angle is off by much the pair lies on it and inside its tangent.
double out_of_figure(const Axes &at, double sin_v, double cos_v) {
  const double tangent = sin_v * at.out_c - cos_v * at.out_s;
  const double out = sin_v * at.out_s + cos_v * at.out_c;
  return std::hypot(at.length_v + out, tangent) - at.length_v;
}

} // namespace

void along_and_across(const Observations &data, const ResidualColumns &rest,
                      std::vector<double> &along, std::vector<double> &across) {
  for (std::size_t i = 0; i < data.size(); ++i) {
    const Axes at = axes_at(data, rest.model_sin[i], rest.model_cos[i]);
    // A gain moves along the vector, an angle along the figure, which is at right angles to it
    // only where that is a circle.
    const double out = out_of_figure(at, rest.sin[i], rest.cos[i]);
    along.push_back(out / at.both);
    across.push_back(rest.sin[i] * at.out_c - rest.cos[i] * at.out_s -
                     out * (at.vector_s * at.out_c - at.vector_c * at.out_s) / at.both);
  }
}

double out_of_figure_rms_v(const Observations &data, const ResidualColumns &rest) {
  double sum = 0.0;
  for (std::size_t i = 0; i < data.size(); ++i)
    sum += std::pow(out_of_figure(axes_at(data, rest.model_sin[i], rest.model_cos[i]), rest.sin[i],
                                  rest.cos[i]),
                    2);
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, data.size())));
}

double stretched_by_axes(const Observations &data, const ResidualColumns &rest) {
  double sum = 0.0;
  for (std::size_t i = 0; i < data.size(); ++i)
    sum += std::pow(axes_at(data, rest.model_sin[i], rest.model_cos[i]).both, -2);
  return sum / static_cast<double>(std::max<std::size_t>(1, data.size()));
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
  data.noise_alone = false; // by direction alone a noise of the gain moves no angle
  data = at_own_angle(std::move(data), model);
  const ResidualColumns rest = residual_columns(data, model);
  std::vector<Axes> at;
  std::vector<double> off;
  for (std::size_t i = 0; i < data.size(); ++i) {
    at.push_back(axes_at(data, rest.model_sin[i], rest.model_cos[i]));
    off.push_back(out_of_figure(at.back(), rest.sin[i], rest.cos[i]));
  }
  std::vector<double> out, along;
  // A noise of the gain, of channels that are unlike, and what both have in common.
  std::vector<Eigen::Vector3d> shares;
  for (std::size_t i = kDifference; i < data.size(); ++i) {
    if (data.time[i] - data.time[i - kDifference] > 1.5 * kDifference * data.frame_period_s)
      continue;
    double a = 0.0, b = 0.0;
    for (std::size_t k = 0; k <= kDifference; ++k) {
      a += kWeights[k] * off[i - k];
      b += kWeights[k] * data.alpha[i - k];
    }
    const Axes &here = at[i - 1];
    const auto place = data.place(rest.model_sin[i - 1], rest.model_cos[i - 1]);
    b *= model.periods_per_turn * std::hypot(place.along[0], place.along[1]) * here.both;
    out.push_back(a * a / kSquares);
    along.push_back(b * b / kSquares);
    shares.emplace_back(std::pow(here.length_v * here.both / model.baseline.amplitude_v, 2),
                        here.out_s * here.out_s - here.out_c * here.out_c +
                            here.vector_s * here.vector_s - here.vector_c * here.vector_c,
                        2.0 * (here.out_s * here.out_c + here.vector_s * here.vector_c));
  }
  if (static_cast<double>(out.size()) < criteria::kFewestForNoise)
    return std::nullopt;
  const double most_out = kOutlier * quantile(out, 0.5),
               most_along = kOutlier * quantile(along, 0.5);
  double n = 0.0, sum_along = 0.0;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double squares = 0.0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (out[i] > most_out || along[i] > most_along)
      continue;
    n += 1.0;
    sum_along += along[i];
    const Eigen::Vector3d &x = shares[i];
    const double y = out[i] - along[i];
    normal += x * x.transpose();
    right += y * x;
    squares += y * y;
  }
  if (n < criteria::kFewestForNoise)
    return std::nullopt;
  const Eigen::Matrix3d inverse = normal.inverse();
  const Eigen::Vector3d of = inverse * right;
  const double variance = std::max(squares - of.dot(right), 0.0) / n;
  return Directions{sum_along / n, of[0], std::sqrt(kTogether * variance * inverse(0, 0))};
}

} // namespace ada

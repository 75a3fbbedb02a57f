// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/no_pair.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/robust.h"
#include "diagnosis/conditions/no_circle.h"
#include "diagnosis/criteria.h"

namespace ada {

namespace {

/// Whether a vector turns from row to row, however far: the mean product of a reading and the
/// conjugate of the one before is real for whatever drifts and none for noise, the imaginary part
/// of which is 1 / sqrt(2 n) of the mean square for n rows.
bool turns_from_row_to_row(const Capture &capture) {
  constexpr double kErrors = 5.0, kLeast = 0.2; // the latter of the mean square
  const double s0 = quantile(capture.vsin_v, 0.5), c0 = quantile(capture.vcos_v, 0.5);
  double turned = 0.0, power = 0.0, n = 0.0;
  for (std::size_t i = 1; i < capture.size(); ++i) {
    const double s = capture.vsin_v[i] - s0, c = capture.vcos_v[i] - c0,
                 before_s = capture.vsin_v[i - 1] - s0, before_c = capture.vcos_v[i - 1] - c0;
    const double product = s * before_c - c * before_s;
    if (!std::isfinite(product))
      continue;
    turned += product;
    power += 0.5 * (s * s + c * c + before_s * before_s + before_c * before_c);
    n += 1.0;
  }
  return std::abs(turned) > std::max(kLeast, kErrors / std::sqrt(2.0 * std::max(1.0, n))) * power;
}

} // namespace

// Of noise the quantiles lie 4.7 standard deviations apart: up to four times that the pair has to
// draw a circle, as that of a very noisy sensor does.
bool stands_still(const Capture &capture, double noise_v) {
  constexpr double kFew = 10.0, kMany = 20.0;
  double most_v = 0.0;
  for (const auto *v : {&capture.vsin_v, &capture.vcos_v})
    most_v = std::max(most_v, quantile(*v, 0.99) - quantile(*v, 0.01));
  // What differs from row to row looks like noise where the shaft turns by half a radian or more.
  if (most_v <= kMany * noise_v && turns_from_row_to_row(capture))
    return false;
  if (most_v <= kFew * noise_v)
    return true;
  return most_v <= kMany * noise_v && !draws_circle(capture.vsin_v, capture.vcos_v);
}

bool on_one_line(const Observations &data, double noise_v) {
  // A third of a turn leaves 0.08 of an even pair, a twelfth 0.005, an ellipse of 1 to 10 leaves
  // 0.01; noise of a hundredth of the amplitude on a line leaves 0.0002.
  constexpr double kLine = 1e-3;
  // A shaft that turns by a radian from sample to sample passes for noise, and leaves 0.2 or more.
  constexpr double kLong = 0.1, kOfNoise = 4.0; // the latter of its variance
  const double n = static_cast<double>(data.size());
  const auto column = [](const std::vector<float> &v) {
    return Eigen::Map<const Eigen::ArrayXf>(v.data(), static_cast<Eigen::Index>(v.size()))
        .cast<double>()
        .eval();
  };
  const Eigen::ArrayXd s = column(data.vsin), c = column(data.vcos);
  const Eigen::ArrayXd x = s - s.mean(), y = c - c.mean();
  Eigen::Matrix2d covariance;
  covariance << (x * x).sum() / n, (x * y).sum() / n, (x * y).sum() / n, (y * y).sum() / n;
  const Eigen::Vector2d along = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>()
                                    .computeDirect(covariance, Eigen::EigenvaluesOnly)
                                    .eigenvalues();
  return along[0] < kLine * along[1] ||
         (along[0] < kLong * along[1] && along[0] < kOfNoise * noise_v * noise_v);
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/unseen_supply.h"

#include <Eigen/Dense>
#include <array>
#include <cmath>

#include "base/angle.h"
#include "base/robust.h"
#include "motion/kinematics.h"

namespace ada {

namespace {

constexpr std::size_t kFewest = 2000;
constexpr double kAboveNoise = 2.0; ///< the radius must move at least so much
constexpr double kExplained = 0.4;  ///< of its rms that may be left over
constexpr double kBetter = 1.4;     ///< times less left over than any rival leaves

/// Radius of the pair about its middle, freed of what repeats with the electrical angle.
struct Radius {
  std::vector<double> angle; ///< unwrapped, electrical
  std::vector<double> off;   ///< V
  double middle_sin, middle_cos, amplitude;
};

Radius radius_of(const Capture &c) {
  Radius out;
  const auto middle = [](const std::vector<double> &v) {
    return 0.5 * (quantile(v, 0.005) + quantile(v, 0.995));
  };
  out.middle_sin = middle(c.vsin_v);
  out.middle_cos = middle(c.vcos_v);
  std::vector<double> radius;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double s = c.vsin_v[i] - out.middle_sin, k = c.vcos_v[i] - out.middle_cos;
    out.angle.push_back(std::atan2(s, k));
    radius.push_back(std::hypot(s, k));
  }
  out.amplitude = quantile(radius, 0.5);
  constexpr int kOrders = 6, kColumns = 1 + 2 * kOrders;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(kColumns, kColumns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(kColumns), x(kColumns);
  const auto row = [&](std::size_t i) {
    x[0] = 1.0;
    for (int k = 1; k <= kOrders; ++k) {
      x[2 * k - 1] = std::cos(k * out.angle[i]);
      x[2 * k] = std::sin(k * out.angle[i]);
    }
  };
  const std::size_t stride = std::max<std::size_t>(1, c.size() / 30000);
  for (std::size_t i = 0; i < c.size(); i += stride) {
    row(i);
    normal.selfadjointView<Eigen::Lower>().rankUpdate(x);
    right += radius[i] * x;
  }
  normal.diagonal().array() += 1e-9;
  const Eigen::VectorXd fitted = normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
  for (std::size_t i = 0; i < c.size(); ++i) {
    row(i);
    out.off.push_back(radius[i] - fitted.dot(x));
  }
  unwrap(out.angle, kTwoPi);
  return out;
}

/// First sample after a quarter of a period from each; travel counts, whatever its sense.
std::vector<std::size_t> quarter_period_ends(const std::vector<double> &angle) {
  std::vector<std::size_t> out(angle.size());
  std::size_t to = 0;
  double travel = 0.0;
  for (std::size_t from = 0; from < angle.size(); ++from) {
    while (to + 1 < angle.size() && (to < from + 4 || travel < 0.25 * kTwoPi)) {
      travel += std::abs(angle[to + 1] - angle[to]);
      ++to;
    }
    out[from] = to;
    if (from < to)
      travel -= std::abs(angle[from + 1] - angle[from]);
  }
  return out;
}

/// What a slow disturbance that acts on the radius as `shape` says must have been, by least squares
/// over half a period about each sample, and the rms that it leaves of the radius.
struct Slow {
  std::vector<double> value;
  double left_v;
};

Slow slow_part(const Radius &r, const std::vector<double> &shape,
               const std::vector<std::size_t> &quarter) {
  const std::size_t n = r.off.size();
  std::vector<double> gg(n + 1, 0.0), gr(n + 1, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    gg[i + 1] = gg[i] + shape[i] * shape[i];
    gr[i + 1] = gr[i] + shape[i] * r.off[i];
  }
  Slow out{std::vector<double>(n, 0.0), 0.0};
  std::size_t from = 0;
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    while (quarter[from] < i)
      ++from;
    const std::size_t to = std::min(n, quarter[i] + 1);
    const double weight = gg[to] - gg[from];
    out.value[i] = weight > 0.0 ? (gr[to] - gr[from]) / weight : 0.0;
    const double left = r.off[i] - shape[i] * out.value[i];
    sum += left * left;
  }
  out.left_v = std::sqrt(sum / static_cast<double>(n));
  return out;
}

double rms(const std::vector<double> &v) {
  double sum = 0.0;
  for (double x : v)
    sum += x * x;
  return std::sqrt(sum / static_cast<double>(v.size()));
}

/// How much a column moves within a hundredth of the record.
double unrest(const std::vector<double> &v) {
  const std::size_t lag = v.size() / 100;
  double sum = 0.0;
  for (std::size_t i = lag; i < v.size(); ++i)
    sum += (v[i] - v[i - lag]) * (v[i] - v[i - lag]);
  return sum;
}

} // namespace

std::optional<Capture> with_unseen_supply(const Capture &capture) {
  if (capture.has_vdd() || capture.size() < kFewest ||
      (capture.has_reference() && !capture.has_vtemp()))
    return std::nullopt;
  const Radius radius = radius_of(capture);
  const double whole = rms(radius.off);
  if (whole < kAboveNoise * noise_between(radius.off) || whole > 0.2 * radius.amplitude)
    return std::nullopt;
  // Radial part of one volt per volt of each disturbance.
  std::array<std::vector<double>, 4> shape; // supply; gain, offset of VSIN, offset of VCOS
  for (double a : radius.angle) {
    const double s = std::sin(a), c = std::cos(a);
    shape[0].push_back(radius.middle_sin * s + radius.middle_cos * c + radius.amplitude);
    shape[1].push_back(1.0);
    shape[2].push_back(s);
    shape[3].push_back(c);
  }
  const std::vector<std::size_t> quarter = quarter_period_ends(radius.angle);
  const Slow supply = slow_part(radius, shape[0], quarter);
  if (supply.left_v > kExplained * whole)
    return std::nullopt;
  for (std::size_t k = 1; k < shape.size(); ++k)
    if (slow_part(radius, shape[k], quarter).left_v < kBetter * supply.left_v)
      return std::nullopt;
  Capture out = capture;
  if (!capture.has_reference()) {
    for (double u : supply.value)
      out.vdd_v.push_back(capture.meta.supply_v * (1.0 + u));
    return out;
  }
  for (std::size_t i = 0; i < out.size(); ++i)
    out.vtemp_v[i] /= 1.0 + supply.value[i];
  return unrest(out.vtemp_v) < unrest(capture.vtemp_v) ? std::optional(out) : std::nullopt;
}

} // namespace ada

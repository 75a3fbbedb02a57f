// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/reference_scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/criteria.h"
#include "motion/kinematics.h"

namespace ada {

namespace {

using Eigen::ArrayXd;

/// Rows of one record, evenly spread over it.
struct Rows {
  int periods;
  ArrayXd time, alpha, sin, cos; ///< time and angle (rad, unwrapped) about their means
  ArrayXd speed;                 ///< rad/s, as a lag of either goes with it
};

ArrayXd as_array(const std::vector<double> &v) {
  return Eigen::Map<const ArrayXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

Rows rows_of(const Capture &capture, std::size_t begin, std::size_t end) {
  std::vector<std::size_t> whole;
  std::vector<double> unwrapped;
  for (std::size_t i = begin; i < end; ++i)
    if (std::isfinite(capture.vsin_v[i]) && std::isfinite(capture.vcos_v[i]) &&
        std::isfinite(capture.reference_deg[i])) {
      whole.push_back(i);
      unwrapped.push_back(capture.reference_deg[i] * kRadPerDeg);
    }
  unwrap(unwrapped, kTwoPi);
  const std::size_t stride = whole.size() / criteria::kForScale + 1;
  std::vector<double> time, alpha, sin, cos;
  for (std::size_t k = 0; k < whole.size(); k += stride) {
    time.push_back(capture.time_s[whole[k]]);
    alpha.push_back(unwrapped[k]);
    sin.push_back(capture.vsin_v[whole[k]]);
    cos.push_back(capture.vcos_v[whole[k]]);
  }
  constexpr std::size_t kHalfWindow = 2; // rows, which the noise of a reference needs
  Rows out{capture.meta.periods_per_turn,
           as_array(time),
           as_array(alpha),
           as_array(sin),
           as_array(cos),
           as_array(differentiate(time, alpha, kHalfWindow).omega)};
  out.time -= out.time.mean();
  out.alpha -= out.alpha.mean();
  return out;
}

/// What the pair departs by, beside the ellipse that it draws.
enum class Course { none, way, time };

struct Fit {
  double squares = 0.0; ///< V^2, of both channels
  double numbers = 0.0; ///< that were fitted
  double slope = 0.0;   ///< rad of the pair's shaft for a rad of the way, or over the whole time
  double slope_variance = 0.0; ///< for noise of 1 V rms
  ArrayXd along;               ///< what is left along the figure, rad of the shaft
};

/// Least squares of both channels: an ellipse of its own centre and axes, and an angle that departs
/// from the reference by orders 1 to `orders` of its turn, by a lag (as the speed) and by `course`
/// (Gauss-Newton: the departures are small but for the slope, which begins at `slope`).
Fit fit(const Rows &rows, int orders, Course course, double slope) {
  constexpr int kSteps = 4;
  const Eigen::Index n = rows.alpha.size();
  const double span = rows.time.size() > 1 ? rows.time[n - 1] - rows.time[0] : 0.0;
  Eigen::MatrixXd departs(n, 2 * orders + 1 + (course == Course::none ? 0 : 1));
  Eigen::Index column = 0;
  const double speed = rows.speed.abs().maxCoeff();
  departs.col(column++) = speed > 0.0 ? ArrayXd(rows.speed / speed) : ArrayXd::Zero(n);
  for (int order = 1; order <= orders; ++order) {
    departs.col(column++) = (order * rows.alpha).cos();
    departs.col(column++) = (order * rows.alpha).sin();
  }
  if (course == Course::way)
    departs.col(column) = rows.alpha;
  else if (course == Course::time)
    departs.col(column) = rows.time / std::max(span, 1e-12);
  Eigen::VectorXd size = Eigen::VectorXd::Zero(departs.cols());
  if (course != Course::none)
    size[column] = slope;
  Fit out;
  out.numbers = 6.0 + static_cast<double>(departs.cols());
  const Eigen::Index all = 6 + departs.cols();
  for (int step = 0; step <= kSteps; ++step) {
    const ArrayXd psi = rows.periods * (rows.alpha + (departs * size).array());
    Eigen::MatrixXd of_sin = Eigen::MatrixXd::Zero(n, all), of_cos = of_sin;
    Eigen::MatrixXd circle(n, 3);
    circle << Eigen::VectorXd::Ones(n), psi.cos().matrix(), psi.sin().matrix();
    const Eigen::LDLT<Eigen::Matrix3d> own(circle.transpose() * circle);
    const Eigen::Vector3d a = own.solve(circle.transpose() * rows.sin.matrix());
    const Eigen::Vector3d b = own.solve(circle.transpose() * rows.cos.matrix());
    const ArrayXd left_sin = rows.sin - (circle * a).array();
    const ArrayXd left_cos = rows.cos - (circle * b).array();
    const ArrayXd moves_sin = rows.periods * (a[2] * psi.cos() - a[1] * psi.sin());
    const ArrayXd moves_cos = rows.periods * (b[2] * psi.cos() - b[1] * psi.sin());
    out.squares = left_sin.square().sum() + left_cos.square().sum();
    if (step == kSteps) {
      const ArrayXd reach = (moves_sin.square() + moves_cos.square()).max(1e-30);
      out.along = (left_sin * moves_sin + left_cos * moves_cos) / reach;
      break;
    }
    of_sin.leftCols(3) = circle;
    of_cos.middleCols(3, 3) = circle;
    of_sin.rightCols(departs.cols()) = departs.array().colwise() * moves_sin;
    of_cos.rightCols(departs.cols()) = departs.array().colwise() * moves_cos;
    const Eigen::MatrixXd normal = of_sin.transpose() * of_sin + of_cos.transpose() * of_cos;
    const Eigen::VectorXd right =
        of_sin.transpose() * left_sin.matrix() + of_cos.transpose() * left_cos.matrix();
    // Columns that are the same on this record (a speed that never changes) share what they take.
    const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver(normal);
    size += solver.solve(right).tail(departs.cols());
    out.slope_variance = solver.pseudoInverse()(all - 1, all - 1);
  }
  out.slope = course == Course::none ? 0.0 : size[column];
  return out;
}

/// By how much more the means of stretches scatter than those of white noise would: what is left
/// over counts for so many fewer rows.
double inflation(const ArrayXd &left) {
  const Eigen::Index stretch = left.size() / static_cast<Eigen::Index>(criteria::kStretches);
  if (stretch < 2)
    return 1.0;
  double squares = 0.0;
  for (std::size_t k = 0; k < criteria::kStretches; ++k)
    squares += std::pow(
        left.segment(static_cast<Eigen::Index>(k) * stretch, stretch).mean() - left.mean(), 2);
  const double variance = (left - left.mean()).square().mean();
  return std::max(1.0, squares / static_cast<double>(criteria::kStretches) *
                           static_cast<double>(stretch) / std::max(variance, 1e-300));
}

/// Mean square of what is left that is slow, rad^2, without what white noise gives to it.
double slow_part(const ArrayXd &left) {
  const double variance = (left - left.mean()).square().mean();
  const auto stretch = static_cast<double>(left.size()) / static_cast<double>(criteria::kStretches);
  return stretch < 2.0 ? variance : variance / stretch * (inflation(left) - 1.0);
}

/// How fast the pair's own angle departs from the reference over several turns, whatever its
/// ellipse: of each turn that comes to nothing.
double departs_over_turns(const Rows &rows) {
  const auto middle = [](const ArrayXd &v) {
    const Reach reach = bulk({v.data(), static_cast<std::size_t>(v.size())});
    return 0.5 * (reach.low + reach.high);
  };
  const double middle_sin = middle(rows.sin), middle_cos = middle(rows.cos);
  double least_way = 0.0, slope = 0.0;
  for (const double sense : {1.0, -1.0}) {
    std::vector<double> apart;
    for (Eigen::Index i = 0; i < rows.alpha.size(); ++i)
      apart.push_back(sense * std::atan2(rows.sin[i] - middle_sin, rows.cos[i] - middle_cos) -
                      rows.periods * rows.alpha[i]);
    unwrap(apart, kTwoPi);
    double way = 0.0;
    for (std::size_t i = 1; i < apart.size(); ++i)
      way += std::abs(apart[i] - apart[i - 1]);
    const ArrayXd off = as_array(apart) / rows.periods;
    if (sense > 0.0 || way < least_way) {
      least_way = way;
      slope = (off * rows.alpha).sum() / std::max(rows.alpha.square().sum(), 1e-300);
    }
  }
  return slope;
}

/// The least of a measure over fits of 0 to some orders, which tell an error of the sensor or of
/// the reference that comes again each turn.
struct Best {
  Fit fit;
  double nats;
};

Best best_of(const std::vector<Fit> &fits, double rows, double inflated) {
  const double effective = 2.0 * rows / inflated;
  std::size_t best = 0;
  std::vector<double> nats;
  for (const Fit &f : fits)
    nats.push_back(0.5 * effective * std::log(std::max(f.squares, 1e-300)) +
                   0.5 * f.numbers * std::log(std::max(effective, 2.0)));
  best = static_cast<std::size_t>(std::min_element(nats.begin(), nats.end()) - nats.begin());
  return {fits[best], nats[best]};
}

struct Slope {
  double value, error; ///< rad of the pair's shaft for a rad of the reference, less one
};

std::optional<Slope> slope_of(const Rows &rows) {
  constexpr int kOrders = 6; // of two periods a turn the third of the electrical angle
  const auto n = static_cast<double>(rows.alpha.size());
  if (n < 2.0 * static_cast<double>(criteria::kFewestSamples))
    return {};
  const double way = rows.alpha.maxCoeff() - rows.alpha.minCoeff();
  const double begin = way > 2.0 * kTwoPi ? departs_over_turns(rows) : 0.0;
  if (std::abs(begin) > criteria::kMostOfScale)
    return {};
  std::array<std::vector<Fit>, 3> fits;
  for (int orders = 0; orders <= kOrders; ++orders) {
    fits[0].push_back(fit(rows, orders, Course::none, 0.0));
    fits[1].push_back(fit(rows, orders, Course::way, begin));
    fits[2].push_back(fit(rows, orders, Course::time, 0.0));
  }
  const double inflated = inflation(fits[1].back().along);
  const Best none = best_of(fits[0], n, inflated), by_way = best_of(fits[1], n, inflated),
             by_time = best_of(fits[2], n, inflated);
  const Fit &found = by_way.fit;
  const double took = std::pow(found.slope, 2) * rows.alpha.square().mean();
  if (none.nats - by_way.nats < criteria::kRivalNats ||
      by_time.nats < by_way.nats - criteria::kRivalNats ||
      std::abs(found.slope) > criteria::kMostOfScale ||
      slow_part(found.along) > (1.0 - criteria::kStraight) * took)
    return {};
  return Slope{found.slope, std::sqrt(found.slope_variance * found.squares / (2.0 * n) * inflated)};
}

} // namespace

std::optional<ReferenceScale> reference_scale(const Capture &capture) {
  if (!capture.has_reference())
    return {};
  std::vector<std::size_t> starts = capture.starts;
  if (starts.empty())
    starts.push_back(0);
  starts.push_back(capture.size());
  std::optional<ReferenceScale> out;
  double weight = 0.0, sum = 0.0, way = 0.0;
  for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
    const Rows rows = rows_of(capture, starts[k], starts[k + 1]);
    const auto slope = slope_of(rows);
    if (!slope)
      continue;
    if (!out)
      out.emplace(ReferenceScale{capture, 1.0, 0.0, false});
    std::vector<double> turned(
        capture.reference_deg.begin() + static_cast<std::ptrdiff_t>(starts[k]),
        capture.reference_deg.begin() + static_cast<std::ptrdiff_t>(starts[k + 1]));
    unwrap(turned, 360.0);
    for (std::size_t i = 0; i < turned.size(); ++i)
      out->mended.reference_deg[starts[k] + i] = (1.0 + slope->value) * turned[i];
    way = std::max(way, rows.alpha.maxCoeff() - rows.alpha.minCoeff());
    const double w = 1.0 / std::max(slope->error * slope->error, 1e-30);
    sum += w * slope->value;
    weight += w;
  }
  if (out) {
    const double turned = 1.0 + sum / weight;
    out->scale = 1.0 / turned;
    out->error = 1.0 / std::sqrt(weight) / (turned * turned);
    out->within_a_turn = way < kTwoPi;
  }
  return out;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/reference_course.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/conditions/travel.h"
#include "diagnosis/criteria.h"
#include "motion/kinematics.h"

namespace ada {

namespace {

using Eigen::ArrayXd;

/// Means of stretches that scatter by so many times what those of white noise do are worth a look
/// for what goes on over time: of forty the variance is known to a quarter.
constexpr double kEven = 2.0;

/// Rows of one record, evenly spread over it.
struct Rows {
  int periods;
  double begin_s = 0.0;          ///< on the clock of the capture, where the time is 0
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
           0.0,
           as_array(time),
           as_array(alpha),
           as_array(sin),
           as_array(cos),
           as_array(differentiate(time, alpha, kHalfWindow).omega)};
  out.begin_s = out.time.mean();
  out.time -= out.begin_s;
  out.alpha -= out.alpha.mean();
  return out;
}

/// What the pair departs by beside the ellipse that it draws: in a straight line over the way, and
/// over time by a polynomial, as a drift changes; degree 0: not at all.
struct Course {
  bool way;
  int degree;
  int numbers() const { return (way ? 1 : 0) + degree; }
};

struct Fit {
  double squares = 0.0; ///< V^2, of both channels
  double numbers = 0.0; ///< that were fitted
  double scale = 0.0;   ///< rad of the pair's shaft for a rad of the way, less one
  Eigen::VectorXd
      drift; ///< rad, coefficients of Chebyshev's polynomials of the time, from the first
  double scale_variance = 0.0, drift_variance = 0.0; ///< for noise of 1 V rms; of the first
  ArrayXd along; ///< what is left along the figure, rad of the shaft
};

double duration(const Rows &rows) {
  return rows.time.maxCoeff() - rows.time.minCoeff();
}

/// Time about the middle of the record, in halves of it.
double place_in_time(const Rows &rows, double time_s) {
  const double middle = 0.5 * (rows.time.maxCoeff() + rows.time.minCoeff());
  return 2.0 * (time_s - middle) / std::max(duration(rows), 1e-12);
}

double chebyshev(int degree, double x) {
  double before = 1.0, now = x;
  for (int k = 1; k < degree; ++k)
    before = std::exchange(now, 2.0 * x * now - before);
  return now;
}

Eigen::MatrixXd columns_of(const Rows &rows, Course course) {
  Eigen::MatrixXd out(rows.alpha.size(), course.numbers());
  Eigen::Index column = 0;
  if (course.way)
    out.col(column++) = rows.alpha;
  for (int degree = 1; degree <= course.degree; ++degree, ++column)
    for (Eigen::Index i = 0; i < out.rows(); ++i)
      out(i, column) = chebyshev(degree, place_in_time(rows, rows.time[i]));
  return out;
}

/// Least squares of both channels: an ellipse of its own centre and axes, and an angle that departs
/// from the reference by orders 1 to `orders` of its turn, by a lag (as the speed) and by `course`
/// (Gauss-Newton: the departures are small but for the course, which begins at `begin`).
Fit fit(const Rows &rows, int orders, Course course, const Eigen::VectorXd &begin) {
  constexpr int kSteps = 3;
  const Eigen::Index n = rows.alpha.size();
  Eigen::MatrixXd departs(n, course.numbers() + 2 * orders + 1);
  Eigen::VectorXd size = Eigen::VectorXd::Zero(departs.cols());
  departs.leftCols(course.numbers()) = columns_of(rows, course);
  size.head(begin.size()) = begin;
  Eigen::Index column = course.numbers();
  const double speed = rows.speed.abs().maxCoeff();
  departs.col(column++) = speed > 0.0 ? ArrayXd(rows.speed / speed) : ArrayXd::Zero(n);
  for (int order = 1; order <= orders; ++order) {
    departs.col(column++) = (order * rows.alpha).cos();
    departs.col(column++) = (order * rows.alpha).sin();
  }
  Fit out;
  out.numbers = 6.0 + static_cast<double>(departs.cols());
  Eigen::VectorXd variances = Eigen::VectorXd::Zero(departs.cols());
  for (int step = 0; step <= kSteps; ++step) {
    const ArrayXd psi = rows.periods * (rows.alpha + (departs * size).array());
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
    Eigen::MatrixXd of_sin = Eigen::MatrixXd::Zero(n, 6 + departs.cols()), of_cos = of_sin;
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
    variances = solver.pseudoInverse().diagonal().tail(departs.cols());
  }
  const Eigen::Index first = course.way ? 1 : 0;
  if (course.way) {
    out.scale = size[0];
    out.scale_variance = variances[0];
  }
  out.drift = size.segment(first, course.degree);
  out.drift_variance = course.degree > 0 ? variances[first] : 0.0;
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
Eigen::VectorXd departs_over_turns(const Rows &rows, Course course) {
  const auto middle = [](const ArrayXd &v) {
    const Reach reach = bulk({v.data(), static_cast<std::size_t>(v.size())});
    return 0.5 * (reach.low + reach.high);
  };
  const double middle_sin = middle(rows.sin), middle_cos = middle(rows.cos);
  ArrayXd off;
  double least_way = std::numeric_limits<double>::infinity();
  for (const double sense : {1.0, -1.0}) { // the sensor may be mounted the other way round
    std::vector<double> apart;
    for (Eigen::Index i = 0; i < rows.alpha.size(); ++i)
      apart.push_back(sense * std::atan2(rows.sin[i] - middle_sin, rows.cos[i] - middle_cos) -
                      rows.periods * rows.alpha[i]);
    unwrap(apart, kTwoPi);
    double way = 0.0;
    for (std::size_t i = 1; i < apart.size(); ++i)
      way += std::abs(apart[i] - apart[i - 1]);
    if (way < least_way) {
      least_way = way;
      off = as_array(apart) / rows.periods;
    }
  }
  const Eigen::MatrixXd x = columns_of(rows, course);
  return (x.transpose() * x)
      .completeOrthogonalDecomposition()
      .solve(x.transpose() * (off - off.mean()).matrix());
}

struct Best {
  Fit fit;
  double nats = std::numeric_limits<double>::infinity(); ///< the fewer the better
};

/// The best of fits with no to some orders of the turn, which tell an error of the sensor or of the
/// reference that comes again each turn, by their information (Schwarz, 1978).
Best best_of(const Rows &rows, Course course, double inflated) {
  constexpr int kOrders = 6; // of two periods a turn the third of the electrical angle
  const auto n = static_cast<double>(rows.alpha.size());
  const double effective = 2.0 * n / inflated;
  const double way = rows.alpha.maxCoeff() - rows.alpha.minCoeff();
  Eigen::VectorXd begin = Eigen::VectorXd::Zero(course.numbers());
  if (way > 2.0 * kTwoPi && course.numbers() > 0)
    begin = departs_over_turns(rows, course);
  Best out;
  for (int orders = 0; orders <= kOrders; ++orders) {
    Fit f = fit(rows, orders, course, begin);
    const double nats = 0.5 * effective * std::log(std::max(f.squares, 1e-300)) +
                        0.5 * f.numbers * std::log(std::max(effective, 2.0));
    if (nats < out.nats)
      out = {std::move(f), nats};
  }
  return out;
}

/// Mean square of the straight line that a fit has over the way and over time, rad^2.
double of_line(const Rows &rows, const Fit &f) {
  const double drift = f.drift.size() > 0 ? 2.0 * f.drift[0] / duration(rows) : 0.0;
  return (f.scale * rows.alpha + drift * rows.time).square().mean();
}

/// Mean square of all of its course, rad^2.
double of_course(const Rows &rows, const Fit &f) {
  const Course course{f.scale_variance > 0.0, static_cast<int>(f.drift.size())};
  Eigen::VectorXd size(course.numbers());
  if (course.way)
    size[0] = f.scale;
  size.tail(f.drift.size()) = f.drift;
  const ArrayXd all = columns_of(rows, course) * size;
  return (all - all.mean()).square().mean();
}

/// The course of one record, if it has one. Errors as of independent noise.
std::optional<Fit> course_of(const Rows &rows) {
  // Of a plain curve; and of one that is known to be none of the shaft's, as no drift is steady.
  constexpr int kPlain = 3, kMostDegrees = 6;
  constexpr double kTurnsOfCurve = 2.0; // in fewer a curve looks like errors of low orders
  const auto n = static_cast<double>(rows.alpha.size());
  if (n < 2.0 * static_cast<double>(criteria::kFewestSamples))
    return {};
  const double inflated = inflation(fit(rows, 6, {true, 0}, Eigen::VectorXd::Zero(1)).along);
  const Best none = best_of(rows, {false, 0}, inflated);
  Best best = best_of(rows, {true, 0}, inflated);
  if (none.nats - best.nats < criteria::kRivalNats && inflation(none.fit.along) < kEven)
    return {};
  // A shaft that turns more evenly than its reference would else pass for one without.
  const auto try_degree = [&](int degree) {
    for (const bool way : {false, true})
      if (Best with = best_of(rows, {way, degree}, inflated);
          with.nats < best.nats - criteria::kRivalNats &&
          std::abs(with.fit.scale) < criteria::kMostOfScale)
        best = std::move(with);
  };
  const auto takes_all_but = [&](double part, double course) {
    return slow_part(best.fit.along) < part * course;
  };
  try_degree(1);
  bool found = takes_all_but(1.0 - criteria::kStraight, of_line(rows, best.fit));
  const std::vector<double> alpha(rows.alpha.begin(), rows.alpha.end());
  if (!found && travel_of(alpha) > kTurnsOfCurve * kTwoPi) {
    for (int degree = 2; degree <= kPlain; ++degree)
      try_degree(degree);
    found = takes_all_but(1.0 - criteria::kPlainCurve, of_course(rows, best.fit));
  }
  if (!found || none.nats - best.nats < criteria::kRivalNats ||
      std::abs(best.fit.scale) > criteria::kMostOfScale)
    return {};
  for (int degree = 2; best.fit.drift.size() > 0 && degree <= kMostDegrees; ++degree)
    try_degree(degree);
  const double variance = best.fit.squares / (2.0 * n) * inflated;
  best.fit.scale_variance *= variance;
  best.fit.drift_variance *= variance;
  return best.fit;
}

/// Means of what several records say, by their errors.
struct Mean {
  double sum = 0.0, weight = 0.0;
  void add(double value, double error) {
    if (error > 0.0) {
      sum += value / (error * error);
      weight += 1.0 / (error * error);
    }
  }
  double value() const { return weight > 0.0 ? sum / weight : 0.0; }
  double error() const { return weight > 0.0 ? 1.0 / std::sqrt(weight) : 0.0; }
};

} // namespace

std::optional<FollowedReference> followed_reference(const Capture &capture) {
  if (!capture.has_reference())
    return {};
  std::vector<std::size_t> starts = capture.starts;
  if (starts.empty())
    starts.push_back(0);
  starts.push_back(capture.size());
  std::optional<FollowedReference> out;
  Mean turned_more, drift;
  double way = 0.0;
  for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
    const Rows rows = rows_of(capture, starts[k], starts[k + 1]);
    const auto found = course_of(rows);
    if (!found)
      continue;
    if (!out)
      out.emplace(FollowedReference{capture, {}});
    const auto begin = static_cast<std::ptrdiff_t>(starts[k]);
    std::vector<double> turned(capture.reference_deg.begin() + begin,
                               capture.reference_deg.begin() +
                                   static_cast<std::ptrdiff_t>(starts[k + 1]));
    unwrap(turned, 360.0);
    const double took_s = std::max(duration(rows), 1e-12);
    // From one end of the record to the other: of an even polynomial that is nothing.
    double over_all = 0.0;
    for (Eigen::Index degree = 1; degree <= found->drift.size(); degree += 2)
      over_all += 2.0 * found->drift[degree - 1] * kDegPerRad;
    Reach bend;
    for (std::size_t i = 0; i < turned.size(); ++i) {
      const double place = place_in_time(rows, capture.time_s[starts[k] + i] - rows.begin_s);
      double off = 0.0;
      for (int degree = 1; degree <= found->drift.size(); ++degree)
        off += found->drift[degree - 1] * chebyshev(degree, place) * kDegPerRad;
      out->mended.reference_deg[starts[k] + i] = (1.0 + found->scale) * turned[i] + off;
      off -= 0.5 * over_all * place;
      bend = i == 0 ? Reach{off, off} : Reach{std::min(bend.low, off), std::max(bend.high, off)};
    }
    if (found->drift.size() > 1)
      out->course.bend_deg = std::max(out->course.bend_deg, bend.width());
    way = std::max(way, rows.alpha.maxCoeff() - rows.alpha.minCoeff());
    turned_more.add(found->scale, std::sqrt(found->scale_variance));
    drift.add(-over_all / took_s, 2.0 * std::sqrt(found->drift_variance) * kDegPerRad / took_s);
  }
  if (!out)
    return {};
  const double turns = 1.0 + turned_more.value();
  out->course.scale = 1.0 / turns;
  out->course.scale_error = turned_more.error() / (turns * turns);
  out->course.drift_deg_s = drift.value();
  out->course.drift_error = drift.error();
  out->course.within_a_turn = way < kTwoPi;
  return out;
}

} // namespace ada

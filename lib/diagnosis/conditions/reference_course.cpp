// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/reference_course.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/conditions/holdout.h"
#include "diagnosis/conditions/travel.h"
#include "diagnosis/criteria.h"
#include "motion/kinematics.h"

namespace ada {

namespace {

using Eigen::ArrayXd;

/// Means of stretches that scatter by so many times what those of white noise do are worth a look
/// for what goes on over time: of forty the variance is known to a quarter.
constexpr double kEven = 2.0;

/// Orders of the turn that an error of sensor or reference has: of two periods a turn the third of
/// the electrical angle.
constexpr int kOrders = 6;

/// A range of values, and places in it from -1 to 1.
struct Interval {
  double middle = 0.0, half = 0.0;
  double place(double x) const { return (x - middle) / std::max(half, 1e-12); }
};

Interval range_of(const ArrayXd &v) {
  return v.size() == 0
             ? Interval{}
             : Interval{0.5 * (v.maxCoeff() + v.minCoeff()), 0.5 * (v.maxCoeff() - v.minCoeff())};
}

/// The reference of some rows, rad, unwrapped; not a number where it has none.
std::vector<double> unwrapped(const Capture &capture, std::size_t begin, std::size_t end) {
  std::vector<std::size_t> read;
  std::vector<double> alpha, out(end - begin, kAbsent);
  for (std::size_t i = begin; i < end; ++i)
    if (std::isfinite(capture.reference_deg[i])) {
      read.push_back(i - begin);
      alpha.push_back(capture.reference_deg[i] * kRadPerDeg);
    }
  unwrap(alpha, kTwoPi);
  for (std::size_t k = 0; k < read.size(); ++k)
    out[read[k]] = alpha[k];
  return out;
}

/// Rows of one record, evenly spread over it.
struct Rows {
  int periods = 1;
  ArrayXd time, alpha, sin, cos; ///< angle: of the reference, rad, unwrapped
  ArrayXd speed, acceleration;   ///< rad/s, rad/s^2
  Interval of_time, of_way;
  double way() const { return 2.0 * of_way.half; }
  /// Between rows, in a straight line.
  double at(const ArrayXd &v, double time_s) const {
    const auto after = std::lower_bound(time.begin(), time.end(), time_s) - time.begin();
    if (after == 0 || after == time.size())
      return v.size() > 0 ? v[std::clamp<Eigen::Index>(after, 0, v.size() - 1)] : 0.0;
    const double step = time[after] - time[after - 1];
    const double part = step > 0.0 ? (time_s - time[after - 1]) / step : 0.0;
    return v[after - 1] + part * (v[after] - v[after - 1]);
  }
};

ArrayXd as_array(const std::vector<double> &v) {
  return Eigen::Map<const ArrayXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

Rows rows_of(const Capture &capture, std::size_t begin, const std::vector<double> &reference) {
  std::vector<std::size_t> whole;
  for (std::size_t k = 0; k < reference.size(); ++k)
    if (std::isfinite(capture.vsin_v[begin + k]) && std::isfinite(capture.vcos_v[begin + k]) &&
        std::isfinite(reference[k]))
      whole.push_back(k);
  const std::size_t stride = whole.size() / criteria::kForScale + 1;
  std::vector<double> time, alpha, sin, cos;
  for (std::size_t k = 0; k < whole.size(); k += stride) {
    time.push_back(capture.time_s[begin + whole[k]]);
    alpha.push_back(reference[whole[k]]);
    sin.push_back(capture.vsin_v[begin + whole[k]]);
    cos.push_back(capture.vcos_v[begin + whole[k]]);
  }
  Rows out;
  out.periods = capture.meta.periods_per_turn;
  out.time = as_array(time);
  out.alpha = as_array(alpha);
  out.sin = as_array(sin);
  out.cos = as_array(cos);
  // The noise of a speed would leave a part of a lag over, for whatever goes as the speed does.
  constexpr std::size_t kLeastWindow = 2;
  const std::size_t half_window = window_of_speed(time, alpha, kLeastWindow);
  const Kinematics motion = differentiate(time, alpha, half_window);
  out.speed = as_array(motion.omega);
  out.acceleration = as_array({motion.accel.begin(), motion.accel.end()});
  out.of_time = range_of(out.time);
  out.of_way = range_of(out.alpha);
  return out;
}

/// What the pair departs by beside the ellipse that it draws: polynomials over the way and over
/// time, of these degrees, a lag that grows with the time, and steps; degree 0: nothing.
struct Course {
  int way = 0, time = 0;
  bool clock = false;            ///< of the reference, which is not the pair's
  std::vector<double> steps_s{}; ///< slips, which are no part of what the reference is mended by
  int slow() const { return way + time + (clock ? 1 : 0); }
  int numbers() const { return slow() + static_cast<int>(steps_s.size()); }
  /// The same with other degrees.
  Course of(int over_way, int over_time) const { return {over_way, over_time, false, steps_s}; }
  Course by_clock() const { return {0, 0, true, steps_s}; }
  Course with_step(double at_s) const {
    Course out = *this;
    out.steps_s.push_back(at_s);
    return out;
  }
};

struct Fit {
  Course course;
  double squares = 0.0; ///< V^2, of both channels
  double numbers = 0.0; ///< that were fitted
  Eigen::VectorXd size{};      ///< rad of the pair's shaft, of Chebyshev's polynomials and the step
  Eigen::VectorXd variances{}; ///< of those, for noise of 1 V rms
  ArrayXd along{};             ///< what is left along the figure, rad of the shaft
};

double chebyshev(int degree, double x) {
  double before = 1.0, now = x;
  for (int k = 1; k < degree; ++k)
    before = std::exchange(now, 2.0 * x * now - before);
  return now;
}

/// What goes with each of the numbers of a course at one row.
Eigen::VectorXd terms_at(const Rows &rows, const Course &course, double time_s, double alpha_rad,
                         double speed_rad_s) {
  Eigen::VectorXd out(course.numbers());
  Eigen::Index k = 0;
  for (int degree = 1; degree <= course.way; ++degree)
    out[k++] = chebyshev(degree, rows.of_way.place(alpha_rad));
  for (int degree = 1; degree <= course.time; ++degree)
    out[k++] = chebyshev(degree, rows.of_time.place(time_s));
  if (course.clock) // of the way that half of the record takes, so that its number is a part of it
    out[k++] = speed_rad_s * rows.of_time.half * rows.of_time.place(time_s);
  for (double at_s : course.steps_s)
    out[k++] = time_s < at_s ? -0.5 : 0.5;
  return out;
}

Eigen::MatrixXd columns_of(const Rows &rows, const Course &course) {
  Eigen::MatrixXd out(rows.alpha.size(), course.numbers());
  for (Eigen::Index i = 0; i < out.rows(); ++i)
    out.row(i) = terms_at(rows, course, rows.time[i], rows.alpha[i], rows.speed[i]);
  return out;
}

/// From one end of a range to the other, of the polynomials from `first` on: of an even one that is
/// nothing.
double end_to_end(const Eigen::VectorXd &size, int first, int degrees) {
  double out = 0.0;
  for (int degree = 1; degree <= degrees; degree += 2)
    out += 2.0 * size[first + degree - 1];
  return out;
}

/// Rad of the pair's shaft for a rad of the reference, less one.
double scale_of(const Rows &rows, const Fit &f) {
  return rows.way() > 0.0 ? end_to_end(f.size, 0, f.course.way) / rows.way() : 0.0;
}

/// Least squares of both channels: an ellipse of its own centre and axes, and an angle that departs
/// from the reference by orders 1 to `orders` of its turn, by a lag and by `course`
/// (Gauss-Newton: the departures are small but for the course, which begins at `begin`).
Fit fit(const Rows &rows, int orders, const Course &course, const Eigen::VectorXd &begin) {
  constexpr int kSteps = 3;
  const Eigen::Index n = rows.alpha.size(), own = course.numbers();
  Eigen::MatrixXd departs(n, own + 1 + 2 * orders);
  departs.leftCols(own) = columns_of(rows, course);
  const double fastest = std::max(rows.speed.abs().maxCoeff(), 1e-300);
  departs.col(own) = rows.speed / fastest;
  Eigen::VectorXd size = Eigen::VectorXd::Zero(departs.cols());
  size.head(own) = begin;
  Fit out{.course = course, .numbers = 6.0 + static_cast<double>(departs.cols())};
  for (int step = 0; step <= kSteps; ++step) {
    // A sensor errs at its own angle, from which the reference has gone away.
    const ArrayXd turned = rows.alpha + (departs.leftCols(own) * size.head(own)).array();
    for (int order = 1; order <= orders; ++order) {
      departs.col(own + 2 * order - 1) = (order * turned).cos();
      departs.col(own + 2 * order) = (order * turned).sin();
    }
    // To second order a lag goes with the acceleration.
    ArrayXd lag_s = ArrayXd::Constant(n, -size[own] / fastest);
    if (course.clock)
      lag_s -= size[course.way + course.time] * (rows.time - rows.of_time.middle);
    const ArrayXd psi = rows.periods * (rows.alpha + (departs * size).array() +
                                        0.5 * lag_s.square() * rows.acceleration);
    Eigen::MatrixXd circle(n, 3);
    circle << Eigen::VectorXd::Ones(n), psi.cos().matrix(), psi.sin().matrix();
    const Eigen::LDLT<Eigen::Matrix3d> normal_of_circle(circle.transpose() * circle);
    const Eigen::Vector3d a = normal_of_circle.solve(circle.transpose() * rows.sin.matrix());
    const Eigen::Vector3d b = normal_of_circle.solve(circle.transpose() * rows.cos.matrix());
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
    out.variances = solver.pseudoInverse().diagonal().segment(6, own);
  }
  out.size = size.head(own);
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

/// How the pair's own angle departs from the reference over several turns, whatever its ellipse: of
/// each turn that comes to nothing.
Eigen::VectorXd departs_over_turns(const Rows &rows, const Course &course) {
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
  Eigen::MatrixXd x(rows.alpha.size(), course.numbers() + 1);
  x << columns_of(rows, course), Eigen::VectorXd::Ones(rows.alpha.size());
  return Eigen::VectorXd((x.transpose() * x)
                             .completeOrthogonalDecomposition()
                             .solve(x.transpose() * off.matrix()))
      .head(course.numbers());
}

/// Where the fits of a course begin: on fewer turns none of it is large.
Eigen::VectorXd begin_of(const Rows &rows, const Course &course) {
  if (rows.way() > 2.0 * kTwoPi && course.numbers() > 0)
    return departs_over_turns(rows, course);
  return Eigen::VectorXd::Zero(course.numbers());
}

struct Best {
  Fit fit;
  double nats = std::numeric_limits<double>::infinity(); ///< the fewer the better
};

/// The fit of one record. What its noise remembers makes the rows count for so many fewer.
class Record {
public:
  explicit Record(const Rows &rows) : rows_(rows) {
    const std::vector<double> alpha(rows.alpha.begin(), rows.alpha.end());
    travel_ = travel_of(alpha);
    inflated_ = inflation_beside({});
  }

  /// The best of fits with no to some orders of the turn, which tell an error of the sensor or of
  /// the reference that comes again each turn, by their information (Schwarz, 1978).
  Best best_of(const Course &course) const {
    const double effective = 2.0 * static_cast<double>(rows_.alpha.size()) / inflated_;
    const Eigen::VectorXd begin = begin_of(rows_, course);
    Best out;
    for (int orders = 0; orders <= kOrders; ++orders) {
      Fit f = fit(rows_, orders, course, begin);
      const double nats = 0.5 * effective * std::log(std::max(f.squares, 1e-300)) +
                          0.5 * f.numbers * std::log(std::max(effective, 2.0));
      if (nats < out.nats)
        out = {std::move(f), nats};
    }
    return out;
  }

  /// The course that the pair departs by, if it does by one.
  std::optional<Fit> course();

  /// Moments at which the pair jumps against the reference: they are fitted beside a course, which
  /// they would bend.
  std::vector<double> steps();

private:
  static constexpr int kPlain = 3; ///< degrees of a plain curve
  const Rows &rows_;
  double inflated_ = 1.0, travel_ = 0.0;

  /// Of what a plain curve over the way and one over time leave beside these steps.
  double inflation_beside(std::vector<double> steps) const {
    const Course all{kPlain, kPlain, false, std::move(steps)};
    return inflation(fit(rows_, kOrders, all, begin_of(rows_, all)).along);
  }

  void try_course(const Course &course, Best &best) const;
  /// What the course adds up to in each row, rad, without its steps.
  ArrayXd slow_of(const Fit &f) const;
  bool is_small(const Fit &f) const;
  bool takes_all_but(double part, const Fit &f) const;
  bool is_a_step(const Best &best) const;
};

/// Takes a better one. A shaft that turns more evenly than its reference would else pass for one
/// without.
void Record::try_course(const Course &course, Best &best) const {
  if (Best with = best_of(course);
      with.nats < best.nats - criteria::kRivalNats && is_small(with.fit))
    best = std::move(with);
}

ArrayXd Record::slow_of(const Fit &f) const {
  const int slow = f.course.slow();
  return columns_of(rows_, f.course).leftCols(slow) * f.size.head(slow);
}

/// Whether a course is a small part of the way that the shaft went.
bool Record::is_small(const Fit &f) const {
  const ArrayXd all = slow_of(f);
  const double most = all.size() > 0 ? all.maxCoeff() - all.minCoeff() : 0.0;
  // No two crystals differ by as much; and where the speed hardly changes the lag of all rows and
  // one that grows may be large and cancel each other.
  constexpr double kMostOfClock = 1e-3;
  if (f.course.clock && std::abs(f.size[f.course.way + f.course.time]) > kMostOfClock)
    return false;
  return std::abs(scale_of(rows_, f)) < criteria::kMostOfScale &&
         most < criteria::kMostOfScale * travel_;
}

/// Whether what is left that is slow is this part of the course, in mean squares, or less.
bool Record::takes_all_but(double part, const Fit &f) const {
  const ArrayXd all = slow_of(f);
  return slow_part(f.along) < part * (all - all.mean()).square().mean();
}

std::vector<double> Record::steps() {
  constexpr std::size_t kMostSteps = 4;
  constexpr std::array<Eigen::Index, 3> kSides{3, 9, 27}; // rows before and after
  const Eigen::Index n = rows_.time.size();
  const std::vector<double> alpha(rows_.alpha.begin(), rows_.alpha.end());
  if (find_stops(alpha, noise_between(alpha))) // each has an error of its own
    return {};
  // What stands out of the noise from row to row, by chance once in a million; all together, as one
  // slip may hide another.
  constexpr double kStandsOut = 5.0;
  Best best = best_of({.way = 1, .time = 1});
  if (best.fit.along.size() != n) // values beyond all measure
    return {};
  const double noise = noise_between({best.fit.along.data(), static_cast<std::size_t>(n)});
  while (best.fit.course.steps_s.size() < kMostSteps) {
    const ArrayXd &left = best.fit.along;
    std::vector<double> sums(1, 0.0);
    for (double v : left)
      sums.push_back(sums.back() + v);
    Eigen::Index at = 0;
    double most = 0.0;
    for (Eigen::Index side : kSides)
      for (Eigen::Index i = side; i + side <= n; ++i) {
        const double gap = std::abs(sums[static_cast<std::size_t>(i + side)] -
                                    2.0 * sums[static_cast<std::size_t>(i)] +
                                    sums[static_cast<std::size_t>(i - side)]) /
                           std::sqrt(static_cast<double>(side));
        if (gap > most) {
          most = gap;
          at = i;
        }
      }
    if (!(most > kStandsOut * std::numbers::sqrt2 * noise))
      break;
    Best with = best_of(best.fit.course.with_step(rows_.time[at]));
    if (with.fit.along.size() != n || !(with.fit.squares < best.fit.squares))
      break;
    best = std::move(with);
  }
  std::vector<double> steps = best.fit.course.steps_s;
  if (steps.empty())
    return steps;
  // What all of them leave tells for how many rows it counts; those stay that are worth a number,
  // and the choice of a row for it.
  inflated_ = inflation_beside(steps);
  const double penalty = criteria::kRivalNats + std::log(static_cast<double>(n));
  best = best_of(best.fit.course);
  for (std::size_t k = steps.size(); k-- > 0;) {
    std::vector<double> fewer = steps;
    fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(k));
    if (Best without = best_of({1, 1, false, fewer}); without.nats < best.nats + penalty) {
      best = std::move(without);
      steps = std::move(fewer);
    }
  }
  inflated_ = inflation_beside(steps);
  return steps;
}

/// Whether one more step at some moment does as well: a slip is likelier.
bool Record::is_a_step(const Best &best) const {
  constexpr Eigen::Index kMoments = 40, kCloser = 5;
  const Eigen::Index rows = rows_.time.size();
  Eigen::Index at = rows / 2;
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index apart = std::max<Eigen::Index>(1, rows / kMoments), reach = rows / 2;;
       reach = apart, apart = std::max<Eigen::Index>(1, apart / kCloser)) {
    const Eigen::Index about = at;
    for (Eigen::Index row = about - reach; row <= about + reach; row += apart) {
      if (row <= 0 || row >= rows)
        continue;
      if (const double nats = best_of(best.fit.course.of(0, 0).with_step(rows_.time[row])).nats;
          nats < least) {
        least = nats;
        at = row;
      }
    }
    if (least < best.nats + criteria::kRivalNats)
      return true;
    if (apart == 1)
      return false;
  }
}

std::optional<Fit> Record::course() {
  constexpr int kMostDegrees = 6;       // of a course that is known to be none of the shaft's
  constexpr double kTurnsOfCurve = 2.0; // in fewer a curve looks like errors of low orders
  const Course slips{.steps_s = steps()};
  const Best none = best_of(slips);
  Best best = best_of(slips.of(1, 0));
  if (!std::isfinite(none.nats) || !std::isfinite(best.nats) || // values beyond all measure
      (none.nats - best.nats < criteria::kRivalNats && inflation(none.fit.along) < kEven))
    return {};
  try_course(slips.of(0, 1), best);
  // Another clock leaves nothing that is slow, which no walk is likely to do.
  constexpr double kLeftByClock = 0.005;
  Best by_clock = best;
  try_course(slips.by_clock(), by_clock);
  if (by_clock.fit.course.clock && takes_all_but(kLeftByClock, by_clock.fit))
    best = std::move(by_clock);
  try_course(slips.of(1, 1), best);
  bool found = takes_all_but(1.0 - criteria::kStraight, best.fit);
  const bool may_bend = travel_ > kTurnsOfCurve * kTwoPi;
  if (!found && may_bend) {
    for (int degree = 2; degree <= kPlain; ++degree) {
      try_course(slips.of(degree, 0), best);
      try_course(slips.of(0, degree), best);
      try_course(slips.of(1, degree), best);
    }
    found = takes_all_but(1.0 - criteria::kPlainCurve, best.fit);
  }
  if (!found || none.nats - best.nats < criteria::kRivalNats || !is_small(best.fit) ||
      is_a_step(best))
    return {};
  const Course kind = best.fit.course;
  for (int degree = 2; may_bend && !kind.clock && degree <= kMostDegrees; ++degree)
    try_course(kind.time > 0 ? kind.of(kind.way, degree) : kind.of(degree, 0), best);
  best.fit.variances *=
      best.fit.squares / (2.0 * static_cast<double>(rows_.alpha.size())) * inflated_;
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

/// What the courses of all records have in common.
struct Told {
  Mean turns_more, drift_deg_s, clock_ppm;
  double bend_deg = 0.0, way = 0.0;
  double squares_rad2 = 0.0; ///< of the courses, over all rows
  int numbers = 0;
};

/// Gives rows from `begin` on the degrees that the pair turned by.
void mend(const Rows &rows, const Fit &found, const std::vector<double> &reference,
          std::size_t begin, Capture &capture, Told &told) {
  const double scale = scale_of(rows, found);
  const double took_s = std::max(2.0 * rows.of_time.half, 1e-12);
  const double drift = end_to_end(found.size, found.course.way, found.course.time) / took_s;
  Reach bend{0.0, 0.0};
  for (std::size_t k = 0; k < reference.size(); ++k) {
    const double time_s = capture.time_s[begin + k];
    const int slow = found.course.slow();
    double off = terms_at(rows, found.course, time_s, reference[k], rows.at(rows.speed, time_s))
                     .head(slow)
                     .dot(found.size.head(slow));
    if (found.course.clock) { // to second order, as in the fit
      const double lag_s =
          found.size[found.course.way + found.course.time] * (time_s - rows.of_time.middle);
      off += 0.5 * lag_s * lag_s * rows.at(rows.acceleration, time_s);
    }
    capture.reference_deg[begin + k] = (reference[k] + off) * kDegPerRad;
    if (std::isnan(off))
      continue;
    told.squares_rad2 += off * off;
    const double bent =
        off - scale * (reference[k] - rows.of_way.middle) - drift * (time_s - rows.of_time.middle);
    bend = {std::min(bend.low, bent), std::max(bend.high, bent)};
  }
  if (found.course.way > 1 || found.course.time > 1)
    told.bend_deg = std::max(told.bend_deg, bend.width() * kDegPerRad);
  told.way = std::max(told.way, rows.way());
  told.numbers += found.course.slow();
  if (found.course.clock) {
    constexpr double kPpm = 1e6;
    const Eigen::Index at = found.course.way + found.course.time;
    told.clock_ppm.add(kPpm * found.size[at], kPpm * std::sqrt(found.variances[at]));
  }
  if (found.course.way > 0)
    told.turns_more.add(scale, 2.0 * std::sqrt(found.variances[0]) / rows.way());
  if (found.course.time > 0)
    told.drift_deg_s.add(-drift * kDegPerRad,
                         2.0 * kDegPerRad / took_s * std::sqrt(found.variances[found.course.way]));
}

} // namespace

std::optional<FollowedReference> followed_reference(const Capture &capture) {
  if (!capture.has_reference())
    return {};
  std::vector<std::size_t> starts = capture.starts;
  if (starts.empty())
    starts.push_back(0);
  starts.push_back(capture.size());
  std::optional<FollowedReference> out;
  Told told;
  for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
    const std::vector<double> reference = unwrapped(capture, starts[k], starts[k + 1]);
    const Rows rows = rows_of(capture, starts[k], reference);
    if (rows.alpha.size() < static_cast<Eigen::Index>(2 * criteria::kFewestSamples))
      continue;
    const auto found = Record(rows).course();
    if (!found)
      continue;
    if (!out)
      out.emplace(FollowedReference{capture, {}});
    mend(rows, *found, reference, starts[k], out->mended, told);
  }
  if (!out)
    return {};
  const double turns = 1.0 + told.turns_more.value();
  out->course = {.numbers = told.numbers,
                 .rms_rad = std::sqrt(told.squares_rad2 / static_cast<double>(capture.size())),
                 .scale = 1.0 / turns,
                 .scale_error = told.turns_more.error() / (turns * turns),
                 .drift_deg_s = told.drift_deg_s.value(),
                 .drift_error = told.drift_deg_s.error(),
                 .clock_ppm = told.clock_ppm.value(),
                 .clock_error = told.clock_ppm.error(),
                 .bend_deg = told.bend_deg,
                 .within_a_turn = told.way < kTwoPi};
  return out;
}

} // namespace ada

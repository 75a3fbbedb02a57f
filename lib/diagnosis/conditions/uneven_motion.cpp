// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/uneven_motion.h"

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <optional>
#include <utility>
#include <vector>

#include "base/angle.h"
#include "base/robust.h"
#include "base/solve.h"
#include "diagnosis/criteria.h"
#include "motion/spline.h"

namespace ada {

namespace {

/// Whole turns in one sense, as [first, last] sample.
std::vector<std::pair<std::size_t, std::size_t>> whole_turns(const Kinematics &motion) {
  std::vector<std::pair<std::size_t, std::size_t>> out;
  std::size_t first = 0;
  for (std::size_t i = 1; i < motion.alpha.size(); ++i) {
    if (motion.direction[i] != motion.direction[first]) {
      first = i;
    } else if (std::abs(motion.alpha[i] - motion.alpha[first]) >= kTwoPi) {
      out.emplace_back(first, i);
      first = i;
    }
  }
  return out;
}

/// Coefficient of an order of the turn in the speed along one turn, over its mean speed: the change
/// of speed that is left beside an even one, as of a shaft that runs up.
double at_order(const Kinematics &motion, std::size_t first, std::size_t last, int order) {
  const double from = motion.alpha[first], length = motion.alpha[last] - from;
  // Sums over the turn, each sample by the angle that it stands for.
  double mean = 0.0, slope = 0.0;
  std::complex<double> at = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    const double part = (motion.alpha[i + 1] - motion.alpha[i]) / length;
    const double x = (0.5 * (motion.alpha[i] + motion.alpha[i + 1]) - from) / length; // 0 to 1
    const double speed = 0.5 * (motion.omega[i] + motion.omega[i + 1]);
    mean += part * speed;
    slope += part * speed * 12.0 * (x - 0.5);
    at += 2.0 * part * speed * std::polar(1.0, -order * kTwoPi * x);
  }
  // Twice the integral of x e^(-2 pi j n x) from 0 to 1 is j / (pi n).
  at -= slope * std::complex<double>(0.0, 1.0 / (kPi * order));
  return mean != 0.0 ? std::abs(at / mean) : 0.0;
}

/// Of a turn, the least that must be usable for its ripple to be known by itself.
constexpr double kKnownOfTurn = 0.75;

/// Coefficient of an order in what a smooth motion leaves of the angle along one turn, beside its
/// mean, from the usable samples; nothing where too much of the turn is missing. What was left out
/// is no smooth motion, and says nothing of how the ripple differs from turn to turn.
std::optional<std::complex<double>> left_at_order(const Kinematics &motion,
                                                  std::span<const double> angle,
                                                  std::span<const char> usable, std::size_t first,
                                                  std::size_t last, int order) {
  const std::vector<double> &alpha = motion.alpha;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = first; i < last; ++i) {
    if (!usable[i])
      continue;
    const Eigen::Vector3d row{1.0, std::cos(order * alpha[i]), std::sin(order * alpha[i])};
    const double way = std::abs(alpha[i + 1] - alpha[i]) / kTwoPi;
    normal += way * row * row.transpose();
    right += way * (angle[i] - alpha[i]) * row;
  }
  if (normal(0, 0) < kKnownOfTurn)
    return std::nullopt;
  const Eigen::Vector3d fit = solved(normal, right);
  return std::complex<double>{fit[1], -fit[2]};
}

/// Whether an order of what a smooth motion leaves of the angle is chance: it differs from turn to
/// turn by more than its mean over the turns, or stands in too few turns to have been seen again.
/// What falls with the speed, as a shaft's ripple does: each turn counts by its part of it.
bool differs_by_turn(const Kinematics &motion, std::span<const double> angle,
                     std::span<const char> usable,
                     const std::vector<std::pair<std::size_t, std::size_t>> &turns, int order,
                     bool falls) {
  const std::vector<double> &alpha = motion.alpha;
  const double slowest = falls ? slowest_of_range(motion.omega) : 0.0;
  std::vector<std::complex<double>> at;
  std::vector<double> part;
  std::complex<double> sum = 0.0;
  double squares = 0.0, fourths = 0.0;
  for (const auto &[first, last] : turns) {
    const auto of = left_at_order(motion, angle, usable, first, last, order);
    if (!of)
      continue;
    double fall = 1.0;
    if (slowest > 0.0) {
      fall = 0.0;
      for (std::size_t i = first; i < last; ++i)
        fall += ripple_at(motion.omega[i], slowest) * std::abs(alpha[i + 1] - alpha[i]) / kTwoPi;
    }
    at.push_back(*of);
    part.push_back(fall);
    sum += fall * *of;
    squares += fall * fall;
    fourths += std::pow(fall, 4);
  }
  const double effective = at.empty() ? 0.0 : squares * squares / fourths;
  if (effective < criteria::kFewestTurnsToRepeat)
    return true;
  const std::complex<double> mean = sum / squares;
  double apart2 = 0.0;
  for (std::size_t k = 0; k < at.size(); ++k)
    apart2 += std::norm(at[k] - part[k] * mean);
  // A speed that wanders over some turns is off alike in neighbours, and so many turns are worth
  // fewer (of a first-order process (1 - r) / (1 + r) as many). Of a law that does not hold the
  // rest goes on as well: this is asked where the size is the same at every speed.
  double together = 0.0;
  for (std::size_t k = 1; k < at.size(); ++k)
    together += std::real((at[k] - part[k] * mean) * std::conj(at[k - 1] - part[k - 1] * mean));
  const double alike = falls || !(apart2 > 0.0) ? 0.0 : std::max(0.0, together / apart2);
  apart2 *= (1.0 + alike) / std::max(1.0 - alike, 1e-3);
  // Of so few turns the scatter is little known: the ratio is of an F distribution with 2 and
  // 2 (n - 1) degrees of freedom, which exceeds f with a probability of (1 + f / (n - 1))^-(n - 1).
  // For many turns that is e^-f, the chance of kChanceRipple.
  const double n = static_cast<double>(at.size()), free = effective - 1.0;
  const double least = free * std::expm1(criteria::kChanceRipple * criteria::kChanceRipple / free);
  return std::norm(mean) * squares < least * apart2 / (n - 1.0);
}

} // namespace

double beyond_knots(const std::vector<double> &knots, std::span<const double> time,
                    std::span<const double> angle, std::span<const char> usable, double order,
                    std::span<const double> size) {
  CubicSpline spline(knots);
  double left = 0.0, all = 0.0;
  std::vector<double> ripple(angle.size());
  for (const double quarter : {0.0, 0.5 * kPi}) {
    for (std::size_t i = 0; i < angle.size(); ++i)
      ripple[i] = (size.empty() ? 1.0 : size[i]) * std::cos(order * angle[i] - quarter);
    spline.fit(time, ripple, usable, 0, {});
    for (std::size_t i = 0; i < angle.size(); ++i)
      if (usable[i]) {
        left += std::pow(ripple[i] - spline.value(time[i]), 2);
        all += ripple[i] * ripple[i];
      }
  }
  return all > 0.0 ? left / all : 0.0;
}

bool ripples_by_chance(const SmoothMotion &smooth, std::span<const double> time,
                       std::span<const double> angle, std::span<const char> usable) {
  const auto turns = whole_turns(smooth.motion);
  if (turns.size() < 2)
    return false;
  // Of the speed the largest part, and of the angle.
  int order = 0, widest = 0;
  double most = 0.0, ripple_rad = 0.0, widest_rad = 0.0;
  for (std::size_t k = 0; k < smooth.cos.size(); ++k) {
    const double rad = std::hypot(smooth.cos[k], smooth.sin[k]);
    if (const double of_speed = static_cast<double>(k + 1) * rad; of_speed > most) {
      most = of_speed;
      ripple_rad = rad;
      order = static_cast<int>(k + 1);
    }
    if (rad > widest_rad) {
      widest_rad = rad;
      widest = static_cast<int>(k + 1);
    }
  }
  if (widest == 0 || widest_rad < smooth.residual_rms_rad)
    return false;
  if (beyond_knots(smooth.knots, time, angle, usable, widest) < criteria::kBeyondKnots)
    return true;
  if (ripple_rad < smooth.residual_rms_rad)
    return false;
  if (differs_by_turn(smooth.motion, angle, usable, turns, order, true))
    return true;
  std::vector<double> by_turn;
  for (const auto &[first, last] : turns)
    by_turn.push_back(at_order(smooth.motion, first, last, order));
  return most < criteria::kChanceRipple * quantile(by_turn, 0.5) /
                    std::sqrt(static_cast<double>(turns.size()));
}

bool differs_from_turn_to_turn(const Kinematics &motion, std::span<const double> angle,
                               std::span<const char> usable, int order, bool falls) {
  const auto turns = whole_turns(motion);
  return turns.size() >= 2 && differs_by_turn(motion, angle, usable, turns, order, falls);
}

} // namespace ada

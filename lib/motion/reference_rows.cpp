// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "motion/reference_rows.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <utility>

#include <Eigen/Dense>

#include "base/angle.h"
#include "base/robust.h"
#include "base/sense.h"
#include "motion/spline.h"

namespace ada {

namespace {

/// Orders that are fitted together with a motion; higher ones are far from what its knots can
/// follow.
constexpr int kFittedRipples = 20;
constexpr double kRowsOfRipples = 131072.0; ///< from twice as many on a part of the rows will do

/// Cosine and sine part of each order beside a smooth motion: a spline with a knot every other turn
/// of travel, stiff enough to leave a ripple of order 1 to it.
std::vector<std::complex<double>> periodic_part(std::span<const double> time,
                                                std::span<const double> angle,
                                                std::span<const char> usable, int orders) {
  constexpr double kKnotEvery = 2.0; // turns
  const int fitted = std::min(orders, kFittedRipples);
  double turns = 0.0;
  for (std::size_t i = 1; i < angle.size(); ++i)
    turns += std::abs(angle[i] - angle[i - 1]) / kTwoPi;
  const double pieces = std::max(1.0, std::floor(turns / kKnotEvery));
  std::vector<double> knots{time.front()};
  double travel = 0.0;
  for (std::size_t i = 1; i + 1 < angle.size(); ++i) {
    travel += std::abs(angle[i] - angle[i - 1]) / kTwoPi;
    if (travel * pieces >= turns * static_cast<double>(knots.size()) && time[i] > knots.back() &&
        static_cast<double>(knots.size()) < pieces)
      knots.push_back(time[i]);
  }
  knots.push_back(time.back());
  CubicSpline motion(std::move(knots));
  motion.fit(time, angle, usable, static_cast<std::size_t>(2 * fitted),
             [&](std::size_t i, double *term) {
               const std::complex<double> once = std::polar(1.0, angle[i]);
               std::complex<double> z = once;
               for (int n = 0; n < fitted; ++n, z *= once) {
                 *term++ = z.real();
                 *term++ = z.imag();
               }
             });
  std::vector<std::complex<double>> out;
  for (std::size_t k = 0; k < motion.term_coefficients().size(); k += 2)
    out.emplace_back(motion.term_coefficients()[k], motion.term_coefficients()[k + 1]);
  // Over whole turns the others are orthogonal to these, and to each other.
  std::vector<std::complex<double>> others(static_cast<std::size_t>(orders - fitted));
  double count = 0.0;
  for (std::size_t i = 0; i < angle.size() && !others.empty(); ++i) {
    if (!usable.empty() && !usable[i])
      continue;
    const std::complex<double> once = std::polar(1.0, angle[i]);
    std::complex<double> z = once;
    double left = angle[i] - motion.value(time[i]);
    for (const std::complex<double> &c : out) {
      left -= c.real() * z.real() + c.imag() * z.imag();
      z *= once;
    }
    count += 1.0;
    for (std::complex<double> &sum : others) {
      sum += left * z;
      z *= once;
    }
  }
  for (const std::complex<double> &sum : others)
    out.push_back(2.0 * sum / std::max(count, 1.0));
  return out;
}

/// The `share` quantile of what rows that were taken at like speed depart by, for each row: an
/// error of the time of a reading grows with the speed, and so does what is usual.
std::vector<double> common_at_speed(const std::vector<double> &departure,
                                    std::span<const double> pair, std::size_t reach, double share) {
  constexpr std::size_t kRowsOfSpeed = 400; // of which the quantile is known to 7 %
  constexpr std::size_t kMostSpeeds = 16;
  const std::size_t n = departure.size();
  std::vector<double> speed(n);
  for (std::size_t i = 0; i < n; ++i)
    speed[i] = std::abs(pair[std::min(n - 1, i + reach)] - pair[i - std::min(i, reach)]);
  std::vector<std::size_t> by_speed(n);
  std::iota(by_speed.begin(), by_speed.end(), std::size_t{0});
  std::stable_sort(by_speed.begin(), by_speed.end(),
                   [&](std::size_t a, std::size_t b) { return speed[a] < speed[b]; });
  const std::size_t groups = std::clamp(n / kRowsOfSpeed, std::size_t{1}, kMostSpeeds);
  std::vector<double> out(n);
  for (std::size_t g = 0; g < groups; ++g) {
    const std::size_t first = g * n / groups, end = (g + 1) * n / groups;
    std::vector<double> sizes;
    for (std::size_t k = first; k < end; ++k)
      sizes.push_back(std::abs(departure[by_speed[k]]));
    const double usual = quantile(std::move(sizes), share);
    for (std::size_t k = first; k < end; ++k)
      out[by_speed[k]] = usual;
  }
  return out;
}

} // namespace

RowsApart mend_rows(std::vector<double> &reference, std::span<const double> pair, double step) {
  constexpr double kFar = 8.0; // standard deviations of white noise
  // Times what one row in seven departs by; of normal ones that is 6.5 standard deviations.
  constexpr double kOfCommon = 4.5;
  constexpr double kCommon = 0.85;
  // Of ten rows: seven in a row then hold four good ones, all but once in 400.
  constexpr std::size_t kRare = 10;
  constexpr double kOfSteps = 1.5;  // a row may fall to either side of one
  constexpr double kOfPair = 0.5;   // of the departure: more of it would be the pair's own
  constexpr std::size_t kReach = 3; // of the median: at the ends of the record it is one-sided
  constexpr std::size_t kSide = 5;  // rows, of which two may be wrong as well
  const std::size_t n = reference.size();
  if (n < kRareSample)
    return {};
  const double sense = common_sense(
      n - 1, [&](std::size_t i) { return wrap_centred(reference[i + 1] - reference[i], kTwoPi); },
      [&](std::size_t i) { return pair[i + 1] - pair[i]; });
  std::complex<double> sum;
  for (std::size_t i = 0; i < n; ++i)
    sum += std::polar(1.0, reference[i] - sense * pair[i]);
  std::vector<double> off(n);
  for (std::size_t i = 0; i < n; ++i)
    off[i] = wrap_centred(reference[i] - sense * pair[i] - std::arg(sum), kTwoPi);
  std::vector<double> departure = off_medians(off);
  for (double &d : departure) // medians of what lies about half a turn may have either sign
    d = wrap_centred(d, kTwoPi);
  const double least = std::max(kFar * noise_between(off), kOfSteps * step);
  const std::vector<double> common = common_at_speed(departure, pair, kReach, kCommon);
  RowsApart out;
  // What a row departs by from the straight line between good rows on either side.
  const auto own = [&](std::size_t i) {
    const double span = wrap_centred(reference[i + kReach] - reference[i - kReach], kTwoPi);
    return wrap_centred(reference[i] - reference[i - kReach] - 0.5 * span, kTwoPi);
  };
  const auto its_own = [&](std::size_t i) {
    return std::abs(wrap_centred(own(i) - departure[i], kTwoPi)) < kOfPair * std::abs(departure[i]);
  };
  // Off another row, about what the row departs by: half a turn has no sign.
  const auto off_row = [&](std::size_t i, std::size_t k) {
    return departure[i] + wrap_centred(off[i] - off[k] - departure[i], kTwoPi);
  };
  // It is off the parabola through those beside it: where the pair's own error is largest a row
  // lies beyond them, and bends no more than they do. Rows that are off it themselves are wrong as
  // well.
  const auto leaves_parabola = [&](std::size_t i) {
    constexpr double kWrongToo = 0.25; // of the departure
    std::vector<std::pair<double, double>> beside;
    for (std::size_t k = i - std::min(i, kSide); k < std::min(n, i + 1 + kSide); ++k)
      if (k != i)
        beside.emplace_back(static_cast<double>(k) - static_cast<double>(i), -off_row(i, k));
    for (;; beside.pop_back()) {
      Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
      Eigen::Vector3d right = Eigen::Vector3d::Zero();
      for (const auto &[d, y] : beside) {
        const Eigen::Vector3d row(1.0, d, d * d);
        normal += row * row.transpose();
        right += row * y;
      }
      const Eigen::Vector3d parabola = normal.ldlt().solve(right);
      const auto left = [&](const std::pair<double, double> &at) {
        return std::abs(at.second - parabola[0] -
                        at.first * (parabola[1] + at.first * parabola[2]));
      };
      const auto worst = std::ranges::max_element(beside, {}, left);
      if (beside.size() <= kSide || left(*worst) < kWrongToo * std::abs(departure[i]))
        return std::abs(parabola[0]) > kOfPair * std::abs(departure[i]);
      std::swap(*worst, beside.back());
    }
  };
  for (std::size_t i = kReach; i + kReach < n; ++i)
    if (std::abs(departure[i]) > std::max(least, kOfCommon * common[i]) && its_own(i) &&
        leaves_parabola(i)) {
      out.rows.push_back(static_cast<std::uint32_t>(i));
      out.by_rad.push_back(std::abs(departure[i]));
    }
  if (out.rows.size() * kRare > n)
    return {};
  for (std::uint32_t i : out.rows)
    reference[i] -= departure[i];
  return out;
}

std::vector<Ripple> ripples_against_time(std::span<const double> time,
                                         std::span<const double> angle,
                                         std::span<const char> usable, int orders) {
  // Of one turn and a half a smooth motion and a ripple once a turn are still apart.
  constexpr double kMostParts = 8.0, kTurnsOfPart = 4.0, kFewestTurns = 1.5;
  constexpr std::size_t kFewestParts = 3;
  // So few parts: their median says little of how they scatter, and with four degrees of freedom
  // one in a hundred lies beyond nearly twice as many standard deviations as of a normal
  // distribution.
  constexpr std::size_t kFewParts = 5, kVeryFewParts = 4;
  constexpr double kStudent = 2.0;
  // Rad: what a motion that ripples by nothing shows beside a drive that is never quite even.
  constexpr double kLeastError = 5e-5;
  constexpr double kOfMedian = 1.5; // standard deviation over the median of a vector's length
  double travel = 0.0;
  for (std::size_t i = 1; i < angle.size(); ++i)
    travel += std::abs(angle[i] - angle[i - 1]);
  // Of a long record every so many rows, as long as twice as many are left as the orders take.
  const double rows = static_cast<double>(angle.size());
  const auto every = static_cast<std::size_t>(
      std::min(rows / kRowsOfRipples, rows / std::max(1.0, 8.0 * orders * travel / kTwoPi)));
  if (every > 1) {
    std::vector<double> some_time, some_angle;
    std::vector<char> some_usable;
    for (std::size_t i = 0; i < angle.size(); i += every) {
      some_time.push_back(time[i]);
      some_angle.push_back(angle[i]);
      some_usable.push_back(usable[i]);
    }
    return ripples_against_time(some_time, some_angle, some_usable, orders);
  }
  const auto parts = static_cast<std::size_t>(
      std::clamp(travel / kTwoPi / kTurnsOfPart, static_cast<double>(kFewestParts), kMostParts));
  // Parts of as many turns each: of a drive that has several speeds most then hold one of them.
  std::vector<std::size_t> begins{0};
  double travelled = 0.0;
  for (std::size_t i = 1; i < angle.size(); ++i) {
    travelled += std::abs(angle[i] - angle[i - 1]);
    if (travelled * static_cast<double>(parts) >= travel * static_cast<double>(begins.size()) &&
        begins.size() < parts)
      begins.push_back(i);
  }
  begins.push_back(angle.size());
  // Of two samples to the period of an order nothing is left to judge it by.
  orders = std::min(orders, static_cast<int>(static_cast<double>(angle.size()) /
                                             std::max(1.0, 4.0 * travel / kTwoPi)));
  const auto terms = static_cast<std::size_t>(2 * std::min(orders, kFittedRipples));
  std::vector<std::vector<std::complex<double>>> seen;
  for (std::size_t k = 0; k + 1 < begins.size(); ++k) {
    const std::size_t first = begins[k], part = begins[k + 1] - first;
    const auto piece = angle.subspan(first, part);
    double turns = 0.0;
    for (std::size_t i = 1; i < part; ++i)
      turns += std::abs(piece[i] - piece[i - 1]) / kTwoPi;
    if (turns >= kFewestTurns && part >= 10 * terms)
      seen.push_back(
          periodic_part(time.subspan(first, part), piece, usable.subspan(first, part), orders));
  }
  if (seen.size() < kFewestParts)
    return {};
  std::vector<Ripple> out;
  for (std::size_t n = 0; n < seen.front().size(); ++n) {
    std::vector<double> re, im, off;
    for (const auto &part_of : seen) {
      re.push_back(part_of[n].real());
      im.push_back(part_of[n].imag());
    }
    Ripple r{quantile(re, 0.5), quantile(im, 0.5), 0.0};
    double squares = 0.0;
    for (std::size_t k = 0; k < re.size(); ++k) {
      off.push_back(std::hypot(re[k] - r.cos, im[k] - r.sin));
      squares += off.back() * off.back();
    }
    const auto count = static_cast<double>(re.size());
    double scatter = kOfMedian * quantile(std::move(off), 0.5);
    if (re.size() <= kFewParts)
      scatter = std::max(scatter, std::sqrt(0.5 * squares / (count - 1.0)) *
                                      (re.size() <= kVeryFewParts ? kStudent : 1.0));
    r.error = std::max(scatter / std::sqrt(count), kLeastError);
    out.push_back(r);
  }
  return out;
}

} // namespace ada

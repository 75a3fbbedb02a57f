// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/anonymous/steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>

#include <Eigen/Dense>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/criteria.h"

namespace ada {

namespace {

using Complex = std::complex<double>;
constexpr std::size_t kPair = 3;
/// Stretches on either side that a jump is taken from; fewer at the ends, but so many at least.
constexpr std::size_t kBeside = 3, kLeastBeside = 2;

/// The columns that the coefficients of a pair stand for, of one sample.
Eigen::Vector3cd columns_of(const Basis &basis, const Observations &data, std::size_t i) {
  const Complex turn = std::polar(1.0, basis.periods() * basis.angle(data, i));
  return {Complex(1.0), turn, std::conj(turn)};
}

/// Least squares of the coefficients of a pair, sample by sample.
struct PairFit {
  Eigen::Matrix3cd normal = Eigen::Matrix3cd::Zero();
  Eigen::Vector3cd right = Eigen::Vector3cd::Zero();
  double samples = 0.0;

  void add(const Eigen::Vector3cd &columns, Complex left) {
    normal += columns.conjugate() * columns.transpose();
    right += columns.conjugate() * left;
    samples += 1.0;
  }
  PairFit operator-(const PairFit &other) const {
    return {normal - other.normal, right - other.right, samples - other.samples};
  }
  Eigen::Vector3cd values() const {
    Eigen::Matrix3cd a = normal;
    a.diagonal().array() += criteria::kRidge * samples;
    return a.ldlt().solve(right);
  }
  /// Of the sum of squares.
  double explained() const { return right.dot(values()).real(); }
};

struct Stretch {
  std::array<double, 2 * kPair> of_pair{}; ///< real and imaginary parts of its coefficients, V
  double speed = 0.0, from_s = 0.0, to_s = 0.0;
};

/// Samples [first, end) with the coefficients of the pair that suit them best: means alone would
/// mix, where a stretch does not hold whole periods.
Stretch stretch_of(const Basis &basis, const Observations &data, const ResidualColumns &rest,
                   std::size_t first, std::size_t end) {
  PairFit fit;
  Stretch out;
  const auto n = static_cast<double>(end - first);
  for (std::size_t i = first; i < end; ++i) {
    fit.add(columns_of(basis, data, i), {rest.cos[i], rest.sin[i]});
    out.speed += data.omega[i] / n;
  }
  const Eigen::Vector3cd values = fit.values();
  for (Eigen::Index k = 0; k < 3; ++k) {
    out.of_pair[static_cast<std::size_t>(2 * k)] = values[k].real();
    out.of_pair[static_cast<std::size_t>(2 * k + 1)] = values[k].imag();
  }
  out.from_s = data.time[first];
  out.to_s = data.time[end - 1];
  return out;
}

/// Stretches of as many electrical periods each.
std::vector<Stretch> stretches_of(const Basis &basis, const Observations &data,
                                  const ResidualColumns &rest, double periods) {
  std::vector<Stretch> out;
  double way = 0.0;
  std::size_t first = 0;
  for (std::size_t i = 1; i < data.size(); ++i) {
    way += basis.periods() * std::abs(data.alpha[i] - data.alpha[i - 1]) / kTwoPi;
    if (way < periods || i - first < criteria::kSamplesOfStretch)
      continue;
    out.push_back(stretch_of(basis, data, rest, first, i));
    first = i;
    way = 0.0;
  }
  return out;
}

/// Means of a number of the stretches before a place, and from it on.
template <class Number>
std::array<double, 2> means_at(const std::vector<Stretch> &of, std::size_t place,
                               const Number &number) {
  const auto mean = [&](std::size_t first, std::size_t end) {
    double sum = 0.0;
    for (std::size_t k = first; k < end; ++k)
      sum += number(of[k]);
    return sum / static_cast<double>(end - first);
  };
  return {mean(place - std::min(place, kBeside), place),
          mean(place, std::min(of.size(), place + kBeside))};
}

} // namespace

std::optional<std::vector<StepPlace>> find_steps(const Basis &basis, const Observations &data,
                                                 const ResidualColumns &rest,
                                                 double electrical_periods) {
  std::vector<Stretch> stretches =
      stretches_of(basis, data, rest, std::max(1.0, electrical_periods / criteria::kMostStretches));
  const std::size_t count = stretches.size();
  if (count < criteria::kFewestForSteps)
    return std::nullopt;
  std::vector<StepPlace> out;
  double fastest = 0.0;
  for (const Stretch &s : stretches)
    fastest = std::max(fastest, std::abs(s.speed));
  std::vector<std::size_t> places; // of the steps
  // What jumps with the speed is no step; it is taken out all the same, so that the places beside
  // it show what is theirs.
  for (std::size_t round = 0; round < 3 * criteria::kMostSteps; ++round) {
    std::size_t where = 0;
    double most = criteria::kJump;
    for (std::size_t m = 0; m < 2 * kPair; ++m) {
      const auto number = [m](const Stretch &s) { return s.of_pair[m]; };
      std::vector<double> jumps;
      for (std::size_t k = kLeastBeside; k + kLeastBeside <= count; ++k) {
        const auto [before, after] = means_at(stretches, k, number);
        jumps.push_back(after - before);
      }
      const double spread = robust_spread(jumps);
      for (std::size_t k = 0; k < jumps.size(); ++k)
        if (std::abs(jumps[k]) > most * spread) {
          most = std::abs(jumps[k]) / std::max(spread, 1e-300);
          where = k + kLeastBeside;
        }
    }
    if (where == 0 || out.size() == criteria::kMostSteps)
      return out;
    const StepPlace step{stretches[where - std::min(where, kBeside)].from_s,
                         stretches[std::min(count, where + kBeside) - 1].to_s};
    for (std::size_t m = 0; m < 2 * kPair; ++m) {
      const auto [before, after] =
          means_at(stretches, where, [m](const Stretch &s) { return s.of_pair[m]; });
      for (std::size_t k = where; k < count; ++k)
        stretches[k].of_pair[m] -= after - before;
    }
    // Beside a step that was found lies what the means left of it.
    const auto is_near = [&](std::size_t place) {
      return std::max(place, where) - std::min(place, where) < kBeside;
    };
    const auto [slower, faster] =
        means_at(stretches, where, [](const Stretch &s) { return s.speed; });
    if (std::abs(faster - slower) < criteria::kSameSpeed * fastest &&
        std::none_of(places.begin(), places.end(), is_near)) {
      out.push_back(step);
      places.push_back(where);
    }
  }
  return out;
}

double moment_of_step(const Basis &basis, const Observations &near, const ResidualColumns &rest) {
  constexpr std::size_t kEnds = 8; // of the samples, an eighth at either end tells its side
  // The sum that a place explains falls off evenly to both sides of the moment: a grid finds the
  // hill, and its top is looked for between the two places beside the best one.
  constexpr std::size_t kPlaces = 256;
  const std::size_t n = near.size(), stride = n / kPlaces + 1;
  PairFit all;
  std::vector<PairFit> before{all}; // of the samples before each place of the grid
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 0 && i % stride == 0)
      before.push_back(all);
    all.add(columns_of(basis, near, i), {rest.cos[i], rest.sin[i]});
  }
  std::size_t best = n / 2;
  double most = -1.0;
  const auto look_at = [&](const PairFit &left, std::size_t place) {
    if (place <= n / kEnds || place > n - n / kEnds + 1 || place >= n)
      return;
    if (const double explained = left.explained() + (all - left).explained(); explained > most) {
      most = explained;
      best = place;
    }
  };
  for (std::size_t k = 1; k < before.size(); ++k)
    look_at(before[k], k * stride);
  if (stride > 1) {
    const std::size_t nearest = best / stride, first = nearest > 0 ? nearest - 1 : 0;
    PairFit left = before[std::min(first, before.size() - 1)];
    for (std::size_t i = first * stride; i < std::min(n, (nearest + 1) * stride); ++i) {
      left.add(columns_of(basis, near, i), {rest.cos[i], rest.sin[i]});
      look_at(left, i + 1);
    }
  }
  return 0.5 * (near.time[best - 1] + near.time[best]);
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>

#include <boost/math/distributions/students_t.hpp>

#include "study/statistics.h"

namespace ada::study {

namespace {

constexpr double kEfficiency =
    0.37;                      ///< of the median absolute deviation under a normal distribution
constexpr double kOuter = 0.2; ///< part of a side whose course the tail continues

/// One side of the median: how far its numbers are, sorted.
struct Side {
  std::vector<double> reach;
  double scale = 0.0;             ///< robust standard deviation
  double begin = 0.0, mean = 0.0; ///< of the exponential tail
};

Side side_of(std::span<const double> x, double middle, double sign) {
  Side s;
  for (double v : x)
    if (sign * (v - middle) >= 0.0)
      s.reach.push_back(sign * (v - middle));
  std::sort(s.reach.begin(), s.reach.end());
  s.scale = 1.4826 * median(s.reach);
  const auto first = static_cast<std::size_t>((1.0 - kOuter) * static_cast<double>(s.reach.size()));
  if (first >= s.reach.size())
    return s;
  s.begin = s.reach[first];
  std::vector<double> beyond(s.reach.begin() + static_cast<std::ptrdiff_t>(first), s.reach.end());
  for (double &b : beyond)
    b -= s.begin;
  s.mean = median(beyond) / std::log(2.0); // of an exponential, by its median
  return s;
}

double tail_p(const Side &s, double reach) {
  if (!(s.mean > 0.0) || reach <= s.begin)
    return 1.0;
  return 2.0 * 0.5 * kOuter * std::exp(-(reach - s.begin) / s.mean);
}

/// How unlike the two sides are.
double lopsided(const std::vector<double> &x) {
  const double middle = median(x);
  const double low = side_of(x, middle, -1.0).scale, high = side_of(x, middle, 1.0).scale;
  return low > 0.0 && high > 0.0 ? std::abs(std::log(high / low)) : 1e9;
}

/// What chance makes of lopsided() for numbers of a normal distribution, whose sides are alike: the
/// standard error of a median absolute deviation is 1.17/sqrt(n) of it, and each side has half.
double lopsided_by_chance(std::size_t count) {
  return 2.0 * 1.17 / std::sqrt(static_cast<double>(count));
}
constexpr double kPlainlyLopsided = 3.0; ///< times as much is no chance

struct Scale {
  std::vector<double> x, std_error;
};

std::vector<Distance> distances_on(const Scale &scale) {
  const auto &[x, std_error] = scale;
  std::vector<Distance> out(x.size());
  const double typical_error = median(std_error); // a part of the spread already
  const double middle = median(x), whole = median_deviation(x);
  const Side low = side_of(x, middle, -1.0), high = side_of(x, middle, 1.0);
  const boost::math::students_t t(
      std::max(1.0, 0.5 * kEfficiency * static_cast<double>(x.size() - 1)));
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Side &s = x[i] < middle ? low : high;
    const double spread = std::max(s.scale, 0.5 * whole);
    if (!(spread > 0.0))
      continue;
    const double more2 = std::max(0.0, std_error[i] * std_error[i] - typical_error * typical_error);
    const double scale_here = std::hypot(spread, std::sqrt(more2));
    const double reach = std::abs(x[i] - middle) * spread / scale_here;
    out[i].z = (x[i] - middle) / scale_here;
    const double by_t = 2.0 * boost::math::cdf(boost::math::complement(t, std::abs(out[i].z)));
    out[i].p = std::max(by_t, tail_p(s, reach));
  }
  return out;
}

} // namespace

std::vector<Distance> distances(std::span<const double> values,
                                std::span<const double> std_errors) {
  if (values.size() < 10)
    return std::vector<Distance>(values.size());
  Scale as_is{{values.begin(), values.end()}, {std_errors.begin(), std_errors.end()}};
  as_is.std_error.resize(values.size(), 0.0);
  if (std::any_of(values.begin(), values.end(), [](double v) { return !(v > 0.0); }))
    return distances_on(as_is);
  Scale logs = as_is;
  for (std::size_t i = 0; i < values.size(); ++i) {
    logs.x[i] = std::log(values[i]);
    logs.std_error[i] /= values[i];
  }
  const double skew = lopsided(as_is.x), skew_of_logs = lopsided(logs.x);
  const double plain = kPlainlyLopsided * lopsided_by_chance(values.size());
  if (skew_of_logs > std::max(plain, skew))
    return distances_on(as_is);
  std::vector<Distance> out = distances_on(logs);
  if (skew > std::max(plain, skew_of_logs))
    return out;
  // Either scale may be theirs: a number is as far as it is on the one where it is nearer.
  const std::vector<Distance> other = distances_on(as_is);
  for (std::size_t i = 0; i < out.size(); ++i)
    if (other[i].p > out[i].p)
      out[i] = other[i];
  return out;
}

} // namespace ada::study

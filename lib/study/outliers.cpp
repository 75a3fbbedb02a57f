// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

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

// ---- few sensors: each against the others ----

constexpr std::size_t kMany = 60; ///< from here on each side has a course of its own
constexpr std::size_t kLeast = 5;
constexpr std::size_t kLeastForTail = 30; ///< six in the outer fifth of the others
constexpr double kMostOutliers = 0.2;     ///< share: more are a group

/// Those against whom a number is judged.
struct Others {
  double mean = 0.0, variance = 0.0;
  double weight = 0.0; ///< as many numbers, each known as well as most
  std::vector<std::size_t> which;
};

/// p by the exponential that continues the outer fifth of the others, both sides as one: they are
/// too few for a tail each.
double tail_of_others(const std::vector<double> &x, const std::vector<std::size_t> &others,
                      double value) {
  std::vector<double> of;
  for (const std::size_t k : others)
    of.push_back(x[k]);
  const double middle = median(of);
  for (double &v : of)
    v = std::abs(v - middle);
  std::sort(of.begin(), of.end());
  const auto first = static_cast<std::size_t>((1.0 - kOuter) * static_cast<double>(of.size()));
  const double begin = 0.5 * (of[first - 1] + of[first]);
  const auto beyond = static_cast<double>(of.size() - first);
  double mean = 0.0;
  for (std::size_t k = first; k < of.size(); ++k)
    mean += (of[k] - begin) / beyond;
  const double reach = std::abs(value - middle);
  return reach > begin && mean > 0.0
             ? beyond / static_cast<double>(of.size()) * std::exp(-(reach - begin) / mean)
             : 1.0;
}

/// Few numbers, and of each the variance that it is known worse by than most.
struct Few {
  const std::vector<double> &x;
  std::vector<double> worse2, weight;

  explicit Few(const Scale &scale) : x(scale.x) {
    const double typical = median(scale.std_error), spread = median_deviation(x);
    for (const double error : scale.std_error) {
      worse2.push_back(std::max(0.0, error * error - typical * typical));
      const double whole = spread * spread + worse2.back();
      weight.push_back(worse2.back() > 0.0 ? spread * spread / whole : 1.0);
    }
  }

  /// One that is hardly known says as little of the others' spread.
  Others others_of(std::size_t i, const std::vector<std::size_t> &kept) const {
    Others out;
    std::copy_if(kept.begin(), kept.end(), std::back_inserter(out.which),
                 [&](std::size_t k) { return k != i; });
    for (const std::size_t k : out.which) {
      out.weight += weight[k];
      out.mean += weight[k] * x[k];
    }
    out.mean /= out.weight;
    for (const std::size_t k : out.which)
      out.variance += weight[k] * (x[k] - out.mean) * (x[k] - out.mean);
    out.variance /= std::max(out.weight - 1.0, 0.5);
    return out;
  }

  /// z by the spread of the others and by what the number is known worse than they; p is Student's
  /// of one more number of their distribution.
  Distance distance(std::size_t i, const Others &others) const {
    if (!(others.variance > 0.0))
      return {};
    const double away = x[i] - others.mean;
    const double by_t =
        std::abs(away) / std::sqrt(others.variance * (1.0 + 1.0 / others.weight) + worse2[i]);
    const boost::math::students_t t(std::max(others.weight - 1.0, 0.5));
    return {away / std::sqrt(others.variance + worse2[i]),
            2.0 * boost::math::cdf(boost::math::complement(t, by_t))};
  }
};

/// The generalised extreme studentised deviate (Rosner 1983): the farthest is judged against all
/// others and taken away, then the next. Where one is far, so are those before it, unless they are
/// known too badly to be, so that two do not hide each other.
std::vector<Distance> distances_of_few(const Scale &scale) {
  const std::size_t count = scale.x.size();
  std::vector<Distance> out(count);
  std::vector<std::size_t> kept(count), taken;
  std::iota(kept.begin(), kept.end(), std::size_t{0});
  const Few few(scale);
  const auto judged = [&](std::size_t i, const Others &others) {
    Distance d = few.distance(i, others);
    if (count >= kLeastForTail)
      d.p = std::max(d.p, tail_of_others(scale.x, others.which, scale.x[i]));
    return d;
  };
  const auto most = std::max<std::size_t>(
      1, static_cast<std::size_t>(kMostOutliers * static_cast<double>(count)));
  while (taken.size() < most) {
    std::size_t farthest = kept.front();
    double p = 1.0;
    for (const std::size_t i : kept)
      if (const double here = few.distance(i, few.others_of(i, kept)).p; here < p) {
        p = here;
        farthest = i;
      }
    const Others others = few.others_of(farthest, kept);
    std::erase(kept, farthest);
    taken.push_back(farthest);
    const double p_here = judged(farthest, others).p;
    for (const std::size_t i : taken)
      if (const Distance d = judged(i, others); std::max(d.p, p_here) < out[i].p)
        out[i] = {d.z, std::max(d.p, p_here)};
  }
  return out;
}

} // namespace

std::vector<Distance> distances(std::span<const double> values, std::span<const double> std_errors,
                                bool amounts) {
  const bool few = values.size() < kMany;
  if (values.size() < kLeast)
    return std::vector<Distance>(values.size());
  const auto on = few ? distances_of_few : distances_on;
  Scale as_is{{values.begin(), values.end()}, {std_errors.begin(), std_errors.end()}};
  as_is.std_error.resize(values.size(), 0.0);
  // Few numbers that can be negative are all positive by chance.
  if ((few && !amounts) ||
      std::any_of(values.begin(), values.end(), [](double v) { return !(v > 0.0); }))
    return on(as_is);
  Scale logs = as_is;
  for (std::size_t i = 0; i < values.size(); ++i) {
    logs.x[i] = std::log(values[i]);
    logs.std_error[i] /= values[i];
  }
  const double skew = lopsided(as_is.x), skew_of_logs = lopsided(logs.x);
  const double plain = kPlainlyLopsided * lopsided_by_chance(values.size());
  if (skew_of_logs > std::max(plain, skew))
    return on(as_is);
  std::vector<Distance> out = on(logs);
  if (skew > std::max(plain, skew_of_logs))
    return out;
  // Either scale may be theirs: a number is as far as it is on the one where it is nearer.
  const std::vector<Distance> other = on(as_is);
  for (std::size_t i = 0; i < out.size(); ++i)
    if (other[i].p > out[i].p)
      out[i] = other[i];
  return out;
}

} // namespace ada::study

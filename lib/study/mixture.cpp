// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "study/statistics.h"

namespace ada::study {

namespace {

constexpr std::size_t kMostPopulations = 4, kLeastOfEach = 5, kLeastNumbers = 20;
constexpr std::size_t kEnough = 20000; ///< more numbers change nothing
constexpr double kLeastShare = 0.04;
constexpr double kApart = 2.5;     ///< Ashman's D; 2 is where two equal ones begin to show a valley
constexpr double kDecisive = 10.0; ///< of the criterion, "very strong" by Kass & Raftery (1995)

double log_normal_density(double x, double centre, double spread) {
  const double u = (x - centre) / spread;
  return -0.5 * u * u - std::log(spread) - 0.5 * std::log(2.0 * std::numbers::pi);
}

/// -2 log likelihood + parameters * log n.
double criterion(double log_likelihood, double parameters, std::size_t n) {
  return -2.0 * log_likelihood + parameters * std::log(static_cast<double>(n));
}

struct Moments {
  double mean = 0.0, spread = 0.0;
};

Moments moments(const std::vector<double> &x) {
  Moments m;
  for (double v : x)
    m.mean += v / static_cast<double>(x.size());
  for (double v : x)
    m.spread += (v - m.mean) * (v - m.mean) / static_cast<double>(x.size());
  m.spread = std::sqrt(m.spread);
  return m;
}

double normal_likelihood(const std::vector<double> &x) {
  const Moments m = moments(x);
  double sum = 0.0;
  for (double v : x)
    sum += log_normal_density(v, m.mean, m.spread);
  return sum;
}

/// Yeo and Johnson's transform of a standardised number, and the logarithm of its slope.
double yeo_johnson(double u, double power, double &log_slope) {
  const double side = u >= 0.0 ? power : 2.0 - power;
  const double reach = std::log1p(std::abs(u));
  log_slope += (side - 1.0) * reach;
  const double size = std::abs(side) < 1e-9 ? reach : std::expm1(side * reach) / side;
  return u >= 0.0 ? size : -size;
}

/// Best normal distribution of transformed numbers: a skewed population.
double skewed_criterion(const std::vector<double> &x) {
  const Moments m = moments(x);
  double best = -std::numeric_limits<double>::infinity();
  std::vector<double> u(x.size());
  for (double power = -4.0; power <= 6.0; power += 0.25) {
    double log_slope = -static_cast<double>(x.size()) * std::log(m.spread);
    for (std::size_t i = 0; i < x.size(); ++i)
      u[i] = yeo_johnson((x[i] - m.mean) / m.spread, power, log_slope);
    best = std::max(best, normal_likelihood(u) + log_slope);
  }
  return criterion(best, 3.0, x.size());
}

/// Log-normal about a bound below (or above, with the sign turned).
double bounded_criterion(const std::vector<double> &x, double sign) {
  std::vector<double> y;
  for (double v : x)
    y.push_back(sign * v);
  const double least = *std::min_element(y.begin(), y.end());
  const Moments m = moments(y);
  double best = -std::numeric_limits<double>::infinity();
  for (const double gap : {0.01, 0.03, 0.1, 0.3, 1.0, 3.0}) {
    std::vector<double> u;
    double log_slope = 0.0;
    for (double v : y) {
      u.push_back(std::log(v - least + gap * m.spread));
      log_slope -= u.back();
    }
    best = std::max(best, normal_likelihood(u) + log_slope);
  }
  return criterion(best, 3.0, x.size());
}

/// Student's t about the median, its scale by a fixed-point iteration.
double heavy_criterion(const std::vector<double> &x) {
  double best = -std::numeric_limits<double>::infinity();
  for (const double freedom : {1.5, 3.0, 6.0, 12.0}) {
    double centre = median(x), square = std::pow(std::max(median_deviation(x), 1e-300), 2);
    for (int round = 0; round < 60; ++round) {
      double sum = 0.0, weights = 0.0, mean = 0.0;
      for (double v : x) {
        const double w = (freedom + 1.0) / (freedom + (v - centre) * (v - centre) / square);
        weights += w;
        mean += w * v;
        sum += w * (v - centre) * (v - centre);
      }
      centre = mean / weights;
      square = std::max(sum / static_cast<double>(x.size()), 1e-300);
    }
    double l = static_cast<double>(x.size()) *
               (std::lgamma(0.5 * (freedom + 1.0)) - std::lgamma(0.5 * freedom) -
                0.5 * std::log(freedom * std::numbers::pi * square));
    for (double v : x)
      l -= 0.5 * (freedom + 1.0) * std::log1p((v - centre) * (v - centre) / (freedom * square));
    best = std::max(best, l);
  }
  return criterion(best, 3.0, x.size());
}

double flat_criterion(const std::vector<double> &sorted) {
  const auto n = static_cast<double>(sorted.size());
  return criterion(-n * std::log(sorted.back() - sorted.front()), 2.0, sorted.size());
}

struct Mixture {
  std::vector<Population> of;
  double log_likelihood = -std::numeric_limits<double>::infinity();
};

/// Expectation and maximisation from equal parts of the sorted numbers. No population becomes
/// narrower than a fiftieth of the whole, where the likelihood has no bound.
Mixture fit_mixture(const std::vector<double> &sorted, std::size_t parts) {
  const std::size_t n = sorted.size();
  const double floor = 0.02 * moments(sorted).spread;
  Mixture m;
  for (std::size_t k = 0; k < parts; ++k) {
    const std::vector<double> part(sorted.begin() + static_cast<std::ptrdiff_t>(k * n / parts),
                                   sorted.begin() +
                                       static_cast<std::ptrdiff_t>((k + 1) * n / parts));
    const Moments of = moments(part);
    m.of.push_back({of.mean, std::max(of.spread, floor), 1.0 / static_cast<double>(parts)});
  }
  std::vector<double> weight(parts);
  for (int round = 0; round < 300; ++round) {
    std::vector<double> sum(parts, 0.0), first(parts, 0.0), second(parts, 0.0);
    double likelihood = 0.0;
    for (double v : sorted) {
      double most = -std::numeric_limits<double>::infinity(), all = 0.0;
      for (std::size_t k = 0; k < parts; ++k) {
        weight[k] = std::log(m.of[k].share) + log_normal_density(v, m.of[k].centre, m.of[k].spread);
        most = std::max(most, weight[k]);
      }
      for (double &w : weight)
        all += w = std::exp(w - most);
      likelihood += most + std::log(all);
      for (std::size_t k = 0; k < parts; ++k) {
        const double w = weight[k] / all, d = v - sorted[n / 2];
        sum[k] += w;
        first[k] += w * d;
        second[k] += w * d * d;
      }
    }
    for (std::size_t k = 0; k < parts; ++k) {
      const double s = std::max(sum[k], 1e-9), mean = first[k] / s;
      m.of[k] = {sorted[n / 2] + mean,
                 std::max(floor, std::sqrt(std::max(0.0, second[k] / s - mean * mean))),
                 s / static_cast<double>(n)};
    }
    const bool settled = likelihood - m.log_likelihood < 1e-7 * std::abs(likelihood);
    m.log_likelihood = likelihood;
    if (settled)
      break;
  }
  std::sort(m.of.begin(), m.of.end(),
            [](const Population &a, const Population &b) { return a.centre < b.centre; });
  return m;
}

double density(double x, const std::vector<Population> &of) {
  double sum = 0.0;
  for (const Population &p : of)
    sum += p.share * std::exp(log_normal_density(x, p.centre, p.spread));
  return sum;
}

/// Neighbours far apart, enough numbers in each, and a valley between them.
bool stand_apart(const std::vector<Population> &of, std::size_t n) {
  for (std::size_t k = 0; k < of.size(); ++k) {
    if (of[k].share < kLeastShare ||
        of[k].share * static_cast<double>(n) < static_cast<double>(kLeastOfEach))
      return false;
    if (k == 0)
      continue;
    const Population &a = of[k - 1], &b = of[k];
    const double apart =
        std::numbers::sqrt2 * (b.centre - a.centre) / std::hypot(a.spread, b.spread);
    double valley = std::numeric_limits<double>::infinity();
    for (int i = 1; i < 40; ++i)
      valley = std::min(valley, density(a.centre + (b.centre - a.centre) * i / 40.0, of));
    if (apart < kApart || valley > 0.5 * std::min(density(a.centre, of), density(b.centre, of)))
      return false;
  }
  return true;
}

} // namespace

std::vector<Population> populations(std::span<const double> x) {
  std::vector<double> sorted;
  for (std::size_t i = 0; i < x.size(); i += x.size() / kEnough + 1)
    sorted.push_back(x[i]);
  std::sort(sorted.begin(), sorted.end());
  if (sorted.size() < kLeastNumbers || !(moments(sorted).spread > 0.0))
    return {};
  const Moments all = moments(sorted);
  const std::vector<Population> one = {{all.mean, all.spread, 1.0}};
  double single =
      std::min({criterion(normal_likelihood(sorted), 2.0, sorted.size()), skewed_criterion(sorted),
                heavy_criterion(sorted), flat_criterion(sorted), bounded_criterion(sorted, 1.0),
                bounded_criterion(sorted, -1.0)});
  std::vector<Population> best = one;
  double least = single - kDecisive;
  for (std::size_t parts = 2; parts <= kMostPopulations; ++parts) {
    const Mixture m = fit_mixture(sorted, parts);
    const double c =
        criterion(m.log_likelihood, 3.0 * static_cast<double>(parts) - 1.0, sorted.size());
    if (c < least && stand_apart(m.of, sorted.size())) {
      best = m.of;
      least = c - kDecisive;
    }
  }
  return best;
}

std::size_t population_of(double x, const std::vector<Population> &populations) {
  std::size_t best = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < populations.size(); ++k) {
    const Population &p = populations[k];
    const double l = std::log(p.share) + log_normal_density(x, p.centre, p.spread);
    if (l > most) {
      most = l;
      best = k;
    }
  }
  return best;
}

} // namespace ada::study

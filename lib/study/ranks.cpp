// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>

#include "study/statistics.h"

namespace ada::study {

namespace {

std::vector<std::size_t> order_of(std::span<const double> x) {
  std::vector<std::size_t> order(x.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&x](std::size_t a, std::size_t b) { return x[a] != x[b] ? x[a] < x[b] : a < b; });
  return order;
}

double chi_squared_p(double statistic, double freedom) {
  if (!(statistic > 0.0) || !(freedom > 0.0))
    return 1.0;
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(freedom), statistic));
}

} // namespace

double median(std::vector<double> x) {
  if (x.empty())
    return std::numeric_limits<double>::quiet_NaN();
  const std::size_t half = x.size() / 2;
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(half);
  std::nth_element(x.begin(), middle, x.end());
  return x.size() % 2 == 1 ? *middle : 0.5 * (*middle + *std::max_element(x.begin(), middle));
}

double median_deviation(std::span<const double> x) {
  std::vector<double> d(x.begin(), x.end());
  const double middle = median(d);
  for (double &v : d)
    v = std::abs(v - middle);
  return 1.4826 * median(std::move(d));
}

std::vector<double> ranks(std::span<const double> x) {
  const std::vector<std::size_t> order = order_of(x);
  std::vector<double> out(x.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last + 1 < order.size() && x[order[last + 1]] == x[order[first]])
      ++last;
    for (std::size_t k = first; k <= last; ++k)
      out[order[k]] = 1.0 + 0.5 * static_cast<double>(first + last);
    first = last + 1;
  }
  return out;
}

Significance spearman(std::span<const double> x, std::span<const double> y, std::size_t lost) {
  const std::vector<double> a = ranks(x), b = ranks(y);
  const auto n = static_cast<double>(x.size());
  const double middle = 0.5 * (n + 1.0), freedom = n - 2.0 - static_cast<double>(lost);
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - middle) * (b[i] - middle);
    aa += (a[i] - middle) * (a[i] - middle);
    bb += (b[i] - middle) * (b[i] - middle);
  }
  if (!(aa > 0.0) || !(bb > 0.0) || freedom < 1.0)
    return {};
  const double r = std::clamp(ab / std::sqrt(aa * bb), -1.0, 1.0);
  const double t = std::abs(r) * std::sqrt(freedom / std::max(1e-300, 1.0 - r * r));
  return {r, 2.0 * boost::math::cdf(boost::math::complement(boost::math::students_t(freedom), t))};
}

Significance kruskal_wallis(std::span<const double> x, std::span<const std::size_t> group,
                            std::size_t groups) {
  const std::vector<double> r = ranks(x);
  const auto n = static_cast<double>(x.size());
  std::vector<double> sum(groups, 0.0), count(groups, 0.0);
  double squares = 0.0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    sum[group[i]] += r[i];
    count[group[i]] += 1.0;
    squares += r[i] * r[i];
  }
  double between = 0.0, used = 0.0;
  for (std::size_t g = 0; g < groups; ++g)
    if (count[g] > 0.0) {
      const double d = sum[g] / count[g] - 0.5 * (n + 1.0);
      between += count[g] * d * d;
      used += 1.0;
    }
  // The variance of the ranks as they are holds the ties.
  const double variance = (squares - n * 0.25 * (n + 1.0) * (n + 1.0)) / (n - 1.0);
  if (!(variance > 0.0) || used < 2.0)
    return {};
  const double h = between / variance;
  return {h, chi_squared_p(h, used - 1.0)};
}

Significance contingency(const std::vector<std::vector<double>> &counts) {
  double all = 0.0, rows = 0.0;
  std::vector<double> columns;
  for (const auto &row : counts) {
    columns.resize(std::max(columns.size(), row.size()), 0.0);
    double sum = 0.0;
    for (std::size_t k = 0; k < row.size(); ++k) {
      columns[k] += row[k];
      sum += row[k];
    }
    all += sum;
    rows += sum > 0.0 ? 1.0 : 0.0;
  }
  const auto used = static_cast<double>(
      std::count_if(columns.begin(), columns.end(), [](double c) { return c > 0.0; }));
  double statistic = 0.0;
  for (const auto &row : counts) {
    const double sum = std::accumulate(row.begin(), row.end(), 0.0);
    for (std::size_t k = 0; k < row.size(); ++k) {
      const double expected = sum * columns[k] / all;
      if (expected > 0.0)
        statistic += (row[k] - expected) * (row[k] - expected) / expected;
    }
  }
  return {statistic, chi_squared_p(statistic, (rows - 1.0) * (used - 1.0))};
}

std::vector<double> benjamini_hochberg(std::span<const double> p) {
  const std::vector<std::size_t> order = order_of(p);
  const auto n = static_cast<double>(p.size());
  std::vector<double> out(p.size());
  double least = 1.0;
  for (std::size_t k = order.size(); k-- > 0;) {
    least = std::min(least, p[order[k]] * n / static_cast<double>(k + 1));
    out[order[k]] = least;
  }
  return out;
}

std::vector<double> holm(std::span<const double> p) {
  const std::vector<std::size_t> order = order_of(p);
  std::vector<double> out(p.size());
  double most = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    most = std::max(most, std::min(1.0, p[order[k]] * static_cast<double>(order.size() - k)));
    out[order[k]] = most;
  }
  return out;
}

} // namespace ada::study

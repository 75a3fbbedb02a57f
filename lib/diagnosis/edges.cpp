// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/edges.h"

#include <algorithm>
#include <cmath>

#include "base/robust.h"
#include "diagnosis/criteria.h"

namespace ada {

namespace {

/// Straight lines through a number of samples each, from running sums.
class Lines {
public:
  Lines(std::span<const double> x, std::size_t reach)
      : sum_(x.size() + 1), moment_(x.size() + 1), reach_(reach) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      sum_[i + 1] = sum_[i] + x[i];
      moment_[i + 1] = moment_[i] + static_cast<double>(i) * x[i];
    }
  }
  /// What the line behind a place is above the one before it, half a sample from both.
  double jump(std::size_t at) const { return end(at, -0.5) - end(at - reach_, 0.5); }

private:
  /// The line through the samples from `first` on, at this part of its length from its middle.
  double end(std::size_t first, double part) const {
    const double m = static_cast<double>(reach_);
    const double middle = static_cast<double>(first) + 0.5 * (m - 1.0);
    const double sum = sum_[first + reach_] - sum_[first];
    const double about = moment_[first + reach_] - moment_[first] - middle * sum;
    return sum / m + part * 12.0 * about / (m * m - 1.0);
  }

  std::vector<double> sum_, moment_;
  std::size_t reach_;
};

} // namespace

std::size_t reach_of_edges(std::size_t samples, double rounds, int periods_per_turn) {
  constexpr double kFewest = 8.0, kQuarters = 4.0;
  const double waves = rounds * (criteria::kNamedPeriods + 1) * periods_per_turn;
  return static_cast<std::size_t>(
      std::max(kFewest, static_cast<double>(samples) / std::max(1.0, kQuarters * waves)));
}

std::vector<Edge> find_edges(std::span<const double> first, std::span<const double> second,
                             std::span<const float> omega, std::size_t reach, std::size_t most) {
  const std::size_t n = first.size();
  std::vector<Edge> all, out;
  if (n < 4 * reach)
    return out;
  const Lines a(first, reach), b(second, reach);
  std::vector<double> sizes;
  const auto size = [](const Edge &e) { return std::hypot(e.first, e.second); };
  std::size_t turned = 0; // the last sample that turns in another sense than the one before
  for (std::size_t i = 1; i < std::min(2 * reach, n); ++i)
    if ((omega[i] < 0.0F) != (omega[i - 1] < 0.0F))
      turned = i;
  for (std::size_t k = reach; k + reach <= n; ++k) {
    const std::size_t last = k + reach - 1;
    if ((omega[last] < 0.0F) != (omega[last - 1] < 0.0F))
      turned = last;
    if (turned > k - reach)
      continue;
    all.push_back({k, a.jump(k), b.jump(k)});
    sizes.push_back(size(all.back()));
  }
  if (sizes.empty())
    return out;
  const double least = criteria::kJump * quantile(sizes, 0.5);
  std::stable_sort(all.begin(), all.end(),
                   [&](const Edge &x, const Edge &y) { return size(x) > size(y); });
  for (const Edge &edge : all) {
    if (out.size() == most || !(size(edge) > least))
      break;
    const auto beside = [&](const Edge &o) {
      return std::max(o.at, edge.at) - std::min(o.at, edge.at) < 2 * reach;
    };
    if (std::none_of(out.begin(), out.end(), beside))
      out.push_back(edge);
  }
  return out;
}

} // namespace ada

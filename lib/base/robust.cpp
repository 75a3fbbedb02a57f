// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/robust.h"

#include <algorithm>
#include <iterator>

namespace ada {

Reach bulk(std::span<const double> x) {
  std::vector<double> v;
  v.reserve(x.size());
  std::copy_if(x.begin(), x.end(), std::back_inserter(v),
               [](double e) { return std::isfinite(e); });
  if (v.empty())
    return {};
  constexpr std::size_t kShare = 100, kFewest = 3;
  const std::size_t cut = std::min(std::max(v.size() / kShare, kFewest), (v.size() - 1) / 2);
  const auto at = [&v](std::size_t k) {
    const auto place = v.begin() + static_cast<std::ptrdiff_t>(k);
    std::nth_element(v.begin(), place, v.end());
    return *place;
  };
  const double low = at(cut);
  return {low, at(v.size() - 1 - cut)};
}

Reach fence(std::span<const double> x) {
  const Reach middle = bulk(x);
  return {middle.low - middle.width(), middle.high + middle.width()};
}

namespace {

/// Difference of a value from the median of seven about it.
double off_median(std::span<const double> x, std::size_t i) {
  constexpr std::size_t kReach = 3;
  double window[2 * kReach + 1];
  std::size_t m = 0;
  for (std::size_t k = i > kReach ? i - kReach : 0; k < std::min(x.size(), i + kReach + 1); ++k)
    if (!std::isnan(x[k]))
      window[m++] = x[k];
  std::nth_element(window, window + m / 2, window + m);
  return m > 0 ? x[i] - window[m / 2] : 0.0;
}

} // namespace

std::vector<double> off_medians(std::span<const double> x) {
  std::vector<double> off(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    off[i] = off_median(x, i);
  return off;
}

double standing_out_limit(std::span<const double> x, double threshold, double floor) {
  return threshold * std::max({robust_spread(off_medians(x)), floor, 1e-9});
}

std::vector<std::size_t> beyond_median(std::span<const double> x, double limit) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < x.size(); ++i) {
    // Where a value lies beyond the median, so it does beyond half of its neighbours: one of any
    // three is as far from it.
    if (i >= 3 && i + 3 < x.size() && std::abs(x[i - 1] - x[i]) <= limit &&
        std::abs(x[i + 1] - x[i]) <= limit && std::abs(x[i + 2] - x[i]) <= limit)
      continue;
    if (std::abs(off_median(x, i)) > limit)
      places.push_back(i);
  }
  return places;
}

std::vector<std::size_t> standing_out(std::span<const double> x, double threshold, double floor) {
  constexpr std::size_t kFewest = 20;
  if (x.size() < kFewest)
    return {};
  std::vector<std::size_t> places = beyond_median(x, standing_out_limit(x, threshold, floor));
  if (places.size() > x.size() / kRareSample)
    places.clear();
  return places;
}

double converter_step(const std::vector<double> &values) {
  constexpr std::size_t kLookedAt = 20000;
  constexpr double kNone = 1e-8; ///< V, rounding of the record
  std::vector<double> sorted(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                                  values.size(), kLookedAt)));
  std::erase_if(sorted, [](double v) { return !std::isfinite(v); });
  std::sort(sorted.begin(), sorted.end());
  double step = 0.0;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    const double gap = sorted[i] - sorted[i - 1];
    if (gap > kNone && (step == 0.0 || gap < step))
      step = gap;
  }
  return step;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/robust.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

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

constexpr std::size_t kReach = 3, kWindow = 2 * kReach + 1;

/// Median of up to seven values from a place on; not a number where there are none.
double median_from(std::span<const double> x, std::size_t first) {
  double window[kWindow];
  std::size_t m = 0;
  for (std::size_t k = first; k < std::min(x.size(), first + kWindow); ++k)
    if (!std::isnan(x[k]))
      window[m++] = x[k];
  std::nth_element(window, window + m / 2, window + m);
  return m > 0 ? window[m / 2] : std::nan("");
}

/// Where the seven begin that a value is judged by.
std::size_t window_of(std::span<const double> x, std::size_t i) {
  const std::size_t last = x.size() > kWindow ? x.size() - kWindow : 0;
  return std::min(i > kReach ? i - kReach : 0, last);
}

/// What the neighbours of a value differ by among themselves: the range of those four of the six
/// that lie closest together, so that two more of a row of three wild values do not count.
double range_of_neighbours(std::span<const double> x, std::size_t i) {
  std::vector<double> others;
  for (std::size_t k = window_of(x, i); k < std::min(x.size(), window_of(x, i) + kWindow); ++k)
    if (k != i && !std::isnan(x[k]))
      others.push_back(x[k]);
  std::sort(others.begin(), others.end());
  constexpr std::size_t kNearest = 4;
  if (others.size() <= kNearest)
    return others.empty() ? 0.0 : others.back() - others.front();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + kNearest <= others.size(); ++k)
    least = std::min(least, others[k + kNearest - 1] - others[k]);
  return least;
}

/// Difference of a value from the median of seven about it. At an end it is that of the first or
/// the last seven, whose middle is up to three steps away: twice what the column moves there by
/// itself, from that median to the two next inward, is none of the value's own.
double off_median(std::span<const double> x, std::size_t i) {
  const std::size_t last = x.size() > kWindow ? x.size() - kWindow : 0;
  const std::size_t first = window_of(x, i);
  const double middle = median_from(x, first), off = x[i] - middle;
  if (i >= kReach && i + kReach < x.size())
    return off;
  double low = middle, high = middle;
  for (std::size_t step = kReach + 1; step + kWindow <= kJudgedBy + 1; step += kReach + 1) {
    const double next =
        median_from(x, i < kReach ? std::min(step, last) : last - std::min(step, last));
    low = std::min(low, next);
    high = std::max(high, next);
  }
  return std::copysign(std::max(std::abs(off) - 2 * (high - low), 0.0), off);
}

} // namespace

std::vector<double> off_medians(std::span<const double> x) {
  std::vector<double> off(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    off[i] = off_median(x, i);
  return off;
}

double gap_beyond_bulk(std::vector<double> differences) {
  constexpr double kGap = 2, kBulk = 1 - 1.0 / kRareSample;
  for (double &d : differences)
    d = std::abs(d);
  return kGap * quantile(std::move(differences), kBulk);
}

namespace {

/// Differences from the medians about them, of a long column in stretches all over it: a spread and
/// the largest of sixty are told by a hundred thousand.
std::vector<double> some_off_medians(std::span<const double> x) {
  constexpr std::size_t kEnough = 131072, kStretch = 2048;
  if (x.size() <= kEnough)
    return off_medians(x);
  constexpr std::size_t kStretches = kEnough / kStretch;
  std::vector<double> off;
  off.reserve(kEnough);
  for (std::size_t k = 0; k < kStretches; ++k) {
    const std::size_t first = k * (x.size() - kStretch) / (kStretches - 1);
    for (std::size_t i = first; i < first + kStretch; ++i)
      off.push_back(off_median(x, i));
  }
  return off;
}

} // namespace

double standing_out_limit(std::span<const double> x, double threshold, double floor) {
  const std::vector<double> off = some_off_medians(x);
  return std::max(threshold * std::max({robust_spread(off), floor, 1e-9}), gap_beyond_bulk(off));
}

std::vector<std::size_t> beyond_median(std::span<const double> x, double limit) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < x.size(); ++i) {
    // Where a value lies beyond the median, so it does beyond half of its neighbours: one of any
    // three is as far from it.
    if (i >= 3 && i + 3 < x.size() && std::abs(x[i - 1] - x[i]) <= limit &&
        std::abs(x[i + 1] - x[i]) <= limit && std::abs(x[i + 2] - x[i]) <= limit)
      continue;
    // The crest of what turns fast lies as far from the median as its neighbours do from each
    // other.
    constexpr double kOverNeighbours = 2;
    if (const double off = std::abs(off_median(x, i));
        off > limit && off > kOverNeighbours * range_of_neighbours(x, i))
      places.push_back(i);
  }
  return places;
}

double spread_but_for_rare(std::span<const double> x) {
  if (x.empty())
    return 0.0;
  std::vector<double> off(x.begin(), x.end());
  const double middle = quantile(off, 0.5);
  for (double &v : off)
    v = std::abs(v - middle);
  const std::size_t kept = x.size() - x.size() / kRareSample;
  const auto end = off.begin() + static_cast<std::ptrdiff_t>(kept);
  if (end != off.end())
    std::nth_element(off.begin(), end, off.end());
  double sum = 0.0;
  for (auto v = off.begin(); v != end; ++v)
    sum += *v * *v;
  return std::sqrt(sum / static_cast<double>(kept));
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

namespace {

template <class T> double step_of(std::span<const T> values) {
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

} // namespace

Range range_of(std::span<const double> v, std::span<const char> usable) {
  std::vector<double> good;
  for (std::size_t i = 0; i < v.size(); ++i)
    if (usable[i])
      good.push_back(v[i]);
  if (good.empty())
    return {0.0, 1.0};
  const double low = quantile(good, 0.005), high = quantile(good, 0.995);
  return {0.5 * (low + high), std::max(0.5 * (high - low), 1e-9)};
}

double converter_step(std::span<const double> values) {
  return step_of(values);
}
double converter_step(std::span<const float> values) {
  return step_of(values);
}

} // namespace ada

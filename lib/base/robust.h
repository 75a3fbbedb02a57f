// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Statistics that a few wild values do not move.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace ada {

/// Quantile q in [0, 1]; takes its own copy. 0 for an empty vector; what is no number does not
/// count.
template <class T> double quantile(std::vector<T> v, double q) {
  std::erase_if(v, [](T x) { return std::isnan(x); });
  if (v.empty())
    return 0.0;
  const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(v.size() - 1));
  std::nth_element(v.begin(), v.begin() + k, v.end());
  return v[static_cast<std::size_t>(k)];
}

/// Standard deviation of a normal distribution over the median of its absolute deviations.
inline constexpr double kSigmasOfMedian = 1.4826;

/// Standard deviation of a normal distribution with the same median absolute deviation. Of a long
/// column only every so many values: that is exact to a fraction of a percent.
inline double robust_spread(std::span<const double> x) {
  constexpr std::size_t kEnough = 200000;
  std::vector<double> v;
  const std::size_t stride = x.size() / kEnough + 1;
  v.reserve(x.size() / stride + 1);
  for (std::size_t i = 0; i < x.size(); i += stride)
    v.push_back(x[i]);
  const double middle = quantile(v, 0.5);
  for (double &e : v)
    e = std::abs(e - middle);
  return kSigmasOfMedian * quantile(std::move(v), 0.5);
}

/// Low and high end of a column.
struct Reach {
  double low = 0, high = 0;
  double width() const { return high - low; }
  bool holds(double x) const { return x >= low && x <= high; } ///< false for what is no number
};

/// Where the bulk of a column lies: the finite values without the lowest and the highest 1 %, but
/// without three of each at least, so that neither one in a hundred wild values nor three in a
/// short column decide where it ends. Of fewer than seven values the median. Zero width for none.
Reach bulk(std::span<const double> x);

/// What a value may be and still belong to the column: its bulk and as much again to either side.
/// The bulk of a channel on a circle that was covered evenly is 0.9995 of it, and half of it where
/// the magnet stood for 98 % of the time at a peak: three bulks hold the whole circle in both
/// cases.
Reach fence(std::span<const double> x);

/// White noise of a column from its third differences, in which all that is slow vanishes. `usable`
/// (empty: all) says which values count.
inline double noise_between(std::span<const double> x, std::span<const char> usable = {}) {
  std::vector<double> d;
  const auto good = [&](std::size_t i) { return usable.empty() || usable[i] != 0; };
  for (std::size_t i = 3; i < x.size(); ++i)
    if (good(i) && good(i - 1) && good(i - 2) && good(i - 3))
      d.push_back(x[i] - 3.0 * x[i - 1] + 3.0 * x[i - 2] - x[i - 3]);
  return robust_spread(d) / std::sqrt(20.0);
}

/// One in so many samples that stand out is still rare.
inline constexpr std::size_t kRareSample = 60;

/// Rms about the median of all but the farthest: of those one in kRareSample may be spikes, and
/// what happens now and then for a while is still in it.
double spread_but_for_rare(std::span<const double> x);

/// What stands out of differences leaves a gap below itself: twice what one in kRareSample of them
/// exceeds. Of normal noise that is 4.8 sigmas, below any limit that noise sets; of structure, or
/// of noise with heavy tails, the few that are largest are no more than the end of many.
double gap_beyond_bulk(std::vector<double> differences);

/// Places of single values that differ from the median of seven about them by more than `threshold`
/// times the spread of that difference, or times `floor` where that is larger, and by
/// gap_beyond_bulk. None where more than one in sixty does: what is not rare is structure.
std::vector<std::size_t> standing_out(std::span<const double> x, double threshold, double floor);

/// Difference of each value from the median of the seven about it; within three of an end from that
/// of the seven there, so that up to three in a row are seen at an end as well.
std::vector<double> off_medians(std::span<const double> x);

/// The two halves of that, for a column that is measured in one place and searched in others: the
/// limit of the difference, and the places beyond it, however many. A value is judged by this many
/// on either side, at an end by as many on the one side.
inline constexpr std::size_t kJudgedBy = 14;
double standing_out_limit(std::span<const double> x, double threshold, double floor);
std::vector<std::size_t> beyond_median(std::span<const double> x, double limit);

/// Median of the positive steps of an ascending column.
inline double median_step(std::span<const double> time) {
  std::vector<double> dt;
  for (std::size_t i = 1; i < time.size(); ++i)
    if (time[i] > time[i - 1])
      dt.push_back(time[i] - time[i - 1]);
  return quantile(std::move(dt), 0.5);
}

/// Middle and half range of a channel, by quantiles so that spikes do not count. `usable` says
/// which values count; of none it is 0 and 1.
struct Range {
  double middle, half;
};
Range range_of(std::span<const double> v, std::span<const char> usable);

/// The step of the converter as its values show it, in their unit; 0 when they show none.
double converter_step(std::span<const double> values);
double converter_step(std::span<const float> values);

} // namespace ada

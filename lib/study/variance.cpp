// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <map>

#include "study/statistics.h"

namespace ada::study {

namespace {

constexpr double kDrawnIn = 6.0; ///< robust standard deviations

/// Values beyond the fence come to it; a spread of zero fences nothing in.
void draw_in(std::vector<double> &x, double middle, double spread) {
  if (spread > 0.0)
    for (double &v : x)
      v = std::clamp(v, middle - kDrawnIn * spread, middle + kDrawnIn * spread);
}

/// Median of each sensor, and what is left of each value.
struct Split {
  std::vector<double> centre, rest;
  std::vector<std::size_t> place, count; ///< of each value its centre; of each centre its values
};

Split split(std::span<const double> x, std::span<const std::size_t> sensor) {
  std::map<std::size_t, std::vector<double>> of;
  for (std::size_t i = 0; i < x.size(); ++i)
    of[sensor[i]].push_back(x[i]);
  Split out;
  std::map<std::size_t, std::size_t> place;
  for (const auto &[s, values] : of) {
    place[s] = out.centre.size();
    out.count.push_back(values.size());
    out.centre.push_back(median(values));
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    out.place.push_back(place[sensor[i]]);
    out.rest.push_back(x[i] - out.centre[out.place.back()]);
  }
  return out;
}

} // namespace

std::optional<Components> variance_components(std::span<const double> x,
                                              std::span<const std::size_t> sensor) {
  Split s = split(x, sensor);
  const auto a = static_cast<double>(s.centre.size()), n = static_cast<double>(x.size());
  if (s.centre.size() < 2 || s.centre.size() == x.size())
    return std::nullopt;
  draw_in(s.centre, median(s.centre), median_deviation(s.centre));
  std::vector<double> of_repeated;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (s.count[s.place[i]] > 1)
      of_repeated.push_back(s.rest[i]);
  draw_in(s.rest, 0.0, median_deviation(of_repeated));
  std::vector<double> mean(s.centre.size(), 0.0);
  double all = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double v = s.centre[s.place[i]] + s.rest[i];
    mean[s.place[i]] += v / static_cast<double>(s.count[s.place[i]]);
    all += v / n;
  }
  double within = 0.0, between = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double d = s.centre[s.place[i]] + s.rest[i] - mean[s.place[i]];
    within += d * d / (n - a);
  }
  for (std::size_t k = 0; k < mean.size(); ++k) {
    const auto c = static_cast<double>(s.count[k]);
    between += c * (mean[k] - all) * (mean[k] - all) / (a - 1.0);
    squares += c * c;
  }
  const double each = (n - squares / n) / (a - 1.0); // n0 of Searle, Casella & McCulloch
  Components out{std::sqrt(std::max(0.0, (between - within) / each)), std::sqrt(within), 0};
  out.repeated = static_cast<std::size_t>(
      std::count_if(s.count.begin(), s.count.end(), [](std::size_t c) { return c > 1; }));
  return out;
}

} // namespace ada::study

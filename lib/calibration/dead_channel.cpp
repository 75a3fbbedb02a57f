// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/dead_channel.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace ada {

namespace {

constexpr double kStuckAcross = 0.7;        ///< of its travel that the other channel crosses
constexpr std::size_t kMinStuckSamples = 5; ///< fewer may be a coarse sampling

struct Range {
  double low = INFINITY, high = -INFINITY;
  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  double width() const { return high - low; }
};

} // namespace

double travel(const std::vector<double> &v) {
  std::vector<double> finite;
  finite.reserve(v.size());
  std::copy_if(v.begin(), v.end(), std::back_inserter(finite),
               [](double x) { return std::isfinite(x); });
  if (finite.empty())
    return 0;
  const auto point = [&](double fraction) {
    const auto at = finite.begin() +
                    static_cast<std::ptrdiff_t>(fraction * static_cast<double>(finite.size() - 1));
    std::nth_element(finite.begin(), at, finite.end());
    return *at;
  };
  const double low = point(0.01);
  return point(0.99) - low;
}

std::optional<std::size_t> stuck_from(const std::vector<double> &v, double own_travel,
                                      const std::vector<double> &other, double other_travel) {
  std::size_t first = 0;
  Range own, across;
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (!std::isfinite(v[i]) || !std::isfinite(other[i]))
      continue;
    Range grown = own;
    grown.add(v[i]);
    if (grown.width() > kStuckRatio * own_travel) {
      first = i;
      grown = across = Range();
      grown.add(v[i]);
    }
    own = grown;
    across.add(other[i]);
    if (i - first >= kMinStuckSamples && across.width() > kStuckAcross * other_travel)
      return first;
  }
  return std::nullopt;
}

} // namespace ada

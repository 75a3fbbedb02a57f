// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/dead_channel.h"

#include <algorithm>
#include <cmath>

#include "base/robust.h"

namespace ada {

namespace {

constexpr double kStuckAcross = 0.5;         ///< of its travel that the other channel crosses
constexpr double kWildShare = 1.0 / 6;       ///< of a stretch that may be wild on either side
constexpr std::size_t kMinStuckSamples = 20; ///< three of them are less than kWildShare

/// Collects one stretch of `v` after the other.
class Stretches {
public:
  Stretches(double own_travel, double other_travel)
      : most_own_(kStuckRatio * own_travel), least_other_(kStuckAcross * other_travel) {}

  void add(std::size_t i, double own, double other) {
    const double low = std::min(low_, own), high = std::max(high_, own);
    if (!other_.empty() && high - low > most_own_) {
      close();
      low_ = high_ = own;
    } else {
      low_ = low;
      high_ = high;
    }
    if (other_.empty())
      first_ = i;
    other_.push_back(other);
  }

  std::optional<Stuck> result() {
    close();
    return found_;
  }

private:
  void close() {
    if (other_.size() >= kMinStuckSamples &&
        quantile(other_, 1 - kWildShare) - quantile(other_, kWildShare) > least_other_) {
      if (!found_)
        found_ = Stuck{first_, 0};
      found_->samples += other_.size();
    }
    other_.clear();
    low_ = INFINITY;
    high_ = -INFINITY;
  }

  double most_own_, least_other_;
  std::vector<double> other_; ///< of the present stretch
  double low_ = INFINITY, high_ = -INFINITY;
  std::size_t first_ = 0;
  std::optional<Stuck> found_;
};

} // namespace

double travel(const std::vector<double> &v) {
  return bulk(v).width();
}

std::optional<Stuck> stuck_stretches(const std::vector<double> &v, double own_travel,
                                     const std::vector<double> &other, double other_travel) {
  if (!(other_travel > 0))
    return std::nullopt;
  Stretches stretches(own_travel, other_travel);
  for (std::size_t i = 0; i < v.size(); ++i)
    if (std::isfinite(v[i]) && std::isfinite(other[i]))
      stretches.add(i, v[i], other[i]);
  return stretches.result();
}

} // namespace ada

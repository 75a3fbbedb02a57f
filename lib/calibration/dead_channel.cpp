// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/dead_channel.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/robust.h"

namespace ada {

namespace {

constexpr double kStuckAcross = 0.5; ///< of its travel that the other channel crosses
/// Of its travel that most of a stretch may move by, beside noise. A sound channel moves about its
/// peak by 0.013 of it there, whatever the other one does.
constexpr double kMostMoved = 0.005, kNoiseWidth = 3;
constexpr double kWildShare = 1.0 / 6;       ///< of a stretch that may be wild on either side
constexpr std::size_t kMinStuckSamples = 20; ///< three of them are less than kWildShare

/// Collects one stretch of `v` after the other.
class Stretches {
public:
  Stretches(double own_travel, double own_noise, double other_travel)
      : most_own_(kStuckRatio * own_travel),
        most_moved_(std::max(kMostMoved * own_travel, kNoiseWidth * own_noise)),
        least_other_(kStuckAcross * other_travel) {}

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
    end_ = i + 1;
    own_.push_back(own);
    other_.push_back(other);
  }

  std::vector<StuckStretch> result() {
    close();
    return std::move(found_);
  }

private:
  void close() {
    if (other_.size() >= kMinStuckSamples && width(other_) > least_other_ &&
        width(own_) <= most_moved_)
      found_.push_back({first_, end_, other_.size()});
    own_.clear();
    other_.clear();
    low_ = INFINITY;
    high_ = -INFINITY;
  }

  static double width(const std::vector<double> &v) {
    return quantile(v, 1 - kWildShare) - quantile(v, kWildShare);
  }

  double most_own_, most_moved_, least_other_;
  std::vector<double> own_, other_; ///< of the present stretch
  double low_ = INFINITY, high_ = -INFINITY;
  std::size_t first_ = 0, end_ = 0;
  std::vector<StuckStretch> found_;
};

} // namespace

double travel(const std::vector<double> &v) {
  return bulk(v).width();
}

std::vector<StuckStretch> each_stuck_stretch(std::span<const double> v, double own_travel,
                                             std::span<const double> other, double other_travel) {
  if (!(other_travel > 0))
    return {};
  Stretches stretches(own_travel, noise_between(v), other_travel);
  for (std::size_t i = 0; i < v.size(); ++i)
    if (std::isfinite(v[i]) && std::isfinite(other[i]))
      stretches.add(i, v[i], other[i]);
  return stretches.result();
}

std::optional<Stuck> stuck_stretches(const std::vector<double> &v, double own_travel,
                                     const std::vector<double> &other, double other_travel) {
  std::optional<Stuck> out;
  for (const StuckStretch &one : each_stuck_stretch(v, own_travel, other, other_travel)) {
    if (!out)
      out = Stuck{one.first, 0};
    out->samples += one.samples;
  }
  return out;
}

} // namespace ada

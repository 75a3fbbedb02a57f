// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Steps of time against the sample rate that a recording states.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace ada {

/// A step of time longer than this many sample periods is a gap.
inline constexpr double kLongestStep = 1.5;

class RateSteps {
public:
  RateSteps() = default;
  explicit RateSteps(std::optional<double> rate_hz)
      : longest_s_(rate_hz ? kLongestStep / *rate_hz : 0.0),
        shortest_s_(rate_hz ? 1 / (kLongestStep * *rate_hz) : 0.0) {}

  /// The step of time to a sample; samples in ascending order.
  void add(std::size_t sample, double step_s) {
    if (!(step_s > 0) || longest_s_ == 0)
      return;
    ++steps_;
    if (step_s > longest_s_)
      late_.push_back(sample);
    else if (step_s < shortest_s_)
      ++short_;
  }
  /// The steps of samples further on.
  void append(const RateSteps &next) {
    steps_ += next.steps_;
    short_ += next.short_;
    late_.insert(late_.end(), next.late_.begin(), next.late_.end());
  }

  /// Whether the median step is about one period; not where no rate is stated.
  bool follow_rate() const {
    const std::size_t middle = (steps_ - 1) / 2;
    return steps_ > 0 && steps_ - late_.size() > middle && short_ <= middle;
  }
  /// First sample after each gap; none where the times do not follow the rate.
  std::vector<std::size_t> gaps() const {
    return follow_rate() ? late_ : std::vector<std::size_t>();
  }

private:
  double longest_s_ = 0, shortest_s_ = 0;
  std::size_t steps_ = 0, short_ = 0; ///< that go on; of them, too short ones
  std::vector<std::size_t> late_;
};

} // namespace ada

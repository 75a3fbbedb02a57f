// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/sample_clock.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace ada {

namespace {

/// Gains of the loop, damping 0.7: settles in about thirty frames, and a jitter of sigma moves the
/// period by less than sigma/100.
constexpr double kPhaseGain = 0.1;
constexpr double kPeriodGain = 0.005;

/// A loss may be taken back by the next few frames only.
constexpr unsigned kTakeBackFrames = 32;

/// Median interval of the given timestamps, or their mean where most are equal (a driver that
/// stamps a whole hardware FIFO at once).
double typical_interval(std::span<const std::int64_t> stamps) {
  std::array<std::int64_t, SampleClock::kLearn> intervals{};
  const std::size_t n = stamps.size() - 1;
  for (std::size_t i = 0; i < n; ++i)
    intervals[i] = stamps[i + 1] - stamps[i];
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(n / 2);
  std::nth_element(intervals.begin(), middle, intervals.begin() + static_cast<std::ptrdiff_t>(n));
  if (*middle > 0)
    return static_cast<double>(*middle);
  return std::max(0.0, static_cast<double>(stamps[n] - stamps[0]) / static_cast<double>(n));
}

/// When at least half of the frames are missing the typical interval is a multiple of the period;
/// the nominal rate tells which. A rate that fits no multiple is not believed.
double choose_period(double interval, double nominal) {
  if (nominal <= 0.0 || interval <= 0.0)
    return interval > 0.0 ? interval : nominal;
  const double ratio = interval / nominal, multiple = std::round(ratio);
  if (multiple >= 2.0 && std::abs(ratio / multiple - 1.0) < 0.1)
    return interval / multiple;
  return interval;
}

} // namespace

SampleClock::SampleClock(double nominal_rate_hz)
    : nominal_period_ns_(nominal_rate_hz > 0.0 ? 1e9 / nominal_rate_hz : 0.0) {}

void SampleClock::reset() {
  const double nominal = nominal_period_ns_;
  *this = SampleClock();
  nominal_period_ns_ = nominal;
}

double SampleClock::accept_untimed() {
  return static_cast<double>(frames_++) * nominal_period_ns_ * 1e-9;
}

double SampleClock::accept(std::int64_t timestamp_ns) {
  // Unsigned, because a broken device may send anything: a difference that does not fit is negative.
  auto step = static_cast<std::int64_t>(static_cast<std::uint64_t>(timestamp_ns) -
                                        static_cast<std::uint64_t>(last_ns_));
  last_ns_ = timestamp_ns;
  const std::int64_t previous = elapsed_ns_;
  const std::int64_t room = std::numeric_limits<std::int64_t>::max() - elapsed_ns_;
  if (frames_ == 0) {
    first_ns_ = timestamp_ns;
    step = 0;
  } else if (step < 0 || step > room) {
    // Set back: go on one period after the frame before.
    const double period = period_ns_ > 0.0 ? period_ns_ : nominal_period_ns_;
    step = period < static_cast<double>(room) ? std::llround(period) : 0;
    ++gaps_;
  }
  elapsed_ns_ += step;

  if (frames_ < kLearn) {
    early_[frames_] = elapsed_ns_;
    if (++frames_ == kLearn)
      learn();
  } else {
    ++frames_;
    track(elapsed_ns_, previous);
  }
  return static_cast<double>(elapsed_ns_) * 1e-9;
}

void SampleClock::learn() {
  const std::size_t n = std::min<std::size_t>(frames_, kLearn);
  if (n < 2)
    return;
  period_ns_ = choose_period(typical_interval(std::span(early_).first(n)), nominal_period_ns_);
  if (period_ns_ > 0.0)
    period_ns_ = std::max(period_ns_, 1.0); // the resolution of the timestamps
  expected_ns_ = period_ns_;
  for (std::size_t i = 1; i < n; ++i)
    track(early_[i], early_[i - 1]);
}

void SampleClock::track(std::int64_t elapsed, std::int64_t previous) {
  if (period_ns_ <= 0.0)
    return;
  if (elapsed == previous) { // one stamp for several frames: only the first of them tells the phase
    expected_ns_ += period_ns_;
    return;
  }
  double error = (static_cast<double>(elapsed) - expected_ns_) / period_ns_;
  ++since_loss_;
  if (error > 0.5) {
    const double missing = std::round(error);
    count_loss(static_cast<std::int64_t>(missing));
    error -= missing;
    expected_ns_ += missing * period_ns_;
  } else if (error < -0.5 && recent_lost_ > 0 && since_loss_ <= kTakeBackFrames) {
    const double early = std::min(std::round(-error), static_cast<double>(recent_lost_));
    take_back(static_cast<std::int64_t>(early));
    error += early;
    expected_ns_ -= early * period_ns_;
  }
  error = std::clamp(error, -0.5, 0.5);
  expected_ns_ += period_ns_ * (1.0 + kPhaseGain * error);
  period_ns_ *= 1.0 + kPeriodGain * error;
}

void SampleClock::count_loss(std::int64_t missing) {
  lost_ += static_cast<std::uint64_t>(missing);
  recent_lost_ = static_cast<std::uint64_t>(missing);
  since_loss_ = 0;
  ++gaps_;
}

void SampleClock::take_back(std::int64_t early) {
  lost_ -= static_cast<std::uint64_t>(early);
  recent_lost_ -= static_cast<std::uint64_t>(early);
  if (recent_lost_ == 0)
    --gaps_;
}

SourceStatistics SampleClock::statistics() const {
  if (frames_ >= kLearn || frames_ < 2)
    return SourceStatistics{frames_, lost_, gaps_, first_ns_};
  // A short capture: evaluate what is there, without ending the learning.
  SampleClock copy = *this;
  copy.learn();
  return SourceStatistics{frames_, copy.lost_, copy.gaps_, first_ns_};
}

} // namespace ada

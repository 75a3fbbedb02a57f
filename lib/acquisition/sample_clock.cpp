// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/sample_clock.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
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

/// Steps of even timestamps differ from the period by so much of it at most. The loop, which takes
/// back a tenth of its error a frame, is then never a third of a period off: it would count no
/// loss.
constexpr double kEven = 0.03;
constexpr double kEvenAtFirst = 0.15;
constexpr double kLongestEven_ns = 1e9;
/// The frames come from another processor's cache; its own prefetching ends with each page.
constexpr std::size_t kAhead = 256; // frames

/// How far a leap of the timestamps may go beyond this machine's clock. Buffers and slow lines
/// deliver late, and then much at once, but by no more than the first frame was late.
constexpr std::int64_t kMostAhead_ns = 2'000'000'000;
constexpr double kSomeTime_ns = 1e8; ///< beyond what one block is late by
/// No hardware FIFO holds frames for as long.
constexpr double kLongestStill_ns = 1e9;

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

SampleClock::SampleClock(double nominal_rate_hz, std::optional<std::int64_t> started_ns)
    : nominal_period_ns_(nominal_rate_hz > 0.0 ? 1e9 / nominal_rate_hz : 0.0),
      started_ns_(started_ns) {}

void SampleClock::reset() {
  const double nominal = nominal_period_ns_;
  *this = SampleClock();
  nominal_period_ns_ = nominal;
}

/// A recording may be played many times as fast as it was made, and a device's clock be off: its
/// gaps are as much shorter by our own. The first frames, which came at once, tell nothing of that.
void SampleClock::look_at_own_clock(std::int64_t own_ns) {
  if (frames_ == 0) {
    own_start_ns_ = own_ns;
  } else if (own_ns != own_ns_) {
    const auto passed = static_cast<double>(own_ns_ - own_start_ns_);
    if (passed == 0)
      came_at_once_ns_ = elapsed_ns_;
    else if (passed > kSomeTime_ns)
      pace_ = std::max(1.0, static_cast<double>(elapsed_ns_ - came_at_once_ns_) / passed);
  }
  own_ns_ = own_ns;
}

/// Whether so much cannot have passed by our own clock.
bool SampleClock::is_leap(std::int64_t step) const {
  const std::int64_t late = started_ns_ ? own_start_ns_ - *started_ns_ : 0;
  return step > kMostAhead_ns &&
         static_cast<double>(elapsed_ns_ + step) >
             static_cast<double>(std::max(late, came_at_once_ns_) + kMostAhead_ns) +
                 pace_ * static_cast<double>(own_ns_ - own_start_ns_);
}

double SampleClock::accept_untimed() {
  return static_cast<double>(frames_++) * nominal_period_ns_ * 1e-9;
}

double SampleClock::accept(std::int64_t timestamp_ns, std::optional<std::int64_t> own_ns) {
  // Unsigned, because a broken device may send anything: a difference that does not fit is
  // negative.
  const auto step = static_cast<std::int64_t>(static_cast<std::uint64_t>(timestamp_ns) -
                                              static_cast<std::uint64_t>(last_ns_));
  last_ns_ = timestamp_ns;
  const std::int64_t previous = elapsed_ns_;
  if (own_ns)
    look_at_own_clock(*own_ns);
  if (frames_ == 0)
    first_ns_ = timestamp_ns;
  else
    elapsed_ns_ += believed_step(step, own_ns);

  if (frames_ < kLearn) {
    early_[static_cast<std::size_t>(frames_)] = elapsed_ns_;
    if (++frames_ == kLearn)
      learn();
  } else {
    ++frames_;
    track(elapsed_ns_, previous);
  }
  repeats_ = frames_ > 1 && elapsed_ns_ == previous ? repeats_ + 1 : 0;
  latest_ns_ = std::max(latest_ns_, static_cast<double>(elapsed_ns_) + repeated_ns());
  return latest_ns_ * 1e-9;
}

/// The even steps are a power of two of numbers, so that one look at the upper bits of all together
/// tells whether each was among them, in fewer instructions than a comparison for each.
SampleClock::EvenSteps SampleClock::even_steps() const {
  const auto number = std::bit_floor(static_cast<std::uint64_t>(2.0 * kEven * period_ns_) + 1);
  return {static_cast<std::uint64_t>(std::llround(period_ns_)) - number / 2, number};
}

std::int64_t SampleClock::longest_even_step_ns() const {
  const EvenSteps even = even_steps();
  return static_cast<std::int64_t>(even.shortest + even.number - 1);
}

std::optional<std::int64_t> SampleClock::accept_even(const std::byte *first, std::size_t stride,
                                                     std::size_t count,
                                                     std::optional<std::int64_t> own_ns) {
  if (count < kLearn || frames_ < kLearn || since_loss_ <= kTakeBackFrames ||
      !(period_ns_ > 0.0 && period_ns_ < kLongestEven_ns) ||
      latest_ns_ > static_cast<double>(elapsed_ns_) ||
      elapsed_ns_ > std::numeric_limits<std::int64_t>::max() / 2)
    return std::nullopt;
  const EvenSteps even = even_steps();
  std::uint64_t last = static_cast<std::uint64_t>(last_ns_), beyond = 0;
  for (std::size_t i = 0; i < count; ++i, first += stride) {
    if (i + kAhead < count)
      __builtin_prefetch(first + kAhead * stride);
    std::uint64_t stamp; // unsigned, as a broken device may send anything
    std::memcpy(&stamp, first, sizeof stamp);
    beyond |= stamp - last - even.shortest;
    last = stamp;
  }
  const bool uneven = beyond >= even.number;
  if (!uneven && own_ns)
    look_at_own_clock(*own_ns);
  const std::int64_t origin = static_cast<std::int64_t>(static_cast<std::uint64_t>(last_ns_) -
                                                        static_cast<std::uint64_t>(elapsed_ns_));
  const double mean =
      static_cast<double>(last - static_cast<std::uint64_t>(last_ns_)) / static_cast<double>(count);
  // Where the loop expected them the first one is near.
  const double error = (static_cast<double>(elapsed_ns_) + mean - expected_ns_) / period_ns_;
  if (uneven || std::abs(error) > kEvenAtFirst)
    return std::nullopt;
  elapsed_ns_ += static_cast<std::int64_t>(last - static_cast<std::uint64_t>(last_ns_));
  last_ns_ = static_cast<std::int64_t>(last);
  latest_ns_ = static_cast<double>(elapsed_ns_);
  frames_ += count;
  repeats_ = 0;
  period_ns_ = mean;
  expected_ns_ = latest_ns_ + mean;
  return origin;
}

/// The step of the timestamps, or a period in its place.
std::int64_t SampleClock::believed_step(std::int64_t step, std::optional<std::int64_t> own_ns) {
  const std::int64_t room = std::numeric_limits<std::int64_t>::max() - elapsed_ns_;
  const bool back = step < 0 || step > room;
  const bool ahead = own_ns && !back && is_leap(step);
  if (!back && !ahead)
    return step;
  ++gaps_;
  ++bad_;
  const double period = typical_period_ns();
  return period < static_cast<double>(room) ? std::llround(period) : 0;
}

/// How long after its timestamp a frame is that shares it with frames before: a driver may stamp a
/// whole hardware FIFO at once.
double SampleClock::repeated_ns() {
  const double after = static_cast<double>(repeats_) * typical_period_ns();
  if (after > kLongestStill_ns && repeats_ > kLearn)
    ++bad_;
  return after;
}

void SampleClock::learn() {
  const std::size_t n = static_cast<std::size_t>(std::min<std::uint64_t>(frames_, kLearn));
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
  since_loss_ = std::min(since_loss_ + 1, kTakeBackFrames + 1);
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
  SourceStatistics out{frames_, lost_, gaps_, first_ns_, bad_};
  if (frames_ >= 2 && frames_ < kLearn) {
    // A short capture: evaluate what is there, without ending the learning.
    SampleClock copy = *this;
    copy.learn();
    out.lost = copy.lost_;
    out.gaps = copy.gaps_;
  }
  if (out.bad_times * 100 > out.frames) // nobody can tell then
    out.lost = out.gaps = 0;
  return out;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Time and loss from timestamps. A full kernel buffer drops new frames without a word to user
// space; only a jump of the timestamps tells.
//
// The sample period is the median interval of the first kLearn frames (robust against losses and
// jitter), made consistent with the nominal rate when half of the frames or more are missing, and
// then followed by a second-order phase-locked loop. A frame is counted as missing when the phase
// has moved on by more than half a period; a late timestamp, whose successors are on time again,
// is taken back. So jitter below half a period costs nothing, and the count is exact.
//
// A timestamp that makes no sense is not believed: one that goes back, one that leaps two seconds
// beyond what can have passed by this machine's own clock, one that stands still for a second. Time
// then goes on by the period.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "acquisition/source.h"

namespace ada {

class SampleClock {
public:
  static constexpr std::size_t kLearn = 33; ///< timestamps from which the period is learned

  /// nominal_rate_hz 0: unknown. With neither timestamps nor a rate there is no time base.
  /// `started_ns` is when the device began to sample, by the clock of accept()'s `own_ns`: so late
  /// its first frame may be.
  explicit SampleClock(double nominal_rate_hz = 0.0,
                       std::optional<std::int64_t> started_ns = std::nullopt);

  /// Forgets everything but the nominal rate.
  void reset();

  /// Takes the next timestamp (ns). Returns seconds since the first frame. A clock that was set
  /// back is bridged by one period and counted as a gap of unknown size. `own_ns` is when the frame
  /// came, by a clock of this machine that counts sleep and is never set.
  double accept(std::int64_t timestamp_ns, std::optional<std::int64_t> own_ns = std::nullopt);

  /// The same for many frames at once, whose timestamps (words of this machine, `stride` bytes
  /// apart) go on so evenly that none is missing between them and none is doubtful: each is by as
  /// much after the first frame as its timestamp is after the result. Where they do not, or too
  /// little is known yet, nothing is taken.
  std::optional<std::int64_t> accept_even(const std::byte *first, std::size_t stride,
                                          std::size_t count,
                                          std::optional<std::int64_t> own_ns = std::nullopt);
  /// What accept_even() takes no step of timestamps beyond.
  std::int64_t longest_even_step_ns() const;

  /// For a device without timestamps: seconds by the nominal rate.
  double accept_untimed();

  /// Frames counted by accept(), and what is missing between them.
  SourceStatistics statistics() const;

  /// Period in seconds, 0 while unknown.
  double period_s() const { return period_ns_ * 1e-9; }

private:
  struct EvenSteps {
    std::uint64_t shortest, number; ///< ns; and of how many numbers from there on, a power of two
  };
  EvenSteps even_steps() const;
  void look_at_own_clock(std::int64_t own_ns);
  bool is_leap(std::int64_t step) const;
  std::int64_t believed_step(std::int64_t step, std::optional<std::int64_t> own_ns);
  double repeated_ns();
  double typical_period_ns() const { return period_ns_ > 0.0 ? period_ns_ : nominal_period_ns_; }
  void learn();
  void track(std::int64_t elapsed, std::int64_t previous);
  void count_loss(std::int64_t missing);
  void take_back(std::int64_t early);

  double nominal_period_ns_ = 0.0;
  double period_ns_ = 0.0;
  double expected_ns_ = 0.0;    ///< phase of the loop
  std::int64_t first_ns_ = 0;   ///< the first timestamp
  std::int64_t last_ns_ = 0;    ///< timestamp as it came
  std::int64_t elapsed_ns_ = 0; ///< since the first frame, without the steps of the clock
  std::optional<std::int64_t> started_ns_;     ///< this machine's clock at the start
  std::int64_t own_start_ns_ = 0, own_ns_ = 0; ///< at the first frame, and when frames came last
  std::int64_t came_at_once_ns_ = 0;           ///< of the device's time, with the first frame
  double pace_ = 1.0; ///< of the device's time by our own, until then; 1 for one that is slower
  std::uint64_t repeats_ = 0; ///< of the last timestamp
  double latest_ns_ = 0.0;    ///< time that was given out last
  std::uint64_t frames_ = 0, lost_ = 0, gaps_ = 0, bad_ = 0;
  std::uint64_t recent_lost_ = 0; ///< of the last loss, may still be taken back
  unsigned since_loss_ = 0;
  std::array<std::int64_t, kLearn> early_{}; ///< times until the period is known
};

} // namespace ada

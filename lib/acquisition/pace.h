// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// When the frames of a source that has them all at hand are due: by the clock, or at once.
#pragma once

#include <chrono>
#include <optional>

#include "acquisition/readiness.h"
#include "acquisition/wake_up.h"

namespace ada {

class Pace {
public:
  enum class Wake { due, timeout, cancelled };

  /// `speed` times as fast as the frames' own times; 0: no frame is waited for.
  explicit Pace(double speed) : speed_(speed) {}

  void start();
  /// Nothing is due before the next start.
  void stop() noexcept;
  bool cancelled() const noexcept { return cancellation_.raised(); }
  void cancel() noexcept { cancellation_.raise(); }

  /// Seconds of the frames' own times since start; without end where nothing is waited for.
  double elapsed_s() const;
  /// Waits until a frame of that time after the first is due, the end of the time-out (negative:
  /// none), or a cancel.
  Wake wait(double time_s, std::chrono::milliseconds timeout) const;

  /// Readable from when a frame of the time that announce() named last is due, and when cancelled.
  int fd();
  void announce(double time_s);

private:
  using Clock = std::chrono::steady_clock;

  Clock::time_point due(double time_s) const;
  void set_timer(Clock::time_point when);

  double speed_;
  Clock::time_point started_{};
  Cancellation cancellation_;
  std::optional<Readiness> readiness_; ///< once somebody asked for it
  Descriptor timer_;
  std::optional<Clock::time_point> announced_; ///< nullopt: not started
};

} // namespace ada

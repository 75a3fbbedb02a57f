// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/pace.h"

#include <algorithm>
#include <limits>

#include <sys/timerfd.h>

#include "base/timespec.h"

namespace ada {

namespace {

/// A due time that is further away is as good as never.
constexpr double kFarthest_s = 1e9;

} // namespace

void Pace::start() {
  started_ = Clock::now();
  announced_ = started_;
  cancellation_.lower();
  if (readiness_)
    set_timer(started_);
}

void Pace::stop() noexcept {
  announced_.reset();
  const itimerspec off{};
  if (readiness_)
    timerfd_settime(timer_.get(), 0, &off, nullptr);
}

double Pace::elapsed_s() const {
  if (speed_ == 0.0)
    return std::numeric_limits<double>::infinity();
  return speed_ * std::chrono::duration<double>(Clock::now() - started_).count();
}

Pace::Clock::time_point Pace::due(double time_s) const {
  if (speed_ == 0.0)
    return started_;
  const std::chrono::duration<double> after(std::clamp(time_s / speed_, 0.0, kFarthest_s));
  return started_ + std::chrono::ceil<Clock::duration>(after);
}

Pace::Wake Pace::wait(double time_s, std::chrono::milliseconds timeout) const {
  const Clock::time_point begun = Clock::now(), when = due(time_s);
  const bool bounded = timeout.count() >= 0 && when - begun > timeout;
  const Clock::time_point limit = bounded ? begun + timeout : when;
  for (;;) {
    if (cancelled())
      return Wake::cancelled;
    const auto left = limit - Clock::now();
    if (left <= left.zero())
      return bounded ? Wake::timeout : Wake::due;
    const timespec wait = timespec_of(std::chrono::duration_cast<std::chrono::nanoseconds>(left));
    pollfd fd = {cancellation_.fd(), POLLIN, 0};
    ppoll(&fd, 1, &wait, nullptr);
  }
}

int Pace::fd() {
  if (!readiness_) {
    timer_ = Descriptor(timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK));
    if (timer_.get() < 0)
      throw Error(ADA4571_ERROR_IO, "cannot make a timer: " + errno_text(errno));
    Readiness fresh;
    fresh.watch(timer_.get());
    fresh.watch(cancellation_.fd());
    readiness_ = std::move(fresh);
    if (announced_)
      set_timer(*announced_);
  }
  return readiness_->fd();
}

void Pace::announce(double time_s) {
  const Clock::time_point when = due(time_s);
  if (announced_ == when)
    return;
  announced_ = when;
  if (readiness_)
    set_timer(when);
}

/// An expired timer stays readable until it is set anew, since nobody reads it. steady_clock is
/// CLOCK_MONOTONIC; a time of 0 would switch the timer off.
void Pace::set_timer(Clock::time_point when) {
  using std::chrono::nanoseconds;
  itimerspec at{};
  at.it_value = timespec_of(
      std::max(nanoseconds(1), std::chrono::duration_cast<nanoseconds>(when.time_since_epoch())));
  if (timerfd_settime(timer_.get(), TFD_TIMER_ABSTIME, &at, nullptr) != 0)
    throw Error(ADA4571_ERROR_IO, "cannot set a timer: " + errno_text(errno));
}

} // namespace ada

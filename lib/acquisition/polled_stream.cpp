// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cerrno>

#include <poll.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "acquisition/capture_stream.h"
#include "base/error.h"

namespace ada {

namespace {

using std::chrono::milliseconds;

/// The kernel wakes a poll only when a whole buffer is there, and not at all when the device is
/// removed; looking this often bounds both delays and costs nothing beside a capture.
constexpr milliseconds kSlice{50};
/// The same for an event loop, which it wakes for nothing each time.
constexpr milliseconds kTick{200};

class PolledStream final : public CaptureStream {
public:
  PolledStream(const Cancellation &cancellation, std::unique_ptr<IioBuffer> buffer,
               std::string presence_path, std::string name)
      : cancellation_(cancellation), buffer_(std::move(buffer)),
        presence_path_(std::move(presence_path)), name_(std::move(name)) {}

  Event next(CaptureBlock &block, Clock::time_point deadline) override {
    for (;;) {
      if (cancellation_.raised())
        return Event::cancelled;
      const std::ptrdiff_t n = buffer_->refill();
      if (n > 0) {
        block = {{buffer_->data(), static_cast<std::size_t>(n)}, &buffer_->layout()};
        return Event::data;
      }
      if (n < 0 && n != -EAGAIN && n != -EINTR)
        fail(static_cast<int>(-n));
      if (access(presence_path_.c_str(), F_OK) != 0)
        fail(ENODEV);
      const auto left = std::chrono::ceil<milliseconds>(deadline - Clock::now());
      if (left <= milliseconds(0)) {
        quieten();
        return Event::timeout;
      }
      wait(std::min(left, kSlice));
    }
  }

  void announce_to(Readiness &readiness) override {
    tick_ = Descriptor(timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK));
    const long ns = std::chrono::nanoseconds(kTick).count();
    const itimerspec every{{0, ns}, {0, ns}};
    if (tick_.get() < 0 || timerfd_settime(tick_.get(), 0, &every, nullptr) != 0)
      throw Error(ADA4571_ERROR_IO, "cannot make a timer: " + errno_text(errno));
    readiness.watch(tick_.get());
    readiness.watch(buffer_->poll_fd());
  }

private:
  void quieten() {
    std::uint64_t ticks = 0;
    if (tick_.get() >= 0)
      (void)!read(tick_.get(), &ticks, sizeof ticks);
  }

  void wait(milliseconds slice) {
    pollfd fds[2] = {{cancellation_.fd(), POLLIN, 0}, {buffer_->poll_fd(), POLLIN, 0}};
    const int timeout = static_cast<int>(slice.count());
    const int ready = poll(fds, 2, timeout);
    // A node in an error state is ready at once for ever: wait on the wake-up alone.
    if (ready > 0 && !(fds[1].revents & POLLIN) && fds[1].revents != 0)
      (void)!poll(fds, 1, timeout);
  }

  [[noreturn]] void fail(int error) {
    if (error == ENODEV || error == ENXIO || access(presence_path_.c_str(), F_OK) != 0)
      throw Error(ADA4571_ERROR_DISCONNECTED,
                  name_ + " was removed during the capture; start again when it is back");
    throw Error(status_of_errno(error), "reading from " + name_ + " failed: " + errno_text(error));
  }

  const Cancellation &cancellation_;
  std::unique_ptr<IioBuffer> buffer_;
  std::string presence_path_, name_;
  Descriptor tick_; ///< of an event loop's; none before somebody asked
};

} // namespace

std::unique_ptr<CaptureStream> make_polled_stream(const Cancellation &cancellation,
                                                  std::unique_ptr<IioBuffer> buffer,
                                                  std::string presence_path, std::string name) {
  return std::make_unique<PolledStream>(cancellation, std::move(buffer), std::move(presence_path),
                                        std::move(name));
}

} // namespace ada

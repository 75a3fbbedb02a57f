// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/stop.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <utility>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "common/handles.h"

namespace cli {

namespace {

// The handler may only touch what is lock-free; it wakes the thread that does the rest.
std::atomic<int> signals{0};
std::atomic<int> wake_fd{-1};
std::atomic<const Farewell *> last_words{nullptr};
static_assert(std::atomic<int>::is_always_lock_free);
static_assert(std::atomic<const Farewell *>::is_always_lock_free);

/// A terminal that takes nothing for so long does not hold the end up.
constexpr int kFarewellMs = 500;

void write_event(std::uint64_t value) noexcept {
  // Nothing can be done about a failed write here, and an eventfd refuses none of ours.
  [[maybe_unused]] const auto written = write(wake_fd.load(), &value, sizeof value);
}

/// All of these may be called by a signal handler.
void say_farewell() noexcept {
  const Farewell *farewell = last_words.load();
  if (!farewell)
    return;
  tcsetattr(farewell->keys, TCSANOW, &farewell->modes);
  tcflow(farewell->screen, TCOON); // after a Ctrl-S
  pollfd screen{farewell->screen, POLLOUT, 0};
  if (poll(&screen, 1, kFarewellMs) == 1)
    [[maybe_unused]] const auto written =
        write(farewell->screen, farewell->bytes.data(), farewell->bytes.size());
}

extern "C" void on_signal(int signal) {
  const int saved = errno;
  if (signals.fetch_add(1) > 0 && signal == SIGINT) {
    say_farewell();
    _exit(130);
  }
  write_event(1);
  errno = saved;
}

void handle(void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction hangup = {};
  sigaction(SIGHUP, nullptr, &hangup);
  if (hangup.sa_handler != SIG_IGN)
    sigaction(SIGHUP, &action, nullptr);
}

} // namespace

void set_farewell(const Farewell *farewell) noexcept {
  last_words = farewell;
}

StopSignal::StopSignal(std::function<void()> on_stop) : on_stop_(std::move(on_stop)) {
  const int fd = eventfd(0, EFD_CLOEXEC);
  if (fd < 0)
    throw Failure(kUnusable, std::string("cannot wait for Ctrl-C: ") + std::strerror(errno));
  signals = 0;
  wake_fd = fd;
  waiter_ = std::thread([this] {
    std::uint64_t woken = 0;
    while (read(wake_fd.load(), &woken, sizeof woken) < 0 && errno == EINTR) {
    }
    if (requested())
      on_stop_();
  });
  handle(on_signal);
}

StopSignal::~StopSignal() {
  handle(SIG_DFL);
  write_event(1);
  waiter_.join();
  close(wake_fd.exchange(-1));
}

bool StopSignal::requested() noexcept {
  return signals.load() > 0;
}

} // namespace cli

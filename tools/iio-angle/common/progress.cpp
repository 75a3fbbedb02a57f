// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/progress.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "common/print.h"

namespace cli {

namespace {

using namespace std::chrono_literals;
constexpr std::chrono::milliseconds kSilence = 1s, kInterval = 100ms;

} // namespace

Progress::Progress()
    : terminal_(isatty(STDERR_FILENO) != 0), next_(std::chrono::steady_clock::now() + kSilence) {}

Progress::~Progress() {
  clear();
}

bool Progress::due() const {
  return terminal_ && std::chrono::steady_clock::now() >= next_;
}

void Progress::show(double fraction, const std::string &what) {
  if (due())
    show(fmt::format("{:3.0f} %  {}", 100.0 * std::clamp(fraction, 0.0, 1.0), what));
}

void Progress::show(const std::string &what) {
  if (!due())
    return;
  next_ = std::chrono::steady_clock::now() + kInterval;
  note("\r\033[K{}", what);
  shown_ = true;
}

void Progress::clear() {
  if (shown_)
    note("\r\033[K");
  shown_ = false;
}

Busy::Busy(std::string what) : what_(std::move(what)), ticker_([this] { tick(); }) {}

Busy::~Busy() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  ended_.notify_one();
  ticker_.join();
}

void Busy::now(std::string what) {
  const std::lock_guard lock(mutex_);
  what_ = std::move(what);
}

void Busy::tick() {
  std::unique_lock lock(mutex_);
  while (!ended_.wait_for(lock, kInterval, [this] { return over_; })) {
    const std::chrono::duration<double> since = std::chrono::steady_clock::now() - began_;
    progress_.show(fmt::format("{}, {:.0f} s", what_, since.count()));
  }
}

} // namespace cli

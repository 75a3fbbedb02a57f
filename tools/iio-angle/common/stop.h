// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Ctrl-C, SIGTERM and SIGHUP (a terminal that went away) end live work cleanly: what was captured
// so far is kept.
#pragma once

#include <functional>
#include <thread>

namespace cli {

/// While it lives, the first of these signals runs `on_stop` in a thread of its own and sets
/// requested(); a second SIGINT ends the program at once. SIGHUP comes twice of itself, from the
/// shell and from the terminal; under nohup it stays ignored. One at a time.
class StopSignal {
public:
  explicit StopSignal(std::function<void()> on_stop);
  ~StopSignal();
  StopSignal(const StopSignal &) = delete;
  StopSignal &operator=(const StopSignal &) = delete;

  static bool requested() noexcept;

private:
  std::function<void()> on_stop_;
  std::thread waiter_;
};

} // namespace cli

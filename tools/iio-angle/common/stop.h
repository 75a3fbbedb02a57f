// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Ctrl-C and SIGTERM end live work cleanly: what was captured so far is kept.
#pragma once

#include <functional>
#include <thread>

namespace cli {

/// While it lives, the first SIGINT or SIGTERM runs `on_stop` in a thread of its own and sets
/// requested(); a second one ends the program at once. One at a time.
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

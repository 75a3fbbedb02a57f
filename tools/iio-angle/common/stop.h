// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Ctrl-C, SIGTERM and SIGHUP (a terminal that went away) end live work cleanly: what was captured
// so far is kept.
#pragma once

#include <functional>
#include <string>
#include <thread>

#include <termios.h>

namespace cli {

/// How a terminal that was taken over is given back by a program that ends where it stands.
struct Farewell {
  int screen = -1, keys = -1; ///< descriptors
  termios modes{};            ///< of the keys, as they were
  std::string bytes;          ///< for the screen
};

/// From now on the second Ctrl-C does that; null: nothing. It outlives the next call.
void set_farewell(const Farewell *farewell) noexcept;

/// While it lives, the first of these signals runs `on_stop` in a thread of its own and sets
/// requested(); a second SIGINT ends the program at once, with the farewell. SIGHUP comes twice of itself, from the
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

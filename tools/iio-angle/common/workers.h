// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Pieces of work in processes of their own: one that crashes or hangs costs itself alone.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace cli {

struct Work {
  std::size_t jobs = 1; ///< processes at once
  double limit_s = 0.0; ///< longest time of one piece; 0: none
  std::size_t pieces = 0;
  std::function<std::string(std::size_t)> run; ///< in a process of its own; its text comes back
  /// In this process, as pieces end, in any order. `why_not` is empty where there is a text.
  std::function<void(std::size_t, const std::string &text, const std::string &why_not)> ended;
};

/// False where SIGINT, SIGTERM or SIGHUP ended it before all was done; what runs then is killed.
/// No other thread may be running.
bool work_through(const Work &work);

} // namespace cli

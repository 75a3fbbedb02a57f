// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Progress of long work: a line on standard error when that is a terminal, nothing otherwise.
#pragma once

#include <chrono>
#include <string>

namespace cli {

class Progress {
public:
  Progress();
  ~Progress();
  Progress(const Progress &) = delete;
  Progress &operator=(const Progress &) = delete;

  /// `fraction` in [0, 1].
  void show(double fraction, const std::string &what);
  void show(const std::string &what);
  /// Removes the line, so that what follows begins at its start.
  void clear();

private:
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point next_{};
};

} // namespace cli

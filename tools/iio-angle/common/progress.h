// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Progress of work that takes longer than a second: a line on standard error when that is a
// terminal, nothing otherwise.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace cli {

class Progress {
public:
  Progress();
  ~Progress();
  Progress(const Progress &) = delete;
  Progress &operator=(const Progress &) = delete;

  /// Whether it is time to show something; what is not shown need not be put into words.
  bool due() const;
  /// `fraction` in [0, 1].
  void show(double fraction, const std::string &what);
  void show(const std::string &what);
  /// Removes the line, so that what follows begins at its start.
  void clear();

private:
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point next_;
};

/// Bytes a sample as a converter of 16 bits gives them, for what says which channels there are.
template <class Info> double converter_bytes(const Info &info) {
  return 2.0 * (2 + info.has_vtemp + info.has_vdd + info.has_reference);
}

/// For work that does not say how far it is: shows what goes on and for how long, by a thread of
/// its own.
class Busy {
public:
  explicit Busy(std::string what);
  ~Busy();
  Busy(const Busy &) = delete;
  Busy &operator=(const Busy &) = delete;

  /// From here on something else goes on.
  void now(std::string what);

private:
  void tick();

  Progress progress_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  std::mutex mutex_;
  std::condition_variable ended_;
  std::string what_;
  bool over_ = false;
  std::thread ticker_; ///< last: it begins when the rest is there
};

} // namespace cli

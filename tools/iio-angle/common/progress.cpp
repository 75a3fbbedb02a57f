// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/progress.h"

#include <algorithm>

#include <fmt/format.h>
#include <unistd.h>

#include "common/print.h"

namespace cli {

Progress::Progress() : terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  clear();
}

void Progress::show(double fraction, const std::string &what) {
  if (terminal_)
    show(fmt::format("{:3.0f} %  {}", 100.0 * std::clamp(fraction, 0.0, 1.0), what));
}

void Progress::show(const std::string &what) {
  using namespace std::chrono_literals;
  const auto now = std::chrono::steady_clock::now();
  if (!terminal_ || now < next_)
    return;
  next_ = now + 100ms;
  note("\r\033[K{}", what);
  shown_ = true;
}

void Progress::clear() {
  if (shown_)
    note("\r\033[K");
  shown_ = false;
}

} // namespace cli

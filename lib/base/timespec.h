// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Durations as system calls take them.
#pragma once

#include <chrono>
#include <ctime>

namespace ada {

/// Of a duration that is not negative. The nanoseconds within a second fit into a long of 32 bits.
inline timespec timespec_of(std::chrono::nanoseconds duration) {
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(duration);
  return {static_cast<time_t>(whole.count()), static_cast<long>((duration - whole).count())};
}

} // namespace ada

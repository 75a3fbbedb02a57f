// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/fixed_point.h"

#include <charconv>
#include <cstring>

namespace ada {

char *print_steps(char *out, std::int64_t steps, int decimals) {
  if (steps < 0)
    *out++ = '-';
  const auto magnitude = steps < 0 ? std::uint64_t{0} - static_cast<std::uint64_t>(steps)
                                   : static_cast<std::uint64_t>(steps);
  char *end = std::to_chars(out, out + kStepsBytes - 1, magnitude).ptr;
  // At least one digit stands before the point.
  const std::ptrdiff_t missing = decimals + 1 - (end - out);
  if (missing > 0) {
    std::memmove(out + missing, out, static_cast<std::size_t>(end - out));
    std::memset(out, '0', static_cast<std::size_t>(missing));
    end += missing;
  }
  std::memmove(end - decimals + 1, end - decimals, static_cast<std::size_t>(decimals));
  end[-decimals] = '.';
  return end + 1;
}

} // namespace ada

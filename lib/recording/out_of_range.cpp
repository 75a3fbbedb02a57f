// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "recording/out_of_range.h"

#include <fmt/format.h>

namespace ada {

namespace {

/// From the year 2000 to 2100, in seconds since 1970: what a clock of our time says.
constexpr double kFrom_s = 946'684'800, kTo_s = 4'102'444'800;

struct Unit {
  const char *name;
  double in_a_second;
};
constexpr Unit kUnits[] = {{"milliseconds", 1e3}, {"microseconds", 1e6}, {"nanoseconds", 1e9}};

} // namespace

std::string out_of_range(const Column &column, double value) {
  if (column.values == &Capture::time_s)
    for (const Unit &unit : kUnits)
      if (value > kFrom_s * unit.in_a_second && value < kTo_s * unit.in_a_second)
        return fmt::format("is out of range, it looks like {} since 1970: give seconds, from any "
                           "origin",
                           unit.name);
  return "is out of range";
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Date and time as SigMF states them: ISO 8601 in UTC.
#pragma once

#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>

namespace ada {

inline std::string utc_now() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  std::tm utc{};
  gmtime_r(&now.tv_sec, &utc);
  char text[64];
  std::snprintf(text, sizeof text, "%04d-%02d-%02dT%02d:%02d:%02d.%03ldZ", utc.tm_year + 1900,
                utc.tm_mon + 1, utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec,
                now.tv_nsec / 1'000'000);
  return text;
}

/// NaN for a text that is no such time.
inline double seconds_since(const std::string &datetime) {
  std::tm utc{};
  double seconds = 0;
  if (std::sscanf(datetime.c_str(), "%d-%d-%dT%d:%d:%lfZ", &utc.tm_year, &utc.tm_mon, &utc.tm_mday,
                  &utc.tm_hour, &utc.tm_min, &seconds) != 6)
    return std::nan("");
  utc.tm_year -= 1900;
  utc.tm_mon -= 1;
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) -
         static_cast<double>(timegm(&utc)) - seconds;
}

} // namespace ada

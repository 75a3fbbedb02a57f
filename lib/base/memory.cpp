// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/memory.h"

#include <algorithm>

#include <sys/resource.h>
#include <unistd.h>

namespace ada {

double memory_bytes() noexcept {
  const double machine =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  struct rlimit limit {};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return machine;
  return std::min(machine, static_cast<double>(limit.rlim_cur));
}

} // namespace ada

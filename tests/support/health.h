// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "health/health.h"
#include "support/sensor_pair.h"

namespace ada::test {

/// The check with this id.
inline const HealthCheck &find(const Health &health, std::string_view id) {
  for (const HealthCheck &check : health.checks)
    if (check.id == id)
      return check;
  throw std::runtime_error("no check " + std::string(id));
}

} // namespace ada::test

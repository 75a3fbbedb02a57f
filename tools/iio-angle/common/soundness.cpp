// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/soundness.h"

#include "common/print.h"

namespace cli {

void warn_of_faults(const Recording &capture, const std::string &path) {
  const auto health =
      make<Health>(ada4571_check, capture.get(), static_cast<const ada4571_model *>(nullptr));
  if (!ada4571_health_sound(health.get()))
    note("but {0} is not sound: see `iio-angle check {0}`\n", path);
}

} // namespace cli

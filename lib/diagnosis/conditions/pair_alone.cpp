// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/pair_alone.h"

#include <cstdint>
#include <numeric>
#include <vector>

#include "base/pick.h"
#include "diagnosis/conditions/no_circle.h"
#include "diagnosis/conditions/observations.h"
#include "diagnosis/criteria.h"

namespace ada {

bool draws_its_circle(const Capture &capture) {
  std::vector<std::uint32_t> some(capture.size());
  std::iota(some.begin(), some.end(), 0u);
  some = thin(some, criteria::kForCircle);
  return draws_circle(pick(capture.vsin_v, some), pick(capture.vcos_v, some));
}

Capture without_reference(Capture capture) {
  capture.reference_deg.clear();
  return capture;
}

} // namespace ada

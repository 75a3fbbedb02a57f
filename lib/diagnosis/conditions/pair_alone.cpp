// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/pair_alone.h"

#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "base/error.h"
#include "base/pick.h"
#include "calibration/ellipse_fit.h"
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

double off_own_figure_v(const Capture &capture) {
  std::vector<std::uint32_t> some(capture.size());
  std::iota(some.begin(), some.end(), 0u);
  some = thin(some, criteria::kForCircle);
  try {
    const EllipseFit fit = fit_ellipse(pick(capture.vsin_v, some), pick(capture.vcos_v, some));
    return fit.coverage_deg >= 360.0 * criteria::kLeastCoverage
               ? fit.residual_rms_v
               : std::numeric_limits<double>::infinity();
  } catch (const Error &error) {
    if (error.status() != ADA4571_ERROR_UNUSABLE_DATA)
      throw;
    return std::numeric_limits<double>::infinity();
  }
}

Capture without_reference(Capture capture) {
  capture.reference_deg.clear();
  return capture;
}

} // namespace ada

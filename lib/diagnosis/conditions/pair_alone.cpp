// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/pair_alone.h"

#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "base/error.h"
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

std::optional<EllipseFit> own_ellipse(const std::vector<double> &vsin,
                                      const std::vector<double> &vcos) {
  try {
    EllipseFit fit = fit_ellipse(vsin, vcos);
    if (fit.coverage_deg < 360.0 * criteria::kLeastCoverage)
      return std::nullopt;
    return fit;
  } catch (const Error &error) {
    if (error.status() != ADA4571_ERROR_UNUSABLE_DATA)
      throw;
    return std::nullopt;
  }
}

double off_own_figure_v(const Capture &capture) {
  std::vector<std::uint32_t> some(capture.size());
  std::iota(some.begin(), some.end(), 0u);
  some = thin(some, criteria::kForCircle);
  const auto fit = own_ellipse(pick(capture.vsin_v, some), pick(capture.vcos_v, some));
  return fit ? fit->residual_rms_v : std::numeric_limits<double>::infinity();
}

Capture without_reference(Capture capture) {
  capture.reference_deg.clear();
  return capture;
}

} // namespace ada

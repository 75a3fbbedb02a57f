// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/no_circle.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/robust.h"
#include "calibration/guards.h"
#include "diagnosis/criteria.h"

namespace ada {

namespace {

/// Share of the samples that fit the ellipse and lie within kDeadCentre of the usual distance from
/// its centre.
double share_near_centre(const std::vector<double> &vsin, const std::vector<double> &vcos,
                         const EllipseFit &fit) {
  std::vector<double> radius;
  radius.reserve(vsin.size());
  for (std::size_t i = 0; i < vsin.size(); ++i)
    if (fit.accepted[i])
      radius.push_back(
          std::hypot(vsin[i] - fit.value.centre_sin_v, vcos[i] - fit.value.centre_cos_v));
  const double near = criteria::kDeadCentre * quantile(radius, 0.5);
  const auto count =
      std::count_if(radius.begin(), radius.end(), [&](double r) { return r < near; });
  return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(radius.size(), 1));
}

/// Nothing of too few samples, or of too short an arc: that is said elsewhere.
std::optional<EllipseFit> ellipse_of(const std::vector<double> &vsin,
                                     const std::vector<double> &vcos) {
  try {
    return fit_ellipse(vsin, vcos);
  } catch (const Error &error) {
    if (error.status() != ADA4571_ERROR_UNUSABLE_DATA)
      throw;
    return std::nullopt;
  }
}

std::string why_no_angle(const std::vector<double> &vsin, const std::vector<double> &vcos,
                         const EllipseFit &fit) {
  std::string why = why_no_circle(fit);
  if (why.empty())
    return {};
  if (share_near_centre(vsin, vcos, fit) > criteria::kMostNearCentre)
    return why + ", and they come near its centre, where a pair has no angle";
  if (fit.coverage_deg < criteria::kAllRound)
    return why + ", and the readings stand at one side of it";
  return {};
}

} // namespace

std::string why_no_angle(const std::vector<double> &vsin, const std::vector<double> &vcos) {
  const auto fit = ellipse_of(vsin, vcos);
  return fit ? why_no_angle(vsin, vcos, *fit) : std::string();
}

bool draws_circle(const std::vector<double> &vsin, const std::vector<double> &vcos) {
  const auto fit = ellipse_of(vsin, vcos);
  return fit && fit->coverage_deg >= 360.0 * criteria::kLeastCoverage &&
         static_cast<double>(fit->rejected) < kMaxRejected * static_cast<double>(vsin.size()) &&
         why_no_angle(vsin, vcos, *fit).empty();
}

} // namespace ada

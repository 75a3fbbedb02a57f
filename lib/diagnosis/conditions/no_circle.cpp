// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/no_circle.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "base/angle.h"
#include "base/error.h"
#include "base/robust.h"
#include "calibration/guards.h"
#include "conversion/ellipse.h"
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

/// Whether readings go on from row to row, by far less than they lie apart in all: what stands in a
/// place scatters about it, and from row to row by the square root of two times as much (von
/// Neumann's ratio, 1941; here of medians, which no wild row moves). `away_v`: from the place.
bool move_on(const std::vector<double> &vsin, const std::vector<double> &vcos,
             const std::vector<double> &away_v) {
  // 1 of white noise; of a walk to and fro over twenty rows 0.05.
  constexpr double kMoves = 0.1;
  std::vector<double> steps_v;
  for (std::size_t i = 1; i < away_v.size(); ++i)
    if (const double step = std::hypot(vsin[i] - vsin[i - 1], vcos[i] - vcos[i - 1]); step > 0.0)
      steps_v.push_back(step); // one that is none is of the converter
  return std::pow(quantile(std::move(steps_v), 0.5), 2) <
         2.0 * kMoves * std::pow(quantile(away_v, 0.5), 2);
}

/// Why readings of which most stand in one place draw no circle, where the few others lie on none:
/// through one place and a few readings an ellipse passes that is nobody's. Empty where a shaft
/// that rests for most of the time turns for the rest of it, and where what most do is a circle by
/// itself, whatever a few wild readings are.
std::string why_one_place(const std::vector<double> &vsin, const std::vector<double> &vcos,
                          const EllipseFit &fit) {
  const double sin_v = quantile(vsin, 0.5), cos_v = quantile(vcos, 0.5);
  std::vector<double> away(vsin.size());
  for (std::size_t i = 0; i < away.size(); ++i)
    away[i] = std::hypot(vsin[i] - sin_v, vcos[i] - cos_v);
  const double limit = criteria::kElsewhere * quantile(away, 0.5);
  if (move_on(vsin, vcos, away))
    return {};
  const EllipseInverse circle = invert(fit.value);
  constexpr double kSectors = 36.0;
  std::set<int> reached; // by what stands in one place, or turns
  double others = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < away.size(); ++i) {
    const double sine = circle.sine(vsin[i], vcos[i]), cosine = circle.cosine(vsin[i], vcos[i]);
    if (away[i] > limit) {
      others += 1.0;
      squares += std::pow(std::hypot(sine, cosine) - 1.0, 2);
    } else {
      reached.insert(static_cast<int>(std::floor(kSectors / kTwoPi * std::atan2(sine, cosine))));
    }
  }
  const bool turns = static_cast<double>(reached.size()) > kSectors * criteria::kLeastCoverage;
  if (others == 0.0 || others > criteria::kMostElsewhere * static_cast<double>(away.size()) ||
      (turns && why_no_circle(fit).empty()) ||
      !(squares > others * criteria::kOffCircle * criteria::kOffCircle))
    return {};
  return fmt::format("all but {:.0f} of {} readings stand in one place, and those draw no circle",
                     others, away.size());
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
  if (std::string one = why_one_place(vsin, vcos, fit); !one.empty())
    return one;
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

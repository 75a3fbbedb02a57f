// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "base/angle.h"
#include "base/robust.h"
#include "calibration/dead_channel.h"
#include "calibration/guards.h"
#include "health/checks.h"
#include "health/criteria.h"

namespace ada::health {

namespace {

/// The pair without the row in which a channel keeps one value: that is no cut-off peak. Of a long
/// recording the sample does not hold its rows.
Capture without_frozen(const Evidence &e) {
  Capture out;
  out.vsin_v = e.capture.vsin_v;
  out.vcos_v = e.capture.vcos_v;
  if (e.stuck && e.stuck->frozen && !e.what.is_long)
    for (auto *channel : {&out.vsin_v, &out.vcos_v}) {
      const auto first = channel->begin() + static_cast<std::ptrdiff_t>(e.stuck->first);
      channel->erase(first, first + static_cast<std::ptrdiff_t>(e.stuck->samples));
    }
  return out;
}

} // namespace

HealthCheck check_rotation(const Evidence &e) {
  if (!e.ellipse) {
    HealthCheck check = cannot_tell("rotation", e.no_ellipse);
    if (e.no_circle)
      check.state = HealthState::failed;
    return check;
  }
  const EllipseFit &fit = *e.ellipse;
  const double out_of_round = fit.structure_rms_v / fit.value.amplitude_v;
  if (out_of_round > kRoundness)
    return verdict(
        "rotation", false, out_of_round, kRoundness, "of the radius",
        fmt::format("the samples lie on no circle: their curve leaves the best ellipse "
                    "by {:.2g} % of its radius (rms), as a triangle or a cut-off sine does",
                    100 * out_of_round));
  if (const double off = std::abs(fit.value.delta_rad) * kDegPerRad; off > kMostQuadratureDeg)
    return verdict(
        "rotation", false, off, kMostQuadratureDeg, "deg",
        fmt::format("VSIN and VCOS are {:.1f} electrical degrees off a quarter of a period "
                    "from each other, which no sensor with a sine and a cosine is",
                    off));
  if (e.tally.reversals > 0)
    return verdict(
        "rotation", false, static_cast<double>(e.tally.reversals), 0, "times",
        fmt::format("the angle runs back at the same speed from one sample to "
                    "the next, {} times, first at {}: a channel was inverted there, or the "
                    "two were exchanged",
                    e.tally.reversals, moment(e.what.recording, e.tally.first_reversal)));
  return verdict("rotation", true, fit.coverage_deg, kAbsent, "deg",
                 fmt::format("{:.0f} electrical degrees of one circle, which the samples leave by "
                             "{:.2g} % of its radius (rms)",
                             fit.coverage_deg, 100 * fit.residual_rms_v / fit.value.amplitude_v));
}

HealthCheck check_clipping(const Evidence &e) {
  if (!e.ellipse)
    return cannot_tell("clipping", kNoCircle);
  if (e.ellipse->coverage_deg < kWholeTurnDeg)
    return cannot_tell("clipping",
                       fmt::format("only {:.0f} electrical degrees were covered, so not every peak "
                                   "was seen",
                                   e.ellipse->coverage_deg));
  const std::string why = why_clipped(without_frozen(e), *e.ellipse);
  // Beside a channel that is stuck the other one looks clipped; but one that clips hard is both.
  if (e.stuck && !why.starts_with(e.stuck->name))
    return cannot_tell("clipping", no_figures(e));
  return verdict("clipping", why.empty(), kAbsent, kAbsent, "",
                 why.empty() ? "the peaks are round" : why);
}

HealthCheck check_stuck(const Evidence &e) {
  const Capture &c = e.capture;
  if (e.stuck) {
    const auto &[name, first, samples, frozen] = *e.stuck;
    const std::string from = moment(e.what.recording, first);
    return verdict(
        "stuck", false, static_cast<double>(samples), kAbsent, "samples",
        frozen ? fmt::format("{} without the stated noise: the same value each time from {} on, {} "
                             "samples in a row",
                             name, from, samples)
               : fmt::format("{} stops following the angle at {} ({} samples in all)", name, from,
                             samples));
  }
  if (!e.turns)
    return cannot_tell("stuck", "the magnet does not turn, so nothing shows whether the channels "
                                "follow it");
  return verdict("stuck", true, std::min(travel(c.vsin_v), travel(c.vcos_v)), kAbsent,
                 "V of travel", "both channels follow the magnet");
}

HealthCheck check_short(const Evidence &e) {
  if (!e.turns)
    return cannot_tell("short", "the magnet does not turn, so equal channels prove nothing");
  const Capture &c = e.capture;
  const std::vector<double> &sin = e.path_sin(), &cos = e.path_cos();
  std::vector<double> difference(sin.size());
  std::transform(sin.begin(), sin.end(), cos.begin(), difference.begin(), std::minus<>());
  const double most = std::max(travel(c.vsin_v), travel(c.vcos_v));
  const double apart = travel(difference) / most;
  constexpr double kMovedPart = 0.25; // of the travel, from the middle
  // A shorted pair has one voltage, and has it also where it is not where it mostly is.
  const auto is_one = [&](std::size_t from, std::size_t count) {
    const std::size_t end = from + std::min(count, sin.size() - from);
    const auto part = [&](const std::vector<double> &v) {
      return std::vector<double>(v.begin() + static_cast<std::ptrdiff_t>(from),
                                 v.begin() + static_cast<std::ptrdiff_t>(end));
    };
    const double middle = quantile(part(sin), 0.5), level = kShortedRatio * c.meta.supply_v;
    std::size_t moved = 0, moved_apart = 0;
    for (std::size_t i = from; i < end; ++i)
      if (std::abs(sin[i] - middle) > kMovedPart * most) {
        ++moved;
        moved_apart += !(std::abs(difference[i]) <= level);
      }
    return std::abs(quantile(part(difference), 0.5)) <= level && 2 * moved_apart <= moved;
  };
  constexpr std::size_t kBegin = 20; // samples that a stretch has at least
  std::optional<std::size_t> first;
  if (apart < kShortedRatio && is_one(0, difference.size()))
    first = 0;
  else if (const auto found = stuck_stretches(difference, most, sin, most);
           found && is_one(found->first, kBegin))
    first = found->first;
  return verdict("short", !first, apart, kAbsent, "of the travel",
                 first ? fmt::format("VSIN and VCOS move together from {} on: they are shorted",
                                     moment(e.what.recording, e.path_place(*first)))
                       : "VSIN and VCOS move apart");
}

} // namespace ada::health

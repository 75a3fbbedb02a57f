// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

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
  std::optional<std::size_t> first;
  if (apart < kShortedRatio)
    first = 0;
  else if (const auto found = stuck_stretches(difference, most, sin, most))
    first = found->first;
  return verdict("short", !first, apart, kAbsent, "of the travel",
                 first ? fmt::format("VSIN and VCOS move together from {} on: they are shorted",
                                     moment(e.what.recording, e.path_place(*first)))
                       : "VSIN and VCOS move apart");
}

} // namespace ada::health

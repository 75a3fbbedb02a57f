// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A magnet that slips on its shaft, and jumps of the pair that have no name.

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/events/jump.h"
#include "diagnosis/events/jump_gap.h"
#include "diagnosis/events/screening.h"

namespace ada {

namespace {

OwnJumps as_own(const Screened &look, std::size_t at, double ahead_rad) {
  const bool forward = ahead_rad > 0.0;
  return {forward ? 1u : 0u,
          forward ? 0u : 1u,
          std::abs(ahead_rad),
          look.capture.time_s[at],
          ahead_rad * ahead_rad,
          {static_cast<std::uint32_t>(at)},
          0};
}

} // namespace

OwnJumps unnamed_jumps(const Screened &look) {
  constexpr std::size_t kNear = 20;                  // samples
  constexpr double kBeyondSteps = 20.0 * kRadPerDeg; // of the period
  OwnJumps out;
  for (std::size_t k = 0; k < look.disorder.size(); ++k)
    out += as_own(look, look.disorder[k], look.disorder_rad[k]);
  if (look.capture.has_reference() || !look.smooth)
    return out;
  for (const Jump &jump : jumps_of(look)) {
    const bool known = std::any_of(look.jumps.begin(), look.jumps.end(), [&](std::size_t at) {
      return std::max(at, jump.at) - std::min(at, jump.at) < kNear;
    });
    // What comes back within a turn leaves no trace in whole turns. A step of an offset would have
    // to be a third of the amplitude to turn the vector so far.
    const bool far = look.capture.meta.periods_per_turn * std::abs(jump.gap) > kBeyondSteps;
    if (known || std::abs(jump.gap) < std::max(kWidestSlip, kSlipStandsOut * jump.error) ||
        (!far && turns_deny(look, look.angle, jump)))
      continue;
    out += as_own(look, jump.at, jump.per_frame < 0.0 ? -jump.gap : jump.gap);
  }
  return out;
}

namespace {

/// Whether the vector changes its length where it jumps by more than half of its way: a magnet that
/// turns on its shaft does not, and on an ellipse the length changes by an axis' error of the way.
bool jumps_in_length(const Screened &look, const Jump &jump) {
  constexpr std::size_t kSide = 6;
  constexpr double kOfWay = 0.5;
  const Capture &c = look.capture;
  if (jump.at < kSide || jump.at + kSide > c.size())
    return false;
  std::vector<double> length(c.size(), 0.0);
  const double half_sin = range_of(c.vsin_v, look.usable).half,
               half_cos = range_of(c.vcos_v, look.usable).half;
  for (std::size_t i = jump.at - kSide; i < jump.at + kSide; ++i)
    length[i] = std::hypot((c.vsin_v[i] - look.centre_sin_v) / half_sin,
                           (c.vcos_v[i] - look.centre_cos_v) / half_cos);
  return std::abs(lines_meet(look, length, jump.at, kSide).gap) >
         kOfWay * std::abs(jump.gap) * c.meta.periods_per_turn;
}

} // namespace

bool screen_slip(Screened &look, const Effect &effect) {
  if (look.capture.has_reference())
    return false;
  const Jump *largest = nullptr;
  const auto jumps = jumps_of(look);
  if (loses_by_size(look, jumps))
    return false;
  for (const Jump &jump : jumps)
    if (samples_lost(look, jump) == 0.0 && !seen_before(look, jump) &&
        (!largest || std::abs(jump.gap) > std::abs(largest->gap)))
      largest = &jump;
  // A kink of a rough motion is no jump, nor is what repeats with the angle: one slip stands
  // clear of everything else.
  if (!largest || std::abs(largest->gap) < kSlipStandsOut * largest->error)
    return false;
  for (const Jump &jump : jumps)
    if (&jump != largest && std::abs(jump.gap) > 0.5 * std::abs(largest->gap))
      return false;
  // A slip turns everything after it; a step of an offset only some angles, to either side.
  if (turns_deny(look, look.angle, *largest) || !is_at_once(look, look.angle, *largest) ||
      jumps_in_length(look, *largest))
    return false;
  look.jumps.push_back(largest->at);
  look.jump_rad.push_back(largest->gap);
  look.jump_lost.push_back(0);
  leave_out_about(look, largest->at, 10);
  look.findings.push_back({&effect,
                           {look.capture.time_s[largest->at], largest->gap * kDegPerRad},
                           {median_step(look.capture.time_s), largest->error * kDegPerRad},
                           other_jumps(effect),
                           {}});
  return true;
}

} // namespace ada

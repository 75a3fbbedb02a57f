// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Jumps of an angle over time, and what tells a slip of the magnet from rows that are missing.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/angle.h"
#include "diagnosis/events/jump_gap.h"
#include "model/residual.h"

namespace ada {

/// Of a magnet: what jumps by more, in a record that loses samples or more than once, is no slip.
inline constexpr double kWidestSlip = 5.0 * kRadPerDeg;

/// A jump of the angle over time: straight lines over `side` samples before and after meet there
/// with a gap.
struct Jump {
  std::size_t at;   ///< first sample after
  double gap;       ///< rad, mechanical
  double per_frame; ///< rad that the shaft turns from sample to sample
  double error;
  double bend;   ///< rad by which per_frame differs between the two lines
  Gap fine = {}; ///< the same from as many samples as move alike; error 0 when it is not known
  bool at_rest() const { return std::abs(per_frame) < error; }
};

/// How straight lines over `side` samples before and after a place meet.
struct Meeting {
  double gap, before, after; ///< rad; rad/s
  double fewest;             ///< usable samples of the poorer side
};

Meeting lines_meet(const Screened &look, const std::vector<double> &angle, std::size_t at,
                   std::size_t side, std::optional<std::size_t> without = std::nullopt);

/// Standard deviations of a gap from which on one is told by itself.
inline constexpr double kSlipStandsOut = 12.0;

/// How far the shaft turns from one row to the next about a jump, rad.
double step_at(const Screened &look, const Jump &jump);

/// Samples lost at a jump, or 0 when it is no whole number of them in the sense of the rotation.
/// The angle is known up to whole periods only: a loss that turns the shaft by most of one looks
/// like a jump back. Without a reference a small one may be a slip and stays what it seems.
/// `believed`: the record is known to lose samples, and the number need not be seen to be whole.
double samples_lost(const Screened &look, const Jump &jump, bool believed = false);

/// Whether the means of two whole turns before and two after, in which everything that repeats with
/// the turn cancels, know nothing of a jump. False where there are not as many turns, or at rest.
bool turns_deny(const Screened &look, const std::vector<double> &angle, const Jump &jump);

/// Whether the pair turns on where the reference jumps: what is lost is lost of both.
bool pair_turns_on(const Screened &look, const Jump &jump);

/// Whether a look at the pair as it came took this jump for a loss.
bool seen_before(const Screened &look, const Jump &jump);

std::vector<Jump> jumps_of(const Screened &look);

/// Whether a gap between two lines lies between two samples, as a slip does. One that lies over all
/// of the lines is a bend: where a hand turns fastest both lines are too steep.
bool is_at_once(const Screened &look, const std::vector<double> &angle, const Jump &jump);

/// Whether the shaft goes on about a jump as it does beside it: at a rest a little way off on
/// either side it went from one place to another, which is no loss of rows, whatever its speed
/// between.
bool goes_on(const Screened &look, const Jump &jump);

/// Whether a jump is further than a magnet slips more than once, and further than a shaft goes from
/// one row to the next that turns on at one speed before and after.
bool too_far_for_a_slip(const Screened &look, const Jump &jump);

/// Without a reference, whether the record loses rows by the size of its jumps alone: one may be a
/// slip, several in the sense of the rotation are none. That their numbers are whole need not show:
/// a ripple of the speed hides it. Rows that come in a wrong order jump back as well.
bool loses_by_size(const Screened &look, const std::vector<Jump> &jumps);

/// Leaves out what lies about a jump, its edges that passed for spikes included.
void leave_out_about(Screened &look, std::size_t centre, std::size_t half);

/// What makes the angle jump as well.
std::vector<std::string> other_jumps(const Effect &effect);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Rows that are missing, or out of order, and a time column that does not show it.

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/events/jump.h"
#include "diagnosis/events/jump_gap.h"
#include "diagnosis/events/screening.h"

namespace ada {

namespace {

/// By how much the number of rows at a jump is uncertain as the shaft turned unevenly meanwhile: as
/// far as the speeds before and after differ.
double rows_by_speed(const Jump &jump, double lost) {
  return std::abs(0.5 * lost * jump.bend / jump.per_frame);
}

/// Whether the number of rows at a jump is known well enough to be seen to be none that is whole.
bool is_not_whole(const Screened &look, const Jump &jump) {
  constexpr double kKnown = 0.1, kErrors = 4.0; // rows
  if (jump.fine.error <= 0.0)
    return false;
  const double rows = jump.fine.size / step_at(look, jump);
  const double error = std::abs(jump.fine.error / step_at(look, jump));
  const double of_speed = rows_by_speed(jump, rows);
  return std::max(error, of_speed) < kKnown &&
         std::abs(rows - std::round(rows)) > kErrors * std::hypot(error, of_speed);
}

} // namespace

bool loses_by_size(const Screened &look, const std::vector<Jump> &jumps) {
  if (look.capture.has_reference() || !std::all_of(jumps.begin(), jumps.end(), [](const Jump &j) {
        return j.gap * j.per_frame > 0.0 || std::abs(j.gap) < kWidestSlip;
      }))
    return false;
  return std::count_if(jumps.begin(), jumps.end(), [&](const Jump &j) {
           return too_far_for_a_slip(look, j) && !is_not_whole(look, j);
         }) > 1;
}

void leave_out_about(Screened &look, std::size_t centre, std::size_t half) {
  const std::size_t from = centre > half ? centre - half : 0;
  std::erase_if(look.spikes, [&](std::uint32_t i) { return i >= from && i < centre + half; });
  for (std::size_t i = from; i < std::min(look.usable.size(), centre + half); ++i)
    look.usable[i] = 0;
}

std::vector<std::string> other_jumps(const Effect &effect) {
  std::vector<std::string> out;
  for (const Effect *e : catalogue())
    if (e != &effect && is_jump(e->info()))
      out.emplace_back(e->info().id);
  return out;
}

namespace {

/// Whether the shaft turns about as fast for as long as rows are lost, on either side: a number of
/// rows is its jump over the speed, and near a reversal any number. A record that ends before has
/// to hold its speed the better, and on both sides.
bool speed_holds(const Screened &look, const Jump &jump, double lost) {
  constexpr double kAlike = 2.0, kNearlyAlike = 1.25;
  const std::size_t n = look.angle.size();
  const double per_frame = step_at(look, jump);
  if (!(lost >= 1.0) || jump.at == 0 || jump.at >= n)
    return false;
  const auto reach_of = [&](std::size_t rows) {
    return static_cast<std::size_t>(std::min(std::ceil(lost), static_cast<double>(rows)));
  };
  const std::size_t before = reach_of(jump.at - 1), after = reach_of(n - 1 - jump.at);
  const auto alike = [&](std::size_t from, std::size_t rows, double most) {
    const double ratio =
        (look.angle[from + rows] - look.angle[from]) / (static_cast<double>(rows) * per_frame);
    return rows != 0 && ratio * most > 1.0 && ratio < most;
  };
  const auto both = [&](double most) {
    return std::pair(alike(jump.at - 1 - before, before, most), alike(jump.at, after, most));
  };
  const auto [ahead, behind] = both(kAlike);
  if ((ahead && static_cast<double>(before) >= lost) ||
      (behind && static_cast<double>(after) >= lost))
    return true;
  const auto [nearly_ahead, nearly_behind] = both(kNearlyAlike);
  return nearly_ahead && nearly_behind;
}

/// Takes out the three jumps of two neighbouring blocks of rows that change places: the first goes
/// ahead by the rows of the one, the second back by those of both, and the third ahead by those of
/// the other, each known up to whole periods of the angle. Nothing is lost by that, and no row of
/// them is of its time.
void leave_out_of_order(Screened &look, std::vector<Jump> &jumps) {
  constexpr double kOff = 2.0, kOfBlock = 0.1; // rows that a place and a size may be off by
  constexpr double kKnown = 0.1; // of the period: beyond it any jump is any number of rows
  const double period =
      kTwoPi / (look.capture.has_reference() ? 1.0 : look.capture.meta.periods_per_turn);
  std::vector<char> wrong(jumps.size(), 0);
  for (std::size_t k = 0; k + 2 < jumps.size(); ++k) {
    const double first =
                     static_cast<double>(jumps[k + 2].at) - static_cast<double>(jumps[k + 1].at),
                 second = static_cast<double>(jumps[k + 1].at) - static_cast<double>(jumps[k].at);
    const auto goes = [&](const Jump &jump, double rows) {
      const double step = step_at(look, jump);
      const double may_be_off = std::abs(step) * (kOff + kOfBlock * std::min(first, second));
      return !jump.at_rest() && std::abs(step) > jump.error && may_be_off < kKnown * period &&
             std::abs(wrap_centred(jump.gap - rows * step, period)) < may_be_off;
    };
    if (goes(jumps[k], first) && goes(jumps[k + 1], -(first + second)) &&
        goes(jumps[k + 2], second)) {
      wrong[k] = wrong[k + 1] = wrong[k + 2] = 1;
      std::fill(look.usable.begin() + static_cast<std::ptrdiff_t>(jumps[k].at),
                look.usable.begin() + static_cast<std::ptrdiff_t>(jumps[k + 2].at), char{0});
    }
  }
  std::size_t place = 0;
  std::erase_if(jumps, [&](const Jump &jump) {
    const bool is_wrong = wrong[place++] != 0;
    if (is_wrong) {
      look.disorder.push_back(jump.at);
      look.disorder_rad.push_back(jump.per_frame < 0.0 ? -jump.gap : jump.gap);
    }
    return is_wrong;
  });
}

/// Takes out a jump and the next one where that takes it back, as no loss does: a shaft that goes
/// to and fro, or a contact.
void leave_out_undone(std::vector<Jump> &jumps) {
  constexpr double kErrors = 4.0, kOfJump = 0.02;
  std::vector<char> undone(jumps.size(), 0);
  for (std::size_t k = 0; k + 1 < jumps.size(); ++k) {
    const double left = std::abs(jumps[k].gap + jumps[k + 1].gap);
    if (left < std::max(kErrors * std::hypot(jumps[k].error, jumps[k + 1].error),
                        kOfJump * std::abs(jumps[k].gap)) &&
        left < 0.5 * std::abs(jumps[k].gap))
      undone[k] = undone[k + 1] = 1;
  }
  std::size_t place = 0;
  std::erase_if(jumps, [&](const Jump &) { return undone[place++] != 0; });
}

} // namespace

bool screen_losses(Screened &look, const Effect &effect) {
  constexpr std::ptrdiff_t kProof = 2;
  double events = 0.0, samples = 0.0, squares = 0.0;
  std::size_t whole = 0; // jumps of a number of rows that is seen to be whole
  std::vector<Jump> jumps = jumps_of(look);
  if (look.capture.has_reference())
    std::erase_if(jumps, [&](const Jump &jump) { return !goes_on(look, jump); });
  leave_out_of_order(look, jumps);
  leave_out_undone(jumps);
  // Whether a jump is one of lost samples if the record loses any: forward, or, where nothing but
  // the reading tells whole periods, so far back that it is one less than forward.
  const auto may_be_loss = [&](const Jump &jump) {
    return jump.gap * jump.per_frame > 0.0 ||
           (!look.capture.has_reference() && std::abs(jump.gap) >= kWidestSlip);
  };
  const bool believed =
      std::count_if(jumps.begin(), jumps.end(), [&](const Jump &jump) {
        return samples_lost(look, jump) != 0.0 || (may_be_loss(jump) && seen_before(look, jump));
      }) >= kProof;
  const bool by_size = loses_by_size(look, jumps);
  for (const Jump &jump : jumps) {
    const double lost = samples_lost(
        look, jump,
        may_be_loss(jump) &&
            (believed || seen_before(look, jump) ||
             (by_size && too_far_for_a_slip(look, jump) && !is_not_whole(look, jump))));
    if (lost == 0.0 || !speed_holds(look, jump, lost) ||
        (look.capture.has_reference() ? pair_turns_on(look, jump)
                                      : turns_deny(look, look.angle, jump)))
      continue;
    events += 1.0;
    samples += std::round(lost);
    const double of_speed = rows_by_speed(jump, lost);
    squares += std::max(1.0, of_speed * of_speed);
    whole += samples_lost(look, jump) != 0.0;
    look.jumps.push_back(jump.at);
    look.jump_rad.push_back(jump.gap);
    look.jump_lost.push_back(static_cast<std::size_t>(std::lround(lost)));
    leave_out_about(look, jump.at, 10);
  }
  if (events == 0.0)
    return false;
  std::vector<std::string> alternatives;
  if (!look.capture.has_reference() && (events == 1.0 || whole == 0))
    alternatives = other_jumps(effect);
  look.findings.push_back(
      {&effect, {events, samples}, {0.0, std::sqrt(squares)}, alternatives, {}});
  return true;
}

} // namespace ada

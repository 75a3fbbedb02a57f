// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Jumps of the angle over time: samples that the record has lost, and slips.

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/events/jump_gap.h"
#include "diagnosis/events/screening.h"

namespace ada {

namespace {

/// A change of speed that stands out of the noise of a gap.
constexpr double kKinkStandsOut = 6.0;
/// Of a magnet: what jumps by more, in a record that loses samples or more than once, is no slip.
constexpr double kWidestSlip = 5.0 * kRadPerDeg;

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

/// Samples of half a turn at this rotation from sample to sample.
std::size_t reach_of(double per_frame, std::size_t side) {
  const double half_turn = per_frame != 0.0 ? 0.5 * kTwoPi / std::abs(per_frame) : 1e9;
  return static_cast<std::size_t>(std::clamp(half_turn, 3.0 * static_cast<double>(side), 1e5));
}

/// Whether the speed is about the same a little before and after a place: where it is not, a curved
/// motion looks like a gap between two straight lines.
bool steady(const std::vector<double> &speeds, std::size_t at, std::size_t reach) {
  const double here = speeds[at];
  const double before = speeds[at > reach ? at - reach : 0];
  const double after = speeds[std::min(at + reach, speeds.size() - 1)];
  return std::abs(before - here) < 0.15 * std::abs(here) &&
         std::abs(after - here) < 0.15 * std::abs(here);
}

/// How straight lines over `side` samples before and after a place meet.
struct Meeting {
  double gap, before, after; ///< rad; rad/s
  double fewest;             ///< usable samples of the poorer side
};

Meeting lines_meet(const Screened &look, const std::vector<double> &angle, std::size_t at,
                   std::size_t side) {
  const std::vector<double> &t = look.capture.time_s;
  const double middle = 0.5 * (t[at] + t[at - 1]);
  double value[2], slope[2], fewest = static_cast<double>(side);
  for (int s = 0; s < 2; ++s) {
    const std::size_t from = s == 0 ? at - side : at;
    double su = 0, sv = 0, suu = 0, suv = 0;
    double m = 0.0;
    for (std::size_t k = from; k < from + side; ++k) {
      if (!look.usable[k])
        continue;
      m += 1.0;
      const double u = t[k] - middle, v = angle[k] - angle[at];
      su += u;
      sv += v;
      suu += u * u;
      suv += u * v;
    }
    fewest = std::min(fewest, m);
    m = std::max(m, 1.0);
    const double d = m * suu - su * su;
    slope[s] = d > 0.0 ? (m * suv - su * sv) / d : 0.0;
    value[s] = (sv - slope[s] * su) / m;
  }
  return {value[1] - value[0], slope[0], slope[1], fewest};
}

/// Where the line over `side` samples on one side of a place arrives there, rad: by medians of
/// slopes and of values, so that a few wild samples do not tilt it.
double theil_sen_at(const Screened &look, const std::vector<double> &angle, std::size_t at,
                    std::size_t side, bool back) {
  const std::vector<double> &t = look.capture.time_s;
  const double middle = 0.5 * (t[at] + t[at - 1]);
  std::vector<std::size_t> good;
  for (std::size_t k = back ? at - side : at; k < (back ? at : at + side); ++k)
    if (look.usable[k])
      good.push_back(k);
  std::vector<double> slopes, values;
  for (std::size_t a : good)
    for (std::size_t b : good)
      if (a < b && t[b] > t[a])
        slopes.push_back((angle[b] - angle[a]) / (t[b] - t[a]));
  const double slope = quantile(std::move(slopes), 0.5);
  for (std::size_t k : good)
    values.push_back(angle[k] - angle[at] - slope * (t[k] - middle));
  return quantile(std::move(values), 0.5);
}

/// Whether a gap is still there for lines that heed no single sample: spikes in a row make one too.
bool stays(const Screened &look, const std::vector<double> &angle, const Jump &jump,
           std::size_t side) {
  const double gap = theil_sen_at(look, angle, jump.at, side, false) -
                     theil_sen_at(look, angle, jump.at, side, true);
  return std::abs(gap - jump.gap) < 0.5 * std::abs(jump.gap) + 4.0 * jump.error;
}

/// Every place of a record as a possible jump.
struct Places {
  std::vector<double> gaps, speeds, bends; ///< rad, rad/s, rad; 0 where nothing can be said
  double sigma = 0.0;                      ///< spread of the gaps; 0: none was measured
};

Places measure(const Screened &look, const std::vector<double> &angle, std::size_t side) {
  const std::size_t n = angle.size();
  const double frame = median_step(look.capture.time_s);
  Places out;
  for (auto *v : {&out.gaps, &out.speeds, &out.bends})
    v->assign(n, 0.0);
  std::vector<double> sizes;
  for (std::size_t i = side; i + side <= n; ++i) {
    const Meeting lines = lines_meet(look, angle, i, side);
    out.speeds[i] = 0.5 * (lines.before + lines.after);
    // The edge of a jump may pass for a spike; a stretch without samples says nothing, and a line
    // says little beyond a gap.
    const std::vector<double> &t = look.capture.time_s;
    if (lines.fewest < 0.75 * static_cast<double>(side) ||
        t[i + side - 1] - t[i - side] > 3.0 * static_cast<double>(side) * frame)
      continue;
    out.gaps[i] = lines.gap;
    out.bends[i] = std::abs(lines.after - lines.before) * static_cast<double>(side) * frame;
    sizes.push_back(std::abs(lines.gap));
  }
  if (!sizes.empty())
    out.sigma = kSigmasOfMedian * quantile(std::move(sizes), 0.5);
  return out;
}

std::vector<Jump> find_jumps(const Screened &look, const std::vector<double> &angle,
                             std::size_t side, double floor_rad) {
  const std::size_t n = angle.size();
  std::vector<Jump> all;
  if (n < 4 * side)
    return all;
  const double frame = median_step(look.capture.time_s);
  Places places = measure(look, angle, side);
  std::vector<double> &gaps = places.gaps;
  const std::vector<double> &speeds = places.speeds, &bends = places.bends;
  const double sigma = std::max(places.sigma, floor_rad);
  // Between two lines about a kink there is a gap of a part of the bend: one that is twice as large
  // as that, and wider than what slips, is a jump however unsteadily a hand turns.
  const auto wide = [&](std::size_t i) {
    return std::abs(gaps[i]) > 2.0 * bends[i] + kKinkStandsOut * sigma + kWidestSlip;
  };
  // A kink, such as a sudden reversal, is a change of speed and no jump. At rest there is always
  // some, of the noise.
  for (std::size_t i = side; i + side <= n; ++i)
    if (bends[i] > std::max(0.3 * std::abs(speeds[i]) * frame * static_cast<double>(side),
                            kKinkStandsOut * sigma) &&
        !wide(i))
      gaps[i] = 0.0;
  // A line says nothing farther away than it is long: across a longer gap in the clock nobody knows
  // how the shaft moved.
  const std::vector<double> &time = look.capture.time_s;
  for (std::size_t k = 1; k < n; ++k)
    if (time[k] - time[k - 1] > frame * static_cast<double>(side))
      std::fill(gaps.begin() + static_cast<std::ptrdiff_t>(k > side ? k - side : 0),
                gaps.begin() + static_cast<std::ptrdiff_t>(std::min(gaps.size(), k + side)), 0.0);
  for (std::size_t i = side; i + side <= n; ++i) {
    // A gap far larger than a kink between the two lines could leave is a jump at any speed.
    const bool clear = std::abs(gaps[i]) > 2.0 * bends[i] + 50.0 * sigma || wide(i) ||
                       steady(speeds, i, reach_of(speeds[i] * frame, side));
    if (std::abs(gaps[i]) < 8.0 * sigma || !clear)
      continue;
    const auto from = gaps.begin() + static_cast<std::ptrdiff_t>(i - side);
    const auto to = gaps.begin() + static_cast<std::ptrdiff_t>(std::min(n, i + side + 1));
    const auto largest =
        std::max_element(from, to, [](double a, double b) { return std::abs(a) < std::abs(b); });
    const Jump jump{i, gaps[i], speeds[i] * frame, sigma, bends[i] / static_cast<double>(side)};
    if (largest - gaps.begin() == static_cast<std::ptrdiff_t>(i) && stays(look, angle, jump, side))
      all.push_back(jump);
  }
  return all;
}

/// How far from a whole number of samples a jump may lie that is known to this error. A slip may be
/// of any size: without a reference a whole number must be the likelier one. Where the error is
/// above four tenths that proves nothing.
double whole(double error, bool has_reference) {
  constexpr double kErrors = 4.0;
  constexpr double kEven = 0.3989; // 1 / sqrt(2 pi)
  if (has_reference)
    return kErrors * error;
  return error > 0.0 && error < kEven ? error * std::sqrt(2.0 * std::log(kEven / error)) : 0.0;
}

/// Standard deviations of a gap from which on one is told by itself.
constexpr double kSlipStandsOut = 12.0;

/// How far the shaft turns from one row to the next about a jump, rad.
double step_at(const Screened &look, const Jump &jump) {
  return jump.fine.error > 0.0 ? jump.fine.speed * median_step(look.capture.time_s)
                               : jump.per_frame;
}

/// Samples lost at a jump, or 0 when it is no whole number of them in the sense of the rotation.
/// The angle is known up to whole periods only: a loss that turns the shaft by most of one looks
/// like a jump back. Without a reference a small one may be a slip and stays what it seems.
/// `believed`: the record is known to lose samples, and the number need not be seen to be whole.
double samples_lost(const Screened &look, const Jump &jump, bool believed = false) {
  constexpr double kMostWraps = 3.0;
  constexpr double kFinest = 0.06, kCoarsest = 0.15; // of a sample, whatever the error says
  const Capture &c = look.capture;
  if (jump.at_rest()) // nothing is seen to be lost
    return 0.0;
  const double period = kTwoPi / (c.has_reference() ? 1.0 : c.meta.periods_per_turn);
  const bool fine = jump.fine.error > 0.0;
  const double least = fine ? kFinest : kCoarsest;
  const double per_frame = step_at(look, jump);
  const double error = std::abs((fine ? jump.fine.error : jump.error) / per_frame);
  const double seen = (fine ? jump.fine.size : jump.gap) / per_frame;
  if ((!fine && std::abs(seen) < 2.5) ||
      (seen < 0.0 && !c.has_reference() && std::abs(jump.gap) < kWidestSlip))
    return 0.0;
  // Further periods only where a reference leaves nothing else that could jump.
  const double most = c.has_reference() ? kMostWraps : (seen < 0.0 ? 1.0 : 0.0);
  for (double wraps = seen < 0.0 ? 1.0 : 0.0; wraps <= most; wraps += 1.0) {
    const double lost = seen + wraps * period / std::abs(per_frame);
    if (lost < 2.5 || lost < 6.0 * error)
      continue;
    const double within = whole(error, c.has_reference());
    if (believed || (within > 0.0 && std::abs(lost - std::round(lost)) < std::max(within, least)))
      return lost;
  }
  return 0.0;
}

/// Mean of angle - speed * time over the whole turn that ends (`back`) or begins at sample `from`;
/// `end` becomes its other end. What repeats with the turn drops out of it.
std::optional<double> turn_mean(const Screened &look, const std::vector<double> &angle,
                                std::size_t from, bool back, double speed, std::size_t &end) {
  const std::vector<double> &t = look.capture.time_s;
  double sum = 0.0, count = 0.0;
  for (std::size_t k = from; back ? k-- > 0 : k < angle.size(); k += !back) {
    if (std::abs(angle[k] - angle[back ? from - 1 : from]) >= kTwoPi) {
      end = back ? k + 1 : k;
      return count > 0.0 ? std::optional(sum / count) : std::nullopt;
    }
    if (look.usable[k]) {
      sum += angle[k] - angle[from] - speed * (t[k] - t[from]);
      count += 1.0;
    }
  }
  return std::nullopt;
}

/// Whether the means of two whole turns before and two after, in which everything that repeats with
/// the turn cancels, know nothing of a jump. False where there are not as many turns, or at rest.
bool turns_deny(const Screened &look, const std::vector<double> &angle, const Jump &jump) {
  if (jump.at_rest())
    return false;
  const double speed = jump.per_frame / median_step(look.capture.time_s);
  std::size_t before = 0, after = 0, end = 0;
  const auto m1 = turn_mean(look, angle, jump.at, true, speed, before);
  const auto p1 = turn_mean(look, angle, jump.at, false, speed, after);
  if (!m1 || !p1)
    return false;
  auto m2 = turn_mean(look, angle, before, true, speed, end);
  auto p2 = turn_mean(look, angle, after, false, speed, end);
  if (!m2 || !p2)
    return false;
  const std::vector<double> &t = look.capture.time_s;
  *m2 += angle[before] - angle[jump.at] - speed * (t[before] - t[jump.at]);
  *p2 += angle[after] - angle[jump.at] - speed * (t[after] - t[jump.at]);
  const double first = *m1 - *m2, second = *p2 - *p1; // the error of a straight line shows in both
  const double gap = *p1 - *m1 - 0.5 * (first + second);
  // Where a shaft gathers speed both differ, and what is taken off may be wrong by several times
  // that.
  constexpr double kCurved = 8.0;
  return std::abs(gap - jump.gap) > 0.4 * std::abs(jump.gap) + kCurved * std::abs(second - first);
}

/// Whether the pair turns on where the reference jumps: what is lost is lost of both.
bool pair_turns_on(const Screened &look, const Jump &jump) {
  const Capture &c = look.capture;
  const Gap own = gap_at(c.time_s, look.angle, look.usable, jump.at);
  const double periods = c.meta.periods_per_turn;
  const double due = std::abs(wrap_centred(periods * jump.gap, kTwoPi)),
               seen = std::abs(wrap_centred(periods * own.size, kTwoPi)),
               error = periods * std::max(own.error, jump.error);
  constexpr double kErrors = 8.0, kHalf = 0.5;
  return own.error > 0.0 && due > kErrors * error && seen < kHalf * due;
}

/// A jump and one back soon after are the ends of a disturbance.
void leave_out_pairs(std::vector<Jump> &jumps) {
  constexpr std::size_t kSoon = 80;
  std::vector<char> paired(jumps.size(), 0);
  for (std::size_t k = 1; k < jumps.size(); ++k)
    if (jumps[k].at - jumps[k - 1].at < kSoon && jumps[k].gap * jumps[k - 1].gap < 0.0)
      paired[k] = paired[k - 1] = 1;
  std::size_t k = 0;
  std::erase_if(jumps, [&](const Jump &) { return paired[k++] != 0; });
}

/// Whether two places are of one jump.
bool same_place(std::size_t one, std::size_t other) {
  constexpr std::size_t kNear = 8;
  return std::max(one, other) - std::min(one, other) < kNear;
}

/// Whether a look at the pair as it came took this jump for a loss.
bool seen_before(const Screened &look, const Jump &jump) {
  return std::any_of(look.lost_before.begin(), look.lost_before.end(),
                     [&](std::size_t at) { return same_place(at, jump.at); });
}

/// What was taken for a loss before is measured again where it no longer stands out by itself.
void measure_again(const Screened &look, std::vector<Jump> &jumps) {
  const double frame = median_step(look.capture.time_s);
  for (std::size_t at : look.lost_before) {
    if (std::any_of(jumps.begin(), jumps.end(),
                    [&](const Jump &jump) { return same_place(at, jump.at); }))
      continue;
    if (const Gap gap = gap_at(look.capture.time_s, look.angle, look.usable, at); gap.error > 0.0)
      jumps.push_back({at, gap.size, gap.speed * frame, gap.error, 0.0, gap});
  }
  std::sort(jumps.begin(), jumps.end(), [](const Jump &a, const Jump &b) { return a.at < b.at; });
}

std::vector<Jump> jumps_of(const Screened &look) {
  if (!look.capture.has_reference()) {
    std::vector<Jump> jumps = find_jumps(look, look.angle, 12, 1e-5);
    leave_out_pairs(jumps);
    for (Jump &jump : jumps)
      jump.fine = gap_at(look.capture.time_s, look.angle, look.usable, jump.at);
    measure_again(look, jumps);
    return jumps;
  }
  return find_jumps(look, reference_angle(look.capture), 6, 4e-6);
}

/// By how much the angle goes further from one sample to the next than its neighbours say, rad.
double beyond_neighbours(const Screened &look, const std::vector<double> &angle, std::size_t at) {
  const std::vector<double> &t = look.capture.time_s;
  const auto step = [&](std::size_t i) { return angle[i] - angle[i - 1]; };
  const auto time = [&](std::size_t i) { return t[i] - t[i - 1]; };
  const double before = time(at - 1), after = time(at + 1);
  if (!(before > 0.0 && after > 0.0))
    return 0.0;
  return step(at) - 0.5 * time(at) * (step(at - 1) / before + step(at + 1) / after);
}

/// Whether a gap between two lines lies between two samples, as a slip does. One that lies over all
/// of the lines is a bend: where a hand turns fastest both lines are too steep.
bool is_at_once(const Screened &look, const std::vector<double> &angle, const Jump &jump) {
  constexpr std::size_t kNear = 2; // samples that the place may be off by
  constexpr double kHalf = 0.5, kErrors = 4.0;
  std::vector<double> all;
  for (std::size_t i = 2; i + 1 < angle.size(); ++i)
    all.push_back(std::abs(beyond_neighbours(look, angle, i)));
  if (all.empty())
    return false;
  const double error = kSigmasOfMedian * quantile(std::move(all), 0.5),
               sense = jump.gap < 0.0 ? -1.0 : 1.0;
  double most = 0.0;
  for (std::size_t i = std::max<std::size_t>(2, jump.at - std::min(jump.at, kNear));
       i <= jump.at + kNear && i + 1 < angle.size(); ++i)
    most = std::max(most, sense * beyond_neighbours(look, angle, i));
  return most > kHalf * std::abs(jump.gap) - kErrors * error;
}

/// Whether the shaft moves a little way before and after a jump at a good part of the speed that it
/// has about it.
struct Sides {
  bool before, after;
};

Sides moves_beside(const Screened &look, const Jump &jump) {
  constexpr std::size_t kNear = 20, kFar = 60; // rows: beyond a move of a few and what it swings by
  constexpr double kRests = 0.25;              // of the speed about the jump
  const double least = kRests * std::abs(step_at(look, jump));
  // By most of its steps, which another move leaves alone, and by its way, which noise does.
  const auto moves = [&](std::size_t from, std::size_t to) {
    to = std::min(to, look.angle.size());
    if (to < from + 2) // an end says nothing
      return true;
    std::vector<double> steps;
    for (std::size_t i = from + 1; i < to; ++i)
      steps.push_back(std::abs(look.angle[i] - look.angle[i - 1]));
    const double way = std::abs(look.angle[to - 1] - look.angle[from]);
    return way > least * static_cast<double>(steps.size()) &&
           quantile(std::move(steps), 0.5) > least;
  };
  const auto back = [&](std::size_t by) { return jump.at > by ? jump.at - by : 0; };
  return {moves(back(kFar), back(kNear)), moves(jump.at + kNear, jump.at + kFar)};
}

/// Whether the shaft goes on about a jump as it does beside it: at a rest a little way off on
/// either side it went from one place to another, which is no loss of rows, whatever its speed
/// between.
bool goes_on(const Screened &look, const Jump &jump) {
  const Sides sides = moves_beside(look, jump);
  return sides.before || sides.after;
}

/// Whether a jump is further than a magnet slips more than once, and further than a shaft goes from
/// one row to the next that turns on at one speed before and after.
bool too_far_for_a_slip(const Screened &look, const Jump &jump) {
  constexpr double kErrors = 6.0, kAlike = 0.2; // of the gap and of the speed, by two lengths
  const auto alike = [](double one, double other) {
    return std::abs(one - other) < kAlike * std::abs(other);
  };
  if (jump.fine.error <= 0.0 || jump.at_rest() || jump.gap * jump.per_frame <= 0.0 ||
      std::abs(jump.gap) < kWidestSlip + kErrors * jump.error || !alike(jump.fine.size, jump.gap) ||
      !alike(step_at(look, jump), jump.per_frame))
    return false;
  const Sides sides = moves_beside(look, jump);
  return sides.before && sides.after && is_at_once(look, look.angle, jump);
}

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

/// Without a reference, whether the record loses rows by the size of its jumps alone: one may be a
/// slip, several in the sense of the rotation are none. That their numbers are whole need not show:
/// a ripple of the speed hides it. Rows that come in a wrong order jump back as well.
bool loses_by_size(const Screened &look, const std::vector<Jump> &jumps) {
  if (look.capture.has_reference() || !std::all_of(jumps.begin(), jumps.end(), [](const Jump &j) {
        return j.gap * j.per_frame > 0.0 || std::abs(j.gap) < kWidestSlip;
      }))
    return false;
  return std::count_if(jumps.begin(), jumps.end(), [&](const Jump &j) {
           return too_far_for_a_slip(look, j) && !is_not_whole(look, j);
         }) > 1;
}

/// Leaves out what lies about a jump, its edges that passed for spikes included.
void mark(Screened &look, std::size_t centre, std::size_t half) {
  const std::size_t from = centre > half ? centre - half : 0;
  std::erase_if(look.spikes, [&](std::uint32_t i) { return i >= from && i < centre + half; });
  for (std::size_t i = from; i < std::min(look.usable.size(), centre + half); ++i)
    look.usable[i] = 0;
}

/// What makes the angle jump as well.
std::vector<std::string> other_jumps(const Effect &effect) {
  std::vector<std::string> out;
  for (const Effect *e : catalogue())
    if (e != &effect && is_jump(e->info()))
      out.emplace_back(e->info().id);
  return out;
}

/// Whether the shaft turns about as fast for as long as rows are lost, on either side: a number of
/// rows is its jump over the speed, and near a reversal any number.
bool speed_holds(const Screened &look, const Jump &jump, double lost) {
  constexpr double kAlike = 2.0;
  const auto rows = static_cast<std::size_t>(std::lround(lost));
  const double per_frame = step_at(look, jump);
  const auto alike = [&](std::size_t from, std::size_t to) {
    const double ratio = (look.angle[to] - look.angle[from]) / (lost * per_frame);
    return ratio * kAlike > 1.0 && ratio < kAlike;
  };
  return (jump.at > rows && alike(jump.at - 1 - rows, jump.at - 1)) ||
         (jump.at + rows < look.angle.size() && alike(jump.at, jump.at + rows));
}

/// Takes out jumps that undo each other, forward and back by whole rows and no farther apart than
/// these are: blocks of rows that come in a wrong order. Nothing is lost by that, and no row of
/// them is of its time.
void leave_out_of_order(Screened &look, std::vector<Jump> &jumps) {
  constexpr double kUndone = 0.1; // of the rows of the largest
  std::vector<char> wrong(jumps.size(), 0);
  for (std::size_t from = 0; from < jumps.size(); ++from) {
    double sum = 0.0, largest = 0.0;
    bool forward = false, back = false;
    bool pair_too = false; // a reference alone that jumps is another matter
    for (std::size_t k = from; k < jumps.size() && !wrong[from]; ++k) {
      const double rows = jumps[k].gap / step_at(look, jumps[k]);
      sum += rows;
      largest = std::max(largest, std::abs(rows));
      (rows > 0.0 ? forward : back) = true;
      if (!(static_cast<double>(jumps[k].at - jumps[from].at) <= 2.0 * largest + 1.0))
        break;
      pair_too = pair_too || !look.capture.has_reference() || !pair_turns_on(look, jumps[k]);
      if (forward && back && pair_too && std::abs(sum) < kUndone * largest)
        std::fill(wrong.begin() + static_cast<std::ptrdiff_t>(from),
                  wrong.begin() + static_cast<std::ptrdiff_t>(k) + 1, char{1});
    }
    for (std::size_t k = from; k + 1 < jumps.size() && wrong[k] && wrong[k + 1]; ++k)
      std::fill(look.usable.begin() + static_cast<std::ptrdiff_t>(jumps[k].at),
                look.usable.begin() + static_cast<std::ptrdiff_t>(jumps[k + 1].at), char{0});
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

} // namespace

bool screen_losses(Screened &look, const Effect &effect) {
  constexpr std::ptrdiff_t kProof = 2;
  double events = 0.0, samples = 0.0, squares = 0.0;
  std::size_t whole = 0; // jumps of a number of rows that is seen to be whole
  std::vector<Jump> jumps = jumps_of(look);
  if (look.capture.has_reference())
    std::erase_if(jumps, [&](const Jump &jump) { return !goes_on(look, jump); });
  leave_out_of_order(look, jumps);
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
    mark(look, jump.at, 10);
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

namespace {

OwnJumps as_own(const Screened &look, std::size_t at, double ahead_rad) {
  const bool forward = ahead_rad > 0.0;
  return {forward ? 1u : 0u,       forward ? 0u : 1u,     std::abs(ahead_rad),
          look.capture.time_s[at], ahead_rad * ahead_rad, {static_cast<std::uint32_t>(at)}};
}

} // namespace

OwnJumps unnamed_jumps(const Screened &look) {
  constexpr std::size_t kNear = 20;                  // samples
  constexpr double kBeyondSteps = 20.0 * kRadPerDeg; // of the period
  OwnJumps out;
  if (look.capture.has_reference())
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
  mark(look, largest->at, 10);
  look.findings.push_back({&effect,
                           {look.capture.time_s[largest->at], largest->gap * kDegPerRad},
                           {median_step(look.capture.time_s), largest->error * kDegPerRad},
                           other_jumps(effect),
                           {}});
  return true;
}

} // namespace ada

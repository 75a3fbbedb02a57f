// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/events/jump.h"

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

} // namespace

Meeting lines_meet(const Screened &look, const std::vector<double> &angle, std::size_t at,
                   std::size_t side, std::optional<std::size_t> without) {
  const std::vector<double> &t = look.capture.time_s;
  const double middle = 0.5 * (t[at] + t[at - 1]);
  double value[2], slope[2], fewest = static_cast<double>(side);
  for (int s = 0; s < 2; ++s) {
    const std::size_t from = s == 0 ? at - side : at;
    double su = 0, sv = 0, suu = 0, suv = 0;
    double m = 0.0;
    for (std::size_t k = from; k < from + side; ++k) {
      if (!look.usable[k] || k == without)
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

namespace {

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

/// Whether a gap is still there for lines that heed no single sample, nor without any one of them:
/// spikes make one too.
bool stays(const Screened &look, const std::vector<double> &angle, const Jump &jump,
           std::size_t side) {
  const double gap = theil_sen_at(look, angle, jump.at, side, false) -
                     theil_sen_at(look, angle, jump.at, side, true);
  if (std::abs(gap - jump.gap) >= 0.5 * std::abs(jump.gap) + 4.0 * jump.error)
    return false;
  for (std::size_t k = jump.at - side; k < jump.at + side; ++k)
    if (std::abs(lines_meet(look, angle, jump.at, side, k).gap) < 0.5 * std::abs(jump.gap))
      return false;
  return true;
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

} // namespace

double step_at(const Screened &look, const Jump &jump) {
  return jump.fine.error > 0.0 ? jump.fine.speed * median_step(look.capture.time_s)
                               : jump.per_frame;
}

double samples_lost(const Screened &look, const Jump &jump, bool believed) {
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

namespace {

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

} // namespace

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

namespace {

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

} // namespace

bool seen_before(const Screened &look, const Jump &jump) {
  return std::any_of(look.lost_before.begin(), look.lost_before.end(),
                     [&](std::size_t at) { return same_place(at, jump.at); });
}

namespace {

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

} // namespace

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

namespace {

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

} // namespace

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

namespace {

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

} // namespace

bool goes_on(const Screened &look, const Jump &jump) {
  const Sides sides = moves_beside(look, jump);
  return sides.before || sides.after;
}

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

} // namespace ada

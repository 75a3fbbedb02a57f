// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A channel that no longer follows the angle while the other one does.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <span>
#include <vector>

#include "base/robust.h"
#include "calibration/dead_channel.h"
#include "diagnosis/criteria.h"
#include "model/residual.h"

namespace ada {

namespace {

/// The most that `others` move while `values` stay within a band: as long as a peak that is cut off
/// lasts, in terms of the other channel.
double most_moved_within(std::span<const double> values, std::span<const double> others,
                         double held, double band) {
  double most = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t from = i;
    while (i < values.size() && std::abs(values[i] - held) <= band)
      ++i;
    if (i > from)
      most = std::max(most, bulk(others.subspan(from, i - from)).width());
  }
  return most;
}

/// Whether a channel moves as noise does and not as one that a vector turns: from row to row as
/// much as in all, and spread like noise. A shaft at rest near the peak of one channel leaves that
/// alone.
bool moves_as_noise(std::span<const double> values, double step_v) {
  // Of noise the bulk is 4.7 standard deviations wide. Kurtosis: 3 of noise, 1.5 of a sine.
  constexpr double kMany = 20.0, kSteps = 4.0, kKurtosis = 2.25;
  const double width = bulk(values).width();
  if (width > kMany * noise_between(values))
    return false;
  double mean = 0.0, squares = 0.0, fourths = 0.0;
  const double n = static_cast<double>(values.size());
  for (double v : values)
    mean += v / n;
  for (double v : values) {
    squares += std::pow(v - mean, 2) / n;
    fourths += std::pow(v - mean, 4) / n;
  }
  return width <= kSteps * step_v || fourths > kKurtosis * squares * squares;
}

void leave_out(Screened &look, std::size_t first, std::size_t end) {
  std::fill(look.usable.begin() + static_cast<std::ptrdiff_t>(first),
            look.usable.begin() + static_cast<std::ptrdiff_t>(end), char{0});
  look.stuck.emplace_back(first, end);
}

bool screen_stuck_to_the_end(Screened &look, const Effect &effect) {
  const Capture &c = look.capture;
  const std::size_t n = c.size();
  // What the other channel does meanwhile tells, and not how long it lasts: a dozen readings do.
  const std::size_t tail = std::max<std::size_t>(12, n / 50);
  if (n < 4 * tail)
    return false;
  const std::vector<double> *channels[2] = {&c.vsin_v, &c.vcos_v};
  for (int k = 0; k < 2; ++k) {
    const double *values = channels[k]->data(), *others = channels[1 - k]->data();
    const double whole = range_of(*channels[1 - k], look.usable).half;
    const double step_v = converter_step(*channels[k]);
    const std::span<const double> last(values + (n - tail), tail);
    const double spread = robust_spread(last);
    // What it holds is as still as a reading of noise: by little of the other's range, or by no
    // more than from one reading to the next, while the other goes slowly: neighbours of a fast
    // shaft differ by the signal.
    constexpr double kStill = 0.01, kOfNoise = 1.5, kStillMost = 0.1;
    const double others_v = noise_between({others + (n - tail), tail});
    const double most_v = others_v < kStillMost * whole ? kOfNoise * noise_between(last) : 0.0;
    if (spread > std::min(std::max(kStill * whole, most_v), kStillMost * whole))
      continue;
    // As far back as it holds what it holds at the end. Of noise below 0.74 steps, rms, half of the
    // readings are the same step, and its median deviation is nothing.
    constexpr double kUnseen = 0.74;
    const double held = quantile(std::vector(last.begin(), last.end()), 0.5);
    const double band = std::max(8.0 * std::max(spread, kUnseen * step_v), 1e-4 * whole);
    std::size_t first = n;
    while (first > 0 && std::abs(values[first - 1] - held) <= band)
      --first;
    if (n - first < tail ||
        (first == 0 && moves_as_noise({others, n}, converter_step(*channels[1 - k]))))
      continue;
    // While the other moves along the circle by `moved` of its half range to either side, a channel
    // that lives moves by no less than this, at its very peak. Of less than a step of its converter
    // nobody knows whether it moved.
    const double width = bulk({others + first, n - first}).width();
    const double moved = std::min(1.0, 0.5 * width / whole);
    const double least = whole * (1.0 - std::sqrt(1.0 - moved * moved));
    if (least < step_v || bulk({values + first, n - first}).width() > criteria::kStuckMoves * least)
      continue;
    // The record may end on a peak that is cut off, as all before it are, or on the only one: that
    // is the highest or lowest that the channel reads, and lasts for less than a peak cut at 0.7.
    if (width <
        criteria::kLongerThanCut * most_moved_within({values, first}, {others, first}, held, band))
      continue;
    constexpr double kCutPeak = 1.4; // half ranges that the other moves by meanwhile
    const auto [lowest, highest] = std::minmax_element(values, values + first);
    if (first > 0 && width < kCutPeak * whole && (held > *highest - band || held < *lowest + band))
      continue;
    leave_out(look, first, n);
    const double step = median_step(c.time_s);
    look.findings.push_back(
        {&effect, {static_cast<double>(k), c.time_s[std::min(first, n - 1)]}, {0.0, step}, {}, {}});
    return true;
  }
  return false;
}

/// Takes off the ends of a stretch what is only near to what it holds, within `most_v`: the channel
/// was on its way.
void trim(StuckStretch &one, std::span<const double> own, double most_v) {
  constexpr double kOfScatter = 8.0, kLeast = 0.005; // of most_v
  const std::span<const double> part = own.subspan(one.first, one.end - one.first);
  const double at = quantile(std::vector(part.begin(), part.end()), 0.5);
  const double band = std::max(kOfScatter * robust_spread(part), kLeast * most_v);
  while (one.first + 1 < one.end && !(std::abs(own[one.first] - at) <= band))
    ++one.first;
  while (one.first + 1 < one.end && !(std::abs(own[one.end - 1] - at) <= band))
    --one.end;
}

/// On which side of what it holds a channel is before a stretch (`step` -1, from the row before it)
/// or after it (+1): the first reading beyond the band tells; 0 where none does.
int side_of(std::span<const double> own, std::size_t from, int step, double at, double band) {
  for (auto i = static_cast<std::ptrdiff_t>(from); i >= 0 && i < std::ssize(own); i += step)
    if (const double off = own[static_cast<std::size_t>(i)] - at; std::abs(off) > band)
      return off > 0.0 ? 1 : -1;
  return 0;
}

/// Whether a stretch is a peak that is cut off, or that no reading resolves: the channel comes to
/// it and leaves it on one side, and goes on from where it stood. One that stood still meanwhile is
/// elsewhere when it follows again, but for chance.
bool is_cut_peak(const StuckStretch &one, std::span<const double> own, double band,
                 double usual_v) {
  constexpr double kJump = 2.0; // of what nearly all steps are less than
  if (one.end >= own.size())
    return true; // nothing shows that it follows again
  const double at = own[one.end - 1];
  if (std::abs(own[one.end] - at) > kJump * usual_v)
    return false;
  const int before = one.first > 0 ? side_of(own, one.first - 1, -1, at, band) : 0,
            after = side_of(own, one.end, 1, at, band);
  return before == 0 || after == 0 || before == after;
}

/// Whether a channel stood still for a while and follows the angle again.
bool screen_stuck_for_a_while(Screened &look, const Effect &effect) {
  constexpr double kNearlyAll = 0.99;
  const Capture &c = look.capture;
  const std::vector<double> *channels[2] = {&c.vsin_v, &c.vcos_v};
  for (int k = 0; k < 2; ++k) {
    const std::vector<double> &own = *channels[k], &other = *channels[1 - k];
    const double travelled_v = travel(own);
    std::vector<StuckStretch> held = each_stuck_stretch(own, travelled_v, other, travel(other));
    if (held.empty())
      continue;
    const double others_step_v = converter_step(other), band = kStuckRatio * travelled_v;
    std::vector<double> steps;
    for (std::size_t i = 1; i < own.size(); ++i)
      steps.push_back(std::abs(own[i] - own[i - 1]));
    const double usual_v = quantile(std::move(steps), kNearlyAll);
    std::erase_if(held, [&](StuckStretch &one) {
      if (moves_as_noise(std::span(other).subspan(one.first, one.end - one.first), others_step_v))
        return true;
      trim(one, own, band);
      return is_cut_peak(one, own, band, usual_v);
    });
    if (held.empty())
      continue;
    std::size_t samples = 0;
    for (const StuckStretch &one : held) {
      leave_out(look, one.first, one.end);
      samples += one.end - one.first;
    }
    const double again_s = c.time_s[held.front().end];
    look.findings.push_back(
        {&effect,
         {static_cast<double>(k), c.time_s[held.front().first]},
         {0.0, median_step(c.time_s)},
         {},
         held.size() == 1
             ? fmt::format("It follows again from {:.6g} s on.", again_s)
             : fmt::format("It follows again from {:.6g} s on, and stops {} times, for {} samples "
                           "in all.",
                           again_s, held.size(), samples)});
    return true;
  }
  return false;
}

} // namespace

bool screen_stuck(Screened &look, const Effect &effect) {
  return screen_stuck_to_the_end(look, effect) || screen_stuck_for_a_while(look, effect);
}

} // namespace ada

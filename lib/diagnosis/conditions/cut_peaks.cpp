// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

//
// Peaks that are cut off at one level, as the readings alone show them: where much else is left
// over, no fit shows the few readings on it.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "base/robust.h"
#include "diagnosis/criteria.h"
#include "model/effect.h"
#include "model/residual.h"

namespace ada {

namespace {

/// One end of a channel.
struct Level {
  double value_v = 0.0, error_v = 0.0;
  std::vector<std::size_t> rows; ///< on it, ascending
};

/// What holds all readings of one level: its converter's step at the least, and at the most the
/// noise of the channel, of which a level that is cut after the noise has none.
struct Band {
  double least_v, most_v;
};

Band band_of(std::span<const double> v, std::span<const char> usable) {
  const double step = 1.5 * converter_step(v);
  return {step, std::max(step, 2.0 * criteria::kLevelNoise * noise_between(v, usable))};
}

/// A channel, whose readings times `sense` have their end at the top, and the other one, which goes
/// on while this one is on its level.
struct Channels {
  std::span<const double> own, other;
  std::span<const char> usable;
  double sense;
  Band band;
  double half_v, other_half_v; ///< of their ranges
  double top(std::size_t i) const { return sense * own[i]; }
};

struct End {
  double top_v, band_v;
};

/// The end of the readings, but for a few that may be spikes; nothing where no level is.
std::optional<End> end_on_level(const Channels &c) {
  std::vector<double> top;
  for (std::size_t i = 0; i < c.own.size(); ++i)
    if (c.usable[i])
      top.push_back(c.top(i));
  const auto most_spikes =
      static_cast<std::size_t>(criteria::kSpikesAboveLevel * static_cast<double>(top.size()));
  // A level that holds more than a quarter of them ends beyond what is looked at, which is as well.
  const auto quarter = top.begin() + static_cast<std::ptrdiff_t>(top.size() / 4);
  std::nth_element(top.begin(), quarter, top.end(), std::greater<>());
  top.erase(quarter, top.end());
  std::sort(top.begin(), top.end(), std::greater<>());
  const auto below = [&](double level) {
    return static_cast<double>(std::lower_bound(top.begin(), top.end(), level, std::greater<>()) -
                               top.begin());
  };
  for (double band = c.band.most_v; band >= c.band.least_v; band *= 0.5)
    for (std::size_t k = 0; k <= most_spikes && k < top.size(); ++k) {
      const double upper = below(top[k] - band) - static_cast<double>(k),
                   lower = below(top[k] - 2.0 * band) - static_cast<double>(k) - upper;
      if (upper >= criteria::kFewestOnLevel && upper > criteria::kOnLevel * lower)
        return End{top[k], band};
    }
  return {};
}

/// By how much a channel falls from its peak on both sides while the other one goes on by `way`, V,
/// on an ellipse, however long that takes.
double falls_on_circle(const Channels &c, double way_v) {
  const double part = std::min(1.0, 0.5 * way_v / c.other_half_v);
  return c.half_v * (1.0 - std::sqrt(1.0 - part * part));
}

std::optional<Level> level_of(const Channels &c) {
  const std::optional<End> end = end_on_level(c);
  if (!end)
    return {};
  const auto on = [&](std::size_t i) { return c.usable[i] && c.top(i) > end->top_v - end->band_v; };
  Level out;
  std::size_t peaks = 0, in_peaks = 0;
  for (std::size_t i = 0; i < c.own.size(); ++i) {
    if (!on(i))
      continue;
    const std::size_t from = i;
    std::size_t to = i;
    double low = c.other[i], high = low, step = 0.0;
    for (; to < c.own.size() && on(to); ++to) {
      out.rows.push_back(to);
      if (to > from)
        step = std::max(step, std::abs(c.other[to] - c.other[to - 1]));
      low = std::min(low, c.other[to]);
      high = std::max(high, c.other[to]);
    }
    // It comes from below and goes there again: a channel that is stuck, or jumps, does not, and
    // the other one does not jump meanwhile.
    const auto joins = [&](std::size_t k) {
      return end->top_v - c.top(k) < criteria::kJoins * c.half_v;
    };
    if (from > 0 && to < c.own.size() && joins(from - 1) && joins(to) &&
        to - from >= criteria::kFewestInPeak && step < criteria::kLargestStep * (high - low) &&
        falls_on_circle(c, high - low) > criteria::kCutBands * end->band_v) {
      ++peaks;
      in_peaks += to - from;
    }
    i = to - 1;
  }
  if (peaks < criteria::kFewestCutPeaks || 2 * in_peaks < out.rows.size())
    return {};
  std::vector<double> values;
  for (std::size_t i : out.rows)
    values.push_back(c.own[i]);
  out.value_v = quantile(values, 0.5);
  const double step = converter_step(c.own);
  out.error_v = std::hypot(robust_spread(values), step / std::sqrt(12.0)) /
                std::sqrt(static_cast<double>(values.size()));
  return out;
}

} // namespace

bool screen_cut_peaks(Screened &look, const Effect &effect) {
  const Capture &capture = look.capture;
  const std::span<const double> channels[] = {capture.vsin_v, capture.vcos_v};
  const Band bands[] = {band_of(channels[0], look.usable), band_of(channels[1], look.usable)};
  const double band = std::max(bands[0].most_v, bands[1].most_v);
  const double halves[] = {half_range(channels[0]), half_range(channels[1])};
  if (!(halves[0] > 0.0 && halves[1] > 0.0))
    return false;
  std::optional<Level> ends[2][2]; // of a channel: low, high
  for (std::size_t k : {0u, 1u})
    for (std::size_t high : {0u, 1u})
      ends[k][high] = level_of({channels[k], channels[1 - k], look.usable, high ? 1.0 : -1.0,
                                bands[k], halves[k], halves[1 - k]});
  // A level is that of both channels unless the other one passes it, or has one of its own.
  const auto of_both = [&](std::size_t k, std::size_t high) {
    const double sense = high ? 1.0 : -1.0;
    const double level = ends[k][high]->value_v;
    if (const auto &other = ends[1 - k][high])
      return std::abs(other->value_v - level) < band;
    std::size_t beyond = 0;
    for (std::size_t i = 0; i < capture.size(); ++i)
      beyond += look.usable[i] && sense * (channels[1 - k][i] - level) > band;
    return static_cast<double>(beyond) <=
           criteria::kSpikesAboveLevel * static_cast<double>(capture.size());
  };
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto find = [&](const std::optional<Level> &low, const std::optional<Level> &high,
                        double channel) {
    if (low || high)
      look.findings.push_back({&effect,
                               {low ? low->value_v : kNone, high ? high->value_v : kNone, channel},
                               {low ? low->error_v : 0.0, high ? high->error_v : 0.0, 0.0},
                               {},
                               {}});
  };
  bool both = true, any = false;
  for (std::size_t k : {0u, 1u})
    for (std::size_t high : {0u, 1u})
      if (ends[k][high]) {
        any = true;
        both = both && of_both(k, high);
        for (std::size_t i : ends[k][high]->rows)
          look.usable[i] = 0;
      }
  if (both)
    find(ends[0][0] ? ends[0][0] : ends[1][0], ends[0][1] ? ends[0][1] : ends[1][1], kNone);
  else
    for (std::size_t k : {0u, 1u})
      find(ends[k][0], ends[k][1], static_cast<double>(k));
  return any;
}

} // namespace ada

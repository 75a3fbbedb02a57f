// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/holdout.h"

#include <algorithm>
#include <cmath>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/conditions/travel.h"
#include "diagnosis/criteria.h"

namespace ada {

namespace {

/// Of all readings, those of stops in which several readings differ by no more than at rest: a
/// shaft that only turns slowly now and then creeps on in what looks like one stop.
double share_at_rest(std::span<const double> alpha, const std::vector<std::uint32_t> &of,
                     double moved) {
  std::size_t count = 0;
  for (std::size_t from = 0, to = 0; from < alpha.size(); from = to) {
    double low = alpha[from], high = alpha[from];
    for (to = from; to < alpha.size() && of[to] == of[from]; ++to) {
      low = std::min(low, alpha[to]);
      high = std::max(high, alpha[to]);
    }
    if (static_cast<double>(to - from) >= criteria::kFewestReadings && high - low <= moved)
      count += to - from;
  }
  return static_cast<double>(count) / static_cast<double>(alpha.size());
}

} // namespace

Stops find_stops(std::span<const double> alpha, double noise_rad) {
  Stops out;
  if (alpha.size() < 8)
    return out;
  // At rest neighbours differ by their noise; between stops by far more. Of few readings a stop
  // higher differences hold the moves; most neighbours are of one stop even then.
  constexpr double kAtRest = 0.4; // of the moves, by less than 0.74 times the noise
  std::vector<double> moves;
  for (std::size_t i = 1; i < alpha.size(); ++i)
    moves.push_back(std::abs(alpha[i] - alpha[i - 1]));
  const double noise = std::min(noise_rad, quantile(std::move(moves), kAtRest) / 0.74);
  const double moved = std::max(criteria::kStopMovesNoise * noise, criteria::kStopMovesRad);
  std::vector<std::uint32_t> of(alpha.size(), 0);
  std::uint32_t stop = 0;
  for (std::size_t i = 1; i < alpha.size(); ++i) {
    if (std::abs(alpha[i] - alpha[i - 1]) > moved)
      ++stop;
    of[i] = stop;
  }
  const double length = static_cast<double>(alpha.size()) / (stop + 1.0);
  if (stop + 1 < criteria::kFewestStops || length < criteria::kFewestReadings ||
      share_at_rest(alpha, of, moved) < criteria::kLeastAtRest)
    return out;
  out.of = std::move(of);
  out.count = stop + 1;
  return out;
}

Stops find_stops(const Capture &c, std::span<const double> reference_rad) {
  Stops stops = find_stops(reference_rad, noise_between(reference_rad));
  // From its first row to its last a shaft that goes on goes all of its way from row to row; noise
  // of three rows goes half of it, and of more rows less. What creeps on at a stop goes far less
  // from row to row than from stop to stop, and what arrives late moves in few of the rows.
  constexpr double kAllOfWay = 0.75, kMuchOfMove = 0.25, kInMostRows = 0.5;
  double in_most_v = 0.0, within_v = 0.0, apart_v = 0.0, rows = 0.0, between_v = 0.0, moves = 0.0;
  const auto way_v = [&](std::size_t a, std::size_t b) {
    const double v = std::hypot(c.vsin_v[a] - c.vsin_v[b], c.vcos_v[a] - c.vcos_v[b]);
    return std::isfinite(v) ? v : 0.0;
  };
  for (std::size_t from = 0, to = 0; stops && from < c.size(); from = to) {
    double way = 0.0;
    std::vector<double> steps_v;
    for (to = from + 1; to < c.size() && stops.of[to] == stops.of[from]; ++to)
      way += steps_v.emplace_back(way_v(to, to - 1));
    if (static_cast<double>(to - from) >= criteria::kFewestReadings) {
      within_v += way;
      apart_v += way_v(to - 1, from);
      in_most_v += quantile(std::move(steps_v), 0.5) * static_cast<double>(to - from - 1);
      rows += static_cast<double>(to - from - 1);
    }
    if (to < c.size()) {
      between_v += way_v(to, to - 1);
      moves += 1.0;
    }
  }
  const bool goes_on = apart_v > kAllOfWay * within_v && in_most_v > kInMostRows * apart_v &&
                       within_v * moves > kMuchOfMove * between_v * rows;
  return goes_on ? Stops{} : std::move(stops);
}

Holdout hold_out(std::span<const double> alpha, int periods, const Stops &stops) {
  Holdout out;
  const double turns = travel_of(alpha) / kTwoPi;
  out.unit = stops                                              ? HoldoutUnit::stops
             : turns >= criteria::kFewestUnits                  ? HoldoutUnit::turns
             : turns * periods >= 2.0 * criteria::kFewestUnits ? HoldoutUnit::periods
                                                                : HoldoutUnit::arcs;
  const double unit_rad = out.unit == HoldoutUnit::turns ? kTwoPi : kTwoPi / periods;
  const std::size_t run = std::max<std::size_t>(1, alpha.size() / criteria::kArcs);
  Travel way(noise_between(alpha));
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    const double travel = way.to(alpha[i]);
    const std::size_t number = out.unit == HoldoutUnit::stops  ? stops.of[i]
                               : out.unit == HoldoutUnit::arcs ? i / run
                                                               : static_cast<std::size_t>(travel / unit_rad);
    // Another third of the periods in each turn, so that each of them is in either part.
    const std::size_t shift = out.unit == HoldoutUnit::periods && periods % 3 == 0
                                  ? static_cast<std::size_t>(travel / kTwoPi)
                                  : 0;
    ((number + shift) % 3 == 1 ? out.heldout : out.train).push_back(static_cast<std::uint32_t>(i));
  }
  for (auto *rows : {&out.train, &out.heldout}) // they stay for as long as the diagnosis
    rows->shrink_to_fit();
  return out;
}

} // namespace ada

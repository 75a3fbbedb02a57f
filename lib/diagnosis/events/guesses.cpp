// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/angle.h"
#include "base/pick.h"
#include "base/robust.h"
#include "diagnosis/criteria.h"
#include "diagnosis/events/edges.h"
#include "diagnosis/lines/rounds.h"
#include "model/residual.h"
#include "motion/kinematics.h"

namespace ada {

namespace {

constexpr double kAbsentLevel = std::numeric_limits<double>::quiet_NaN();

/// Tangential part of the residual as a mechanical angle, rad.
double angle_residual(const Residual &r, std::size_t i) {
  const double c = r.model_cos_v[i] - r.centre_cos_v, s = r.model_sin_v[i] - r.centre_sin_v;
  const double radius2 = std::max(c * c + s * s, 1e-12);
  return (r.sin_v[i] * c - r.cos_v[i] * s) / (radius2 * r.periods);
}

/// Where the mean changes most between a short stretch before and one after, all in one sense of
/// rotation: what depends on speed or sense changes there too and is no step. 0: nowhere clearly.
std::size_t sudden_step(const Residual &r, const std::vector<double> &a,
                        const std::vector<double> &b) {
  // A round at least, so that what repeats with the angle cancels.
  const std::size_t n = r.time.size();
  const auto reach = static_cast<std::size_t>(static_cast<double>(n) /
                                              std::clamp(rounds_of(r), kFewestRounds, 25.0));
  std::vector<std::size_t> turned(n + 1, 0); // changes of sense so far
  for (std::size_t i = 1; i < n; ++i)
    turned[i + 1] = turned[i] + (r.sense[i] != r.sense[i - 1]);
  double best = 0.0;
  std::size_t at = 0;
  std::vector<double> sizes;
  for (std::size_t k = reach; k + reach <= n; ++k) {
    const auto change = [&](const std::vector<double> &sum) {
      return (sum[k + reach] - 2.0 * sum[k] + sum[k - reach]) / static_cast<double>(reach);
    };
    const double size = std::hypot(change(a), change(b));
    sizes.push_back(size);
    if (size > best && turned[k + reach] == turned[k - reach + 1]) {
      best = size;
      at = k;
    }
  }
  return best > 6.0 * quantile(std::move(sizes), 0.5) ? at : 0;
}

/// The split with the largest sum of squares between the means of both parts. 0: none.
std::size_t largest_split(const std::vector<double> &a, const std::vector<double> &b) {
  const std::size_t n = a.size() - 1, margin = std::max<std::size_t>(20, n / 200);
  double best = 0.0;
  std::size_t at = 0;
  for (std::size_t k = margin; k + margin <= n; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(n);
    const double da = a[k] - share * a[n], db = b[k] - share * b[n];
    const double gain = (da * da + db * db) / (share * (1.0 - share));
    if (gain > best) {
      best = gain;
      at = k;
    }
  }
  return at;
}

} // namespace

std::vector<StepGuess> find_steps(const Residual &r, StepIn where) {
  const std::size_t n = r.time.size();
  constexpr std::size_t kFewest = 40; // twice the margin of a split
  if (n < kFewest)
    return {};
  std::vector<double> of_a(n), of_b(n);
  for (std::size_t i = 0; i < n; ++i) {
    of_a[i] = where == StepIn::angle ? angle_residual(r, i) : r.sin_v[i];
    of_b[i] = where == StepIn::angle ? 0.0 : r.cos_v[i];
  }
  constexpr std::size_t kMostEdges = 2;
  std::vector<StepGuess> out;
  const double rounds = rounds_of(r);
  const std::size_t reach = reach_of_edges(n, rounds, r.periods);
  if (rounds < criteria::kFewestUnits)
    for (const Edge &edge : find_edges(r.time, of_a, of_b, r.sense, reach, kMostEdges))
      out.push_back({r.time[edge.at], edge.first, edge.second});
  // Of rows so far apart that no edge shows, the means of two parts may still tell, where the
  // motion is not the pair's own.
  if (rounds < kFewestRounds && !(r.has_reference && reach == kFewestOfEdge))
    return out;
  // Running sums of both components.
  std::vector<double> a(n + 1, 0.0), b(n + 1, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    a[i + 1] = a[i] + of_a[i];
    b[i + 1] = b[i] + of_b[i];
  }
  const std::size_t sudden = rounds < kFewestRounds ? 0 : sudden_step(r, a, b);
  for (std::size_t at : {sudden, largest_split(a, b)}) {
    if (at == 0)
      continue;
    const double left = static_cast<double>(at), right = static_cast<double>(n - at);
    out.push_back(
        {r.time[at], (a[n] - a[at]) / right - a[at] / left, (b[n] - b[at]) / right - b[at] / left});
  }
  return out;
}

std::vector<std::vector<double>> find_clipping(const Residual &r) {
  // Of a sine that stops at 90 to 97 % of its peak about a tenth lies on the stop: the level is
  // seen at its middle. The channel with the higher peak says it for both.
  const auto quantiles = [&](double at) {
    return std::array<double, 2>{
        quantile(std::vector(r.read_sin_v.begin(), r.read_sin_v.end()), at),
        quantile(std::vector(r.read_cos_v.begin(), r.read_cos_v.end()), at)};
  };
  const std::array low = quantiles(0.04), high = quantiles(0.96);
  std::vector<std::vector<double>> out;
  const auto add = [&](double bottom, double top, double channel) {
    out.push_back({kAbsentLevel, top, channel});
    out.push_back({bottom, kAbsentLevel, channel});
    out.push_back({bottom, top, channel});
  };
  add(std::min(low[0], low[1]), std::max(high[0], high[1]), kAbsentLevel);
  for (int k : {0, 1})
    add(low[static_cast<std::size_t>(k)], high[static_cast<std::size_t>(k)], k);
  return out;
}

void find_spikes(std::span<const double> residual, double threshold, double floor_v,
                 std::vector<std::size_t> &places) {
  places = standing_out(residual, threshold, floor_v);
}

double slowest_speed(const Residual &r) {
  return r.slowest.get(
      [&] { return r.has_reference ? 0.0 : slowest_of_range(as_doubles(r.omega)); });
}

} // namespace ada

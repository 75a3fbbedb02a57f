// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/events/white_noise.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "base/angle.h"
#include "base/robust.h"
#include "base/solve.h"
#include "diagnosis/criteria.h"

namespace ada {

namespace {

/// Differences of both channels of one order, at each sample, where all samples they reach over are
/// of use at both ends.
struct Differences {
  std::vector<double> sin, cos;
  std::vector<std::size_t> middle; ///< the sample that each is about
};

/// `order`: of the samples; empty: as they are.
Differences differences(const Screened &look, const std::vector<std::size_t> &order,
                        const std::vector<double> &weights) {
  const std::size_t reach = weights.size() - 1;
  double norm2 = 0.0;
  for (double w : weights)
    norm2 += w * w;
  const auto sample = [&](std::size_t i) { return order.empty() ? i : order[i]; };
  const std::size_t n = order.empty() ? look.usable.size() : order.size();
  // Of a long record every so many stretches: a median of a hundred thousand is known to 0.4 %.
  const std::size_t every = (n + criteria::kNoiseRows - 1) / criteria::kNoiseRows;
  constexpr std::size_t kStretch = 1024;
  Differences out;
  for (std::size_t i = reach; i < n; ++i) {
    if (i / kStretch % every != 0) {
      i += kStretch - i % kStretch - 1;
      continue;
    }
    if (!look.usable[sample(i)] || !look.usable[sample(i - reach)])
      continue;
    double sin = 0.0, cos = 0.0;
    for (std::size_t k = 0; k <= reach; ++k) {
      sin += weights[k] * look.capture.vsin_v[sample(i - k)];
      cos += weights[k] * look.capture.vcos_v[sample(i - k)];
    }
    out.sin.push_back(sin / std::sqrt(norm2));
    out.cos.push_back(cos / std::sqrt(norm2));
    out.middle.push_back(sample(i - reach / 2));
  }
  return out;
}

/// What an ellipse over the angle of the reference leaves of each sample, with parabolas of the
/// time and of VTEMP for its numbers: no noise is larger, however unevenly the rows come, of which
/// differences would hold the motion.
Differences beside_reference(const Screened &look) {
  const Capture &c = look.capture;
  Differences out;
  const std::size_t every = c.size() / criteria::kNoiseRows + 1;
  for (std::size_t i = 0; i < c.size(); i += every)
    if (look.usable[i] && std::isfinite(c.reference_deg[i]))
      out.middle.push_back(i);
  const auto n = static_cast<Eigen::Index>(out.middle.size());
  if (n < static_cast<Eigen::Index>(criteria::kFewestSamples))
    return {};
  constexpr Eigen::Index kRowsOfColumn = 10; // by which it is told
  constexpr double kLittleNoise = 0.1;       // of half the range: a hundredth of the power
  std::vector<std::function<double(std::size_t)>> slow;
  const auto add_slow = [&](const std::vector<double> &of) {
    const double low = quantile(of, 0.02), half = 0.5 * (quantile(of, 0.98) - low);
    // What scatters from row to row could take noise with it that is the pair's as well.
    if (!(half > 0.0) || !std::isfinite(half) || noise_between(of) > kLittleNoise * half ||
        n < kRowsOfColumn * 3 * static_cast<Eigen::Index>(slow.size() + 3))
      return;
    for (const bool square : {false, true})
      slow.push_back([&of, low, half, square](std::size_t i) {
        const double x = std::isfinite(of[i]) ? (of[i] - low) / half - 1.0 : 0.0;
        return square ? x * x : x;
      });
  };
  add_slow(c.time_s);
  if (c.has_vtemp())
    add_slow(c.vtemp_v);
  Eigen::MatrixXd circle(n, static_cast<Eigen::Index>(3 * (slow.size() + 1))), pair(n, 2);
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::size_t i = out.middle[static_cast<std::size_t>(k)];
    const double psi = c.meta.periods_per_turn * kRadPerDeg * c.reference_deg[i];
    const Eigen::RowVector3d at(1.0, std::cos(psi), std::sin(psi));
    circle.row(k).head<3>() = at;
    for (std::size_t f = 0; f < slow.size(); ++f)
      circle.row(k).segment<3>(static_cast<Eigen::Index>(3 * (f + 1))) = slow[f](i) * at;
    pair.row(k) << c.vsin_v[i], c.vcos_v[i];
  }
  const Eigen::MatrixXd rest =
      pair - circle * solved(circle.transpose() * circle, circle.transpose() * pair);
  out.sin.assign(rest.col(0).begin(), rest.col(0).end());
  out.cos.assign(rest.col(1).begin(), rest.col(1).end());
  return out;
}

/// Whether half of the rows come so unevenly that differences over rows hold the motion.
bool comes_unevenly(const std::vector<double> &time) {
  constexpr double kUneven = 0.05; // of the usual step
  const double usual = median_step(time);
  std::vector<double> off;
  for (std::size_t i = 1; i < time.size(); ++i)
    off.push_back(std::abs(time[i] - time[i - 1] - usual));
  return !off.empty() && quantile(std::move(off), 0.5) > kUneven * usual;
}

/// The samples in the order of their places in the turn, where the shaft turns so far from one
/// sample to the next, or without a reference the rows come so unevenly, that the pair's
/// differences are signal; empty elsewhere. The place is the pair's own, or that of the reference.
std::vector<std::size_t> by_place_in_turn(const Screened &look, bool own) {
  constexpr double kFar = 0.35; // rad, electrical: beyond it the differences hold much of a turn
  const Capture &c = look.capture;
  std::vector<double> place_rad(c.size());
  for (std::size_t i = 0; i < c.size(); ++i)
    place_rad[i] =
        !own ? c.meta.periods_per_turn * kRadPerDeg * c.reference_deg[i]
             : std::atan2(c.vsin_v[i] - look.centre_sin_v, c.vcos_v[i] - look.centre_cos_v);
  const double round = !own ? c.meta.periods_per_turn * kTwoPi : kTwoPi;
  std::vector<double> steps;
  for (std::size_t i = 1; i < c.size(); ++i)
    steps.push_back(std::abs(wrap_centred(place_rad[i] - place_rad[i - 1], round)));
  if (quantile(std::move(steps), 0.5) < kFar && !(own && comes_unevenly(c.time_s)))
    return {};
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < c.size(); ++i) {
    place_rad[i] = wrap(place_rad[i], round);
    if (look.usable[i])
      order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return place_rad[a] < place_rad[b]; });
  return order;
}

} // namespace

double white_noise(const Screened &look) {
  const auto scale = [](std::vector<double> x) {
    for (double &v : x)
      v = std::abs(v);
    return kSigmasOfMedian * quantile(std::move(x), 0.5);
  };
  std::array<double, 4> least;
  least.fill(std::numeric_limits<double>::infinity());
  const auto scales_of = [&](const Differences &d) {
    std::vector<double> along, across;
    for (std::size_t i = 0; i < d.middle.size(); ++i) {
      const double s = look.capture.vsin_v[d.middle[i]] - look.centre_sin_v;
      const double c = look.capture.vcos_v[d.middle[i]] - look.centre_cos_v;
      const double length = std::max(std::hypot(s, c), 1e-12);
      along.push_back((d.sin[i] * s + d.cos[i] * c) / length);
      across.push_back((d.sin[i] * c - d.cos[i] * s) / length);
    }
    return std::array{scale(d.sin), scale(d.cos), scale(std::move(along)),
                      scale(std::move(across))};
  };
  const auto take = [&](const std::vector<std::size_t> &order, const std::vector<double> &weights) {
    const Differences d = differences(look, order, weights);
    if (d.middle.empty())
      return;
    const std::array now = scales_of(d);
    for (std::size_t k = 0; k < least.size(); ++k)
      if (now[k] > 0.0 || weights.size() > 3)
        least[k] = std::min(least[k], now[k]);
  };
  const std::vector<double> first{1, -1}, second{1, -2, 1}, third{1, -3, 3, -1};
  for (const std::vector<double> &weights :
       {first, second, third, std::vector<double>{1, -5, 10, -10, 5, -1},
        std::vector<double>{1, -7, 21, -35, 35, -21, 7, -1}, std::vector<double>{1, 0, -2, 0, 1},
        std::vector<double>{1, 0, -3, 0, 3, 0, -1},
        std::vector<double>{1, 0, -5, 0, 10, 0, -10, 0, 5, 0, -1}})
    take({}, weights);
  const std::array in_time = least;
  const bool has_reference = look.capture.has_reference();
  const std::vector<std::size_t> order = by_place_in_turn(look, !has_reference);
  if (!order.empty())
    for (const std::vector<double> &weights : {first, second, third})
      take(order, weights);
  // At neighbouring angles of the pair's own only what lies along the vector differs.
  double along_v = least[2];
  bool by_own_place = !order.empty() && !has_reference;
  if (by_own_place)
    least = in_time;
  // Where the ellipse leaves about as much, differences tell it without what goes slowly.
  constexpr double kFarLess = 0.7;
  if (has_reference)
    if (const Differences d = beside_reference(look); !d.middle.empty())
      if (const std::array now = scales_of(d);
          std::min(now[0], now[1]) > 0.0 &&
          std::hypot(now[0], now[1]) < kFarLess * std::hypot(least[0], least[1]))
        least = now;
  // A reference that counts in steps, or errs, leaves more than the noise as well.
  if (has_reference && comes_unevenly(look.capture.time_s)) {
    const std::vector<std::size_t> own = by_place_in_turn(look, true);
    along_v = std::numeric_limits<double>::infinity();
    for (const std::vector<double> &weights : {first, second, third})
      if (const Differences d = differences(look, own, weights); !own.empty() && !d.middle.empty())
        if (const double now = scales_of(d)[2]; now > 0.0)
          along_v = std::min(along_v, now);
    by_own_place = along_v < std::numeric_limits<double>::infinity();
  }
  // The median of |x y| with x normal and y a sine is 0.745 of what its rms would have it: noise in
  // one direction can look that much less, and where the vector has more it has moved.
  constexpr double kMostHidden = 1.0 / 0.745,
                   kOfMedian = 1.03; // the latter: a median's own scatter
  const double channels = std::hypot(least[0], least[1]), vector = std::hypot(least[2], least[3]);
  const bool of_noise = vector < kOfMedian * kMostHidden * channels;
  if (by_own_place && channels / std::numbers::sqrt2 > kOfMedian * kMostHidden * along_v)
    return along_v; // from one row to the next the pair moves
  return least[0] < std::numeric_limits<double>::infinity()
             ? std::max(channels, of_noise ? vector : 0.0) / std::numbers::sqrt2
             : 0.0;
}

} // namespace ada

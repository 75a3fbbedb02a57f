// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/angle_path.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/angle.h"
#include "base/error.h"
#include "base/robust.h"

namespace ada {

namespace {

/// A step longer than this may as well have gone the other way round.
constexpr double kMaxStep = 0.8 * kPi;
/// Steps across a gap are allowed to be long; more of them than this means too high a speed.
constexpr double kMaxAmbiguous = 0.01;

/// A longer row that was left out is no spike, and the speed may be another after it.
constexpr std::size_t kMissedSamples = 4;

/// Of noise alone next to nothing leaps so far, and what does is a sample less.
constexpr double kLeapSigmas = kOutlierSigmas;

/// Whether a sample lies on the line through two that were kept, of the samples that were left out
/// between them none the less: what a steady acceleration puts it off by grows with the square of
/// the way.
bool goes_on_from(const AnglePath &path, std::size_t first, std::size_t second, std::size_t i,
                  double limit) {
  const auto place = [&](std::size_t k) { return static_cast<double>(path.sample[k]); };
  const double steps = (place(i) - place(second)) / (place(second) - place(first));
  const double expected = path.psi[second] + steps * (path.psi[second] - path.psi[first]);
  const double way = std::abs(place(i) - place(second));
  return std::abs(wrap_centred(path.psi[i] - expected, kTwoPi)) <= limit * way * (way + 1) / 2;
}

/// Samples of `path` that leap are left out. Beside samples that are left out already the steps are
/// longer, which is no leap.
std::vector<std::size_t> without_leaps(const AnglePath &path) {
  std::vector<std::size_t> kept = path.sample;
  const double limit = leap_limit(path.psi, kLeapSigmas, 0);
  std::vector<std::size_t> places = leaps_beyond(path.psi, limit, 0);
  if (places.size() > path.psi.size() / kRareSample)
    return kept;
  std::erase_if(places, [&](std::size_t i) {
    return i >= 2 && i + 2 < path.psi.size() && path.sample[i + 2] - path.sample[i - 2] > 4 &&
           (goes_on_from(path, i - 2, i - 1, i, limit) ||
            goes_on_from(path, i + 2, i + 1, i, limit));
  });
  for (auto place = places.rbegin(); place != places.rend(); ++place)
    kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(*place));
  return kept;
}

} // namespace

namespace {

double turn(std::span<const double> psi, std::size_t from, std::size_t to) {
  return wrap_centred(psi[to] - psi[from], kTwoPi);
}

/// Distance of an angle from the middle of its neighbours.
double off_middle(std::span<const double> psi, std::size_t i) {
  return wrap_centred(turn(psi, i - 1, i) - 0.5 * turn(psi, i - 1, i + 1), kTwoPi);
}

/// The same in a few operations, of angles of one turn; not a number where steps are long.
double off_middle_of_short_steps(std::span<const double> psi, std::size_t i) {
  const auto step = [](double d) { return d - (d > kPi ? kTwoPi : d < -kPi ? -kTwoPi : 0.0); };
  const double to = step(psi[i] - psi[i - 1]), from = step(psi[i + 1] - psi[i]);
  return std::abs(to) < 0.5 * kPi && std::abs(from) < 0.5 * kPi ? 0.5 * (to - from) : NAN;
}

} // namespace

double leap_limit(std::span<const double> psi, double sigmas, double floor_rad) {
  std::vector<double> between(psi.size(), 0.0);
  for (std::size_t i = 1; i + 1 < psi.size(); ++i)
    between[i] = off_middle(psi, i);
  const double noise_reaches = sigmas * std::max(robust_spread(between), floor_rad);
  return std::max(noise_reaches, gap_beyond_bulk(std::move(between)));
}

std::vector<std::size_t> leaps_beyond(std::span<const double> psi, double limit, double ways) {
  // From the line through two angles, one step on from the second.
  const auto beyond = [&](std::size_t first, std::size_t second, std::size_t i, double steps = 1) {
    return std::abs(wrap_centred(psi[i] - psi[second] - steps * turn(psi, first, second), kTwoPi));
  };
  std::vector<std::size_t> places;
  // At an end there are the neighbours on one side only. Of white noise the lines from there miss
  // by two to three times what the middle does: the limit is twice as far.
  const auto at_end = [&](std::size_t i, std::size_t a, std::size_t b, std::size_t c) {
    const double least = std::min(beyond(b, a, i), beyond(c, b, i, 2));
    const double way = std::max(std::abs(turn(psi, a, b)), std::abs(turn(psi, b, c)));
    return least > 2 * limit && least > ways * way;
  };
  const auto beside_end = [&](std::size_t i, std::size_t end, std::size_t a, std::size_t b) {
    const double middle =
        std::abs(wrap_centred(turn(psi, end, i) - 0.5 * turn(psi, end, a), kTwoPi));
    const double least = std::min(beyond(b, a, i), middle);
    const double way = std::max(std::abs(turn(psi, a, b)), std::abs(turn(psi, end, a)));
    return least > limit && least > ways * way;
  };
  const std::size_t n = psi.size();
  if (n >= 4 && at_end(0, 1, 2, 3))
    places.push_back(0);
  if (n >= 4 && beside_end(1, 0, 2, 3))
    places.push_back(1);
  for (std::size_t i = 2; i + 2 < psi.size(); ++i) {
    if (std::abs(off_middle_of_short_steps(psi, i)) <= limit)
      continue;
    const double least =
        std::min({beyond(i - 2, i - 1, i), beyond(i + 2, i + 1, i), std::abs(off_middle(psi, i))});
    const double way =
        std::max({std::abs(turn(psi, i - 2, i - 1)), std::abs(turn(psi, i + 1, i + 2)),
                  std::abs(turn(psi, i - 1, i + 1))});
    if (least > limit && least > ways * way)
      places.push_back(i);
  }
  if (n >= 6 && beside_end(n - 2, n - 1, n - 3, n - 4))
    places.push_back(n - 2);
  if (n >= 6 && at_end(n - 1, n - 2, n - 3, n - 4))
    places.push_back(n - 1);
  return places;
}

std::vector<std::size_t> leaps(std::span<const double> psi, double sigmas, double floor_rad,
                               double ways) {
  std::vector<std::size_t> places = leaps_beyond(psi, leap_limit(psi, sigmas, floor_rad), ways);
  return places.size() > psi.size() / kRareSample ? std::vector<std::size_t>() : places;
}

AnglePath path_of(const Capture &capture, std::vector<std::size_t> samples,
                  const EllipseParameters &ellipse) {
  const EllipseInverse inverse = invert(ellipse);
  AnglePath path;
  path.sample = std::move(samples);
  path.psi.reserve(path.sample.size());
  double speed = 0; // rad a sample, of the last step between neighbours
  for (std::size_t k = 0; k < path.sample.size(); ++k) {
    const std::size_t i = path.sample[k];
    const double psi = std::atan2(inverse.sine(capture.vsin_v[i], capture.vcos_v[i]),
                                  inverse.cosine(capture.vsin_v[i], capture.vcos_v[i]));
    if (k == 0) {
      path.psi.push_back(psi);
      continue;
    }
    const std::size_t on = i - path.sample[k - 1];
    const double expected =
        on > 1 && on <= kMissedSamples + 1 ? speed * static_cast<double>(on) : 0.0;
    const double step = expected + wrap_centred(psi - path.psi.back() - expected, kTwoPi);
    path.psi.push_back(path.psi.back() + step);
    if (on == 1)
      speed = step;
  }
  return path;
}

AnglePath unwrap(const Capture &capture, const EllipseFit &fit) {
  std::vector<std::size_t> samples;
  samples.reserve(fit.used);
  for (std::size_t i = 0; i < capture.size(); ++i)
    if (fit.accepted[i])
      samples.push_back(i);
  AnglePath path = path_of(capture, std::move(samples), fit.value);
  path = path_of(capture, without_leaps(path), fit.value);
  std::size_t ambiguous = 0;
  for (std::size_t k = 1; k < path.psi.size(); ++k)
    ambiguous += std::abs(path.psi[k] - path.psi[k - 1]) > kMaxStep;
  if (static_cast<double>(ambiguous) > kMaxAmbiguous * static_cast<double>(path.psi.size()))
    throw Error(ADA4571_ERROR_UNUSABLE_DATA,
                "fewer than about three samples an electrical period: turns cannot be counted; "
                "turn more slowly, or use the method fit");
  return path;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "health/spikes.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/angle.h"
#include "base/robust.h"
#include "health/criteria.h"

namespace ada::health {

namespace {

/// Sigmas that noise alone does not reach.
double threshold(std::size_t samples) {
  return std::sqrt(2 * std::log(static_cast<double>(samples) / kFalseSpikes));
}

/// Of white noise, the differences from the median of seven have 0.82 of its sigma by their own
/// median (one value in seven is the median and has none), but tails as of 1.1: noise plus the
/// median's own.
constexpr double kTailOverSpread = 1.1 / 0.82;

std::vector<std::size_t> alone(std::span<const double> x, double floor_v) {
  return standing_out(x, kTailOverSpread * threshold(x.size()), floor_v);
}

std::vector<std::size_t> both(const std::vector<std::size_t> &a,
                              const std::vector<std::size_t> &b) {
  std::vector<std::size_t> out;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(out));
  return out;
}

/// Distance from the ellipse and way along it, in volts.
struct Polar {
  std::vector<double> off_v, along_v;
};

Polar polar(const Capture &capture, const EllipseParameters &ellipse) {
  const EllipseInverse inverse = invert(ellipse);
  Polar p;
  p.off_v.reserve(capture.size());
  p.along_v.reserve(capture.size());
  double last = 0;
  for (std::size_t i = 0; i < capture.size(); ++i) {
    const double y = inverse.sine(capture.vsin_v[i], capture.vcos_v[i]);
    const double x = inverse.cosine(capture.vsin_v[i], capture.vcos_v[i]);
    const double psi = std::atan2(y, x);
    if (std::isfinite(psi))
      last += wrap_centred(psi - last, kTwoPi);
    p.off_v.push_back(ellipse.amplitude_v * (std::hypot(x, y) - 1));
    p.along_v.push_back(ellipse.amplitude_v * last);
  }
  return p;
}

/// Values that lie far from where their neighbours lead: from the lines through the two before
/// them, the two after them, and the two about them, so that neither a reversal nor a gap counts;
/// and farther than twice the way that the neighbours move by themselves, since a clock that
/// scatters does as much. What is not rare is no spike (base/robust.h).
std::vector<std::size_t> away_and_back(const std::vector<double> &x, double floor_v) {
  constexpr std::size_t kRare = 60;
  const auto step = [&x](std::size_t i) { return x[i] - x[i - 1]; };
  std::vector<double> between(x.size(), 0.0);
  for (std::size_t i = 1; i + 1 < x.size(); ++i)
    between[i] = 0.5 * (step(i) - step(i + 1));
  const double limit = threshold(x.size()) * std::max(robust_spread(between), floor_v);
  std::vector<std::size_t> places;
  for (std::size_t i = 2; i + 2 < x.size(); ++i) {
    const double least = std::min({std::abs(step(i) - step(i - 1)),
                                   std::abs(step(i + 1) - step(i + 2)), std::abs(between[i])});
    const double way =
        std::max({std::abs(step(i - 1)), std::abs(step(i + 2)), std::abs(x[i + 1] - x[i - 1])});
    if (least > limit && least > 2 * way)
      places.push_back(i);
  }
  return places.size() > x.size() / kRare ? std::vector<std::size_t>() : places;
}

} // namespace

std::vector<std::size_t> column_spikes(std::span<const double> column) {
  return alone(column, converter_step({column.begin(), column.end()}));
}

std::vector<std::size_t> pair_spikes(const Capture &capture,
                                     const std::optional<EllipseFit> &ellipse) {
  if (!ellipse)
    return both(column_spikes(capture.vsin_v), column_spikes(capture.vcos_v));
  const double floor_v =
      std::max(converter_step(capture.vsin_v), converter_step(capture.vcos_v)) / std::sqrt(12.0);
  const Polar p = polar(capture, ellipse->value);
  const std::vector<std::size_t> off = alone(p.off_v, floor_v);
  std::vector<std::size_t> along = away_and_back(p.along_v, floor_v);
  std::erase_if(along, [&off](std::size_t i) { // a spike beside it leads nowhere
    const auto near = std::lower_bound(off.begin(), off.end(), i >= 2 ? i - 2 : 0);
    return near != off.end() && *near <= i + 2;
  });
  return both(off, along);
}

} // namespace ada::health

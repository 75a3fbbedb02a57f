// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "health/spikes.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/robust.h"
#include "calibration/angle_path.h"
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

/// Distance from the ellipse in volts, and the angle about it in rad.
struct Polar {
  std::vector<double> off_v, psi;
};

Polar polar(const Capture &capture, const EllipseParameters &ellipse) {
  const EllipseInverse inverse = invert(ellipse);
  Polar p;
  p.off_v.reserve(capture.size());
  p.psi.reserve(capture.size());
  double last = 0;
  for (std::size_t i = 0; i < capture.size(); ++i) {
    const double y = inverse.sine(capture.vsin_v[i], capture.vcos_v[i]);
    const double x = inverse.cosine(capture.vsin_v[i], capture.vcos_v[i]);
    p.off_v.push_back(ellipse.amplitude_v * (std::hypot(x, y) - 1));
    const double psi = std::atan2(y, x);
    if (std::isfinite(psi))
      last = psi;
    p.psi.push_back(last);
  }
  return p;
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
  constexpr double kWays = 2; // a clock that scatters moves a sample by as much
  std::vector<std::size_t> along =
      leaps(p.psi, threshold(p.psi.size()), floor_v / ellipse->value.amplitude_v, kWays);
  std::erase_if(along, [&off](std::size_t i) { // a spike beside it leads nowhere
    const auto near = std::lower_bound(off.begin(), off.end(), i >= 2 ? i - 2 : 0);
    return near != off.end() && *near <= i + 2;
  });
  return both(off, along);
}

} // namespace ada::health

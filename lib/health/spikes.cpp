// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "health/spikes.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/angle.h"
#include "base/robust.h"
#include "calibration/angle_path.h"
#include "conversion/vector_kernels.h"
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

/// Distance from the ellipse in volts, and the angle about it in rad.
struct Polar {
  std::vector<double> off_v, psi;
};

Polar polar(const Capture &capture, const EllipseParameters &ellipse) {
  const EllipseInverse e = invert(ellipse);
  Polar p;
  p.off_v.resize(capture.size());
  p.psi.resize(capture.size());
  convert_planar_f64(capture.vsin_v.data(), capture.vcos_v.data(), capture.size(),
                     {e.centre_sin_v, e.centre_cos_v, e.sin_from_sin, e.sin_from_cos, 0,
                      e.cos_from_sin, e.cos_from_cos, 0, kTwoPi},
                     p.psi.data(), p.off_v.data());
  double last = 0;
  for (std::size_t i = 0; i < capture.size(); ++i) {
    p.off_v[i] = ellipse.amplitude_v * (p.off_v[i] - 1);
    last = p.psi[i] = std::isfinite(p.psi[i]) ? p.psi[i] : last;
  }
  return p;
}

/// What a column may differ from its median of seven by: noise, as the differences show it, and
/// where the column moves by more from sample to sample than that, so that most samples are their
/// own median, as its third differences show it. In steps either is known to half a step.
double noise_limit(const std::vector<double> &column, double sigmas, double step) {
  if (column.empty())
    return 0.0;
  const double reached = kTailOverSpread * sigmas;
  return std::max(standing_out_limit(column, reached, step), reached * noise_between(column)) +
         reached * kSigmasOfMedian * 0.5 * step;
}

/// Farther from zero than a limit, and from what the column is about there.
bool far_off(const std::vector<double> &off, std::size_t i, double limit) {
  if (!(std::abs(off[i]) > limit))
    return false;
  const std::size_t window = std::min(off.size(), 2 * kFarReach + 1);
  const std::size_t first = std::min(i > kFarReach ? i - kFarReach : 0, off.size() - window);
  const auto begin = off.begin() + static_cast<std::ptrdiff_t>(first);
  const double about =
      quantile(std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(window)), 0.5);
  return std::abs(off[i] - about) > limit;
}

template <class Test> std::vector<std::size_t> places_where(std::size_t count, Test test) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < count; ++i)
    if (test(i))
      places.push_back(i);
  return places;
}

std::vector<std::size_t> united(const std::vector<std::size_t> &a,
                                const std::vector<std::size_t> &b) {
  std::vector<std::size_t> out;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(out));
  return out;
}

} // namespace

bool beyond_supply(double volts, double supply_v) {
  return volts < -kRangeMargin * supply_v || volts > (1 + kRangeMargin) * supply_v;
}

SpikeFinder::SpikeFinder(const Capture &sample, std::size_t samples,
                         const std::optional<EllipseFit> &ellipse)
    : samples_(samples) {
  vtemp_limit_v_ = column_limit(sample.vtemp_v);
  vdd_limit_v_ = column_limit(sample.vdd_v);
  if (!ellipse) {
    sin_limit_v_ = column_limit(sample.vsin_v);
    cos_limit_v_ = column_limit(sample.vcos_v);
    far_is_wrong_ = !beyond_supply(quantile(sample.vsin_v, 0.5), sample.meta.supply_v) &&
                    !beyond_supply(quantile(sample.vcos_v, 0.5), sample.meta.supply_v);
    return;
  }
  ellipse_ = ellipse->value;
  const double floor_v =
      std::max(converter_step(sample.vsin_v), converter_step(sample.vcos_v)) / std::sqrt(12.0);
  const Polar p = polar(sample, *ellipse_);
  off_limit_v_ = noise_limit(p.off_v, threshold(samples), floor_v);
  along_limit_rad_ = leap_limit(p.psi, threshold(samples), floor_v / ellipse_->amplitude_v);
  far_limit_v_ = std::max(kFarOff * ellipse_->amplitude_v,
                          kTailOverSpread * threshold(samples) * robust_spread(p.off_v));
}

double SpikeFinder::column_limit(const std::vector<double> &column) const {
  return noise_limit(column, threshold(samples_), converter_step(column));
}

PairPlaces SpikeFinder::pair(const Capture &stretch) const {
  if (!ellipse_)
    return {beyond_median(stretch.vsin_v, sin_limit_v_),
            beyond_median(stretch.vcos_v, cos_limit_v_),
            places_where(stretch.size(), [&](std::size_t i) {
              return beyond_supply(stretch.vsin_v[i], stretch.meta.supply_v) ||
                     beyond_supply(stretch.vcos_v[i], stretch.meta.supply_v);
            })};
  Polar p = polar(stretch, *ellipse_);
  constexpr double kWays = 2; // a clock that scatters moves a sample by as much
  PairPlaces places;
  places.along = leaps_beyond(p.psi, along_limit_rad_, kWays);
  places.far = places_where(stretch.size(),
                            [&](std::size_t i) { return far_off(p.off_v, i, far_limit_v_); });
  for (const std::size_t i : places.far) // beside a row of them a sound sample would be the odd one
    p.off_v[i] = std::nan("");
  places.off = beyond_median(p.off_v, off_limit_v_);
  return places;
}

std::vector<std::size_t> SpikeFinder::vtemp(std::span<const double> column) const {
  return beyond_median(column, vtemp_limit_v_);
}

std::vector<std::size_t> SpikeFinder::vdd(std::span<const double> column) const {
  return beyond_median(column, vdd_limit_v_);
}

std::vector<std::size_t> SpikeFinder::spikes(PairPlaces all) const {
  all.off = spikes(std::move(all.off));
  all.along = spikes(std::move(all.along));
  all.far = spikes(std::move(all.far));
  if (ellipse_)
    std::erase_if(all.along, [off = united(all.off, all.far)](std::size_t i) {
      // a spike beside it leads nowhere
      const auto near = std::lower_bound(off.begin(), off.end(), i >= 2 ? i - 2 : 0);
      return near != off.end() && *near <= i + 2;
    });
  return all.all();
}

std::vector<std::size_t> SpikeFinder::spikes(std::vector<std::size_t> all) const {
  if (is_structure(all.size()))
    all.clear();
  return all;
}

bool SpikeFinder::is_structure(std::size_t places) const {
  return places > samples_ / kRareSample;
}

std::vector<std::size_t> PairPlaces::all() const {
  return united(united(off, along), far);
}

} // namespace ada::health

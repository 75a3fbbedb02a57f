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
#include "simulation/simulation.h"

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

/// Farther than a limit from what the column is about there.
bool far_from_neighbours(std::span<const double> off, std::size_t i, double limit) {
  const std::size_t window = std::min(off.size(), 2 * kFarReach + 1);
  const std::size_t first = std::min(i > kFarReach ? i - kFarReach : 0, off.size() - window);
  const auto begin = off.begin() + static_cast<std::ptrdiff_t>(first);
  const double about =
      quantile(std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(window)), 0.5);
  return std::abs(off[i] - about) > limit;
}

/// And from zero.
bool far_off(const std::vector<double> &off, std::size_t i, double limit) {
  return std::abs(off[i]) > limit && far_from_neighbours(off, i, limit);
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

namespace {

/// Places of a slow column in rows of up to kFarReach: what is as far from the value at either end
/// of that reach.
std::vector<std::size_t> rows_beyond(std::span<const double> x, double limit) {
  return places_where(x.size(), [&](std::size_t i) {
    const bool inside = i >= kFarReach && i + kFarReach < x.size();
    if (inside && std::abs(x[i] - x[i - kFarReach]) <= limit &&
        std::abs(x[i] - x[i + kFarReach]) <= limit)
      return false;
    return far_from_neighbours(x, i, limit);
  });
}

/// The first samples after the sense of rotation has changed at one stroke: the same steps before
/// and after but for their sign, and a jump between them, or no time for it. A single wild sample
/// decides nothing: the mean step of a side lies between medians of three samples at its ends. Nor
/// do a few: the repeated median of the slopes must turn over as well.
std::vector<std::size_t> reversals(const std::vector<double> &psi, const Capture &stretch,
                                   double limit) {
  const std::vector<double> &time = stretch.time_s;
  std::vector<double> steps(psi.size()), angle(psi.size());
  for (std::size_t i = 1; i < psi.size(); ++i) {
    steps[i] = wrap_centred(psi[i] - psi[i - 1], kTwoPi);
    angle[i] = angle[i - 1] + steps[i];
  }
  const auto step = [&](std::size_t i) { return steps[i]; };
  const auto about = [&](std::size_t i) {
    const double a = angle[i - 1], b = angle[i], c = angle[i + 1];
    return std::max(std::min(a, b), std::min(std::max(a, b), c));
  };
  constexpr std::size_t kApart = kSenseSamples - 2; // of the two medians of a side
  std::vector<double> slopes, medians;
  // Siegel's repeated median (Biometrika 69, 1982, 242) of all but two of a side: what is wild at
  // one end of it is not in both its halves.
  constexpr std::size_t kLine = kSenseSamples - 2;
  const auto median_slope = [&](std::size_t first) {
    medians.clear();
    for (std::size_t a = first; a < first + kLine; ++a) {
      slopes.clear();
      for (std::size_t b = first; b < first + kLine; ++b)
        if (b != a)
          slopes.push_back((angle[b] - angle[a]) /
                           (static_cast<double>(b) - static_cast<double>(a)));
      medians.push_back(quantile(slopes, 0.5));
    }
    return quantile(medians, 0.5);
  };
  const auto slopes_turn_over = [&](std::size_t i) {
    const double sense = median_slope(i);
    return sense * median_slope(i + kSenseSamples - kLine) > 0 &&
           sense * median_slope(i - kLine) < 0 && sense * median_slope(i - kSenseSamples) < 0;
  };
  const auto turns_back = [&](std::size_t i) {
    const double before = step(i - 1), after = step(i + 1);
    if (before * after >= 0 || std::abs(before + after) > 2 * limit)
      return false;
    const double from = (about(i - 2) - about(i - 2 - kApart)) / kApart,
                 on = (about(i + 1 + kApart) - about(i + 1)) / kApart;
    double uneven = 0;
    for (std::size_t k = 1; k <= kSenseSamples; ++k)
      uneven = std::max({uneven, std::abs(step(i - k) - before), std::abs(step(i + k) - after)});
    const double dt = time[i] - time[i - 1];
    const double acceleration = 2 * std::abs(from) / (dt * dt * stretch.meta.periods_per_turn);
    return std::abs(from + on) <= kSameSpeed * std::abs(from) && uneven <= 2 * limit &&
           std::abs(from) * kSenseSamples > limit && dt <= 1.5 * (time[i - 1] - time[i - 2]) &&
           (std::abs(step(i)) > kSenseJump * std::abs(from) + limit ||
            acceleration > kMostAcceleration) &&
           slopes_turn_over(i);
  };
  std::vector<std::size_t> places;
  for (std::size_t i = kSenseSamples + 1; i + kSenseSamples < psi.size(); ++i)
    if (turns_back(i)) {
      places.push_back(i);
      i += kSenseSamples; // without a jump the next sample looks like it, too
    }
  return places;
}

/// Rad by which angles point into one direction, from 0 to 1.
struct Direction {
  double angle_rad = 0, share = 0;
};

Direction direction(const std::vector<double> &angles) {
  double x = 0, y = 0, n = 0;
  for (const double a : angles)
    if (std::isfinite(a)) {
      x += std::cos(a);
      y += std::sin(a);
      n += 1;
    }
  return {std::atan2(y, x), n > 0 ? std::hypot(x, y) / n : 0};
}

} // namespace

SpikeFinder::SpikeFinder(const Capture &sample, std::size_t samples,
                         const std::optional<EllipseFit> &ellipse)
    : samples_(samples) {
  vtemp_limit_v_ = column_limit(sample.vtemp_v);
  vdd_limit_v_ = column_limit(sample.vdd_v);
  vtemp_far_v_ = std::max(kVtempJumpDeg * kVtempFractionPerDegree * sample.meta.supply_v,
                          kVtempJumpOverUsual * noise_between(sample.vtemp_v));
  vdd_far_v_ = std::max(kSupplyTolerance * sample.meta.supply_v,
                        kVtempJumpOverUsual * noise_between(sample.vdd_v));
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
  if (sample.has_reference())
    follow_reference(sample, p.psi);
}

void SpikeFinder::follow_reference(const Capture &sample, const std::vector<double> &psi) {
  Direction best;
  double best_sense = 0;
  for (const double sense : {1.0, -1.0}) {
    reference_sense_ = sense;
    const Direction found = direction(from_reference(sample, psi));
    if (found.share > best.share) {
      best = found;
      best_sense = sense;
    }
  }
  if (1 - best.share > kReferenceScatter)
    return; // it does not go with the sensor
  reference_sense_ = best_sense;
  reference_zero_rad_ = best.angle_rad;
  std::vector<double> moved = from_reference(sample, psi);
  for (std::size_t i = 0; i + kFarReach < moved.size(); ++i)
    moved[i] = wrap_centred(moved[i + kFarReach] - moved[i], kTwoPi);
  moved.resize(moved.size() - std::min(moved.size(), kFarReach));
  std::erase_if(moved, [](double m) { return !std::isfinite(m); });
  reference_limit_rad_ = std::max({kFarReferenceDeg * kRadPerDeg, gap_beyond_bulk(moved),
                                   kTailOverSpread * threshold(samples_) * robust_spread(moved)});
}

std::vector<double> SpikeFinder::from_reference(const Capture &capture,
                                                const std::vector<double> &psi) const {
  std::vector<double> off(capture.size());
  const double rad = reference_sense_ * capture.meta.periods_per_turn * kRadPerDeg;
  for (std::size_t i = 0; i < off.size(); ++i)
    off[i] = wrap_centred(psi[i] - rad * capture.reference_deg[i] - reference_zero_rad_, kTwoPi);
  return off;
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
  places.reversals = reversals(p.psi, stretch, along_limit_rad_);
  return places;
}

std::vector<std::size_t> SpikeFinder::vtemp(std::span<const double> column) const {
  return united(beyond_median(column, vtemp_limit_v_), rows_beyond(column, vtemp_far_v_));
}

std::vector<std::size_t> SpikeFinder::vdd(std::span<const double> column) const {
  return united(beyond_median(column, vdd_limit_v_), rows_beyond(column, vdd_far_v_));
}

std::vector<std::size_t> SpikeFinder::reference(const Capture &stretch,
                                                const PairPlaces &pair) const {
  if (!(reference_limit_rad_ > 0) || !stretch.has_reference())
    return {};
  const std::vector<double> psi = polar(stretch, *ellipse_).psi;
  std::vector<double> off = from_reference(stretch, psi);
  for (const std::size_t i : pair.all()) // there it is the sensor that is wrong
    off[i] = std::nan("");
  std::vector<std::size_t> places = rows_beyond(off, reference_limit_rad_);
  // Of a single one, that angle is wild which its own neighbours do not lead to.
  const auto bend = [](std::span<const double> x, std::size_t i, double to_rad) {
    return std::abs(wrap_centred(to_rad * (x[i + 1] - 2 * x[i] + x[i - 1]), kTwoPi));
  };
  const double rad = stretch.meta.periods_per_turn * kRadPerDeg;
  std::erase_if(places, [&](std::size_t i) {
    const bool single = i > 0 && i + 1 < psi.size() &&
                        std::abs(off[i] - off[i - 1]) > reference_limit_rad_ &&
                        std::abs(off[i] - off[i + 1]) > reference_limit_rad_;
    return single && bend(psi, i, 1) > bend(stretch.reference_deg, i, rad);
  });
  return places;
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

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/guards.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/robust.h"
#include "base/text.h"
#include "calibration/dead_channel.h"

namespace ada {

namespace {

constexpr double kStillFraction = 0.01; ///< of the supply: a channel at rest moves less
constexpr double kAsOften = 0.5;        ///< about as many samples of the other channel
constexpr double kSectorOutlier = 6.0;  ///< sigmas from the median of a peak's sector
constexpr double kPeakSector = 0.2;     ///< sine of half the sector about a peak
constexpr double kClippedSlope = 0.5;
constexpr double kFlat = 0.25;         ///< of the variance that an arch has
constexpr double kMaxSlopeError = 0.1; ///< a slope less certain than this is no evidence
constexpr double kOfStep = 0.5; ///< of the converter's step: any peak that is lower looks flat
/// Rows of a peak: with ten a slope that is too small by five of its errors comes once in 2000
/// (Student), and so in one of the four peaks of a capture once in 500.
constexpr double kMinSectorSamples = 10;

std::string number(const char *format, double x) {
  char text[64];
  std::snprintf(text, sizeof text, format, x);
  return text;
}

/// First sample of the longest run of rejected ones.
std::size_t longest_rejected_run(const EllipseFit &fit) {
  std::size_t best = 0, best_count = 0, count = 0;
  for (std::size_t i = 0; i < fit.accepted.size(); ++i) {
    count = fit.accepted[i] ? 0 : count + 1;
    if (count > best_count) {
      best_count = count;
      best = i + 1 - count;
    }
  }
  return best;
}

/// Straight line of measured over expected volts near one peak of one channel. What lies far off
/// the sector's median, more than a sound peak is high in it, is no part of the peak but a spike.
class PeakSlope {
public:
  void add(double expected, double measured) { points_.emplace_back(expected, measured); }

  void draw(double amplitude) {
    std::vector<double> levels;
    levels.reserve(points_.size());
    for (const auto &[expected, measured] : points_)
      levels.push_back(measured);
    const double middle = quantile(levels, 0.5);
    const double least = kPeakSector * kPeakSector * amplitude; // twice the height of an arch
    arch_v_ = 0.5 * least;
    const double limit = std::max(kSectorOutlier * robust_spread(levels), least);
    for (const auto &[expected, measured] : points_)
      if (std::abs(measured - middle) <= limit)
        accumulate(expected, measured);
  }

  bool clipped(double noise_v, double step_v) const {
    if (n_ < kMinSectorSamples || !(xx_ > 0) || arch_v_ < kOfStep * step_v)
      return false;
    // A distorted peak may have two humps, which have no slope either, but a spread of their own.
    if (yy_ > kFlat * xx_ + 1.5 * noise_v * noise_v * n_)
      return false;
    const double slope = xy_ / xx_;
    const double residual = std::max(yy_ - slope * xy_, 0.0) / (n_ - 2);
    return slope < kClippedSlope && std::sqrt(residual / xx_) < kMaxSlopeError;
  }
  double level() const { return mean_y_; }

private:
  void accumulate(double expected, double measured) {
    n_ += 1;
    const double dx = expected - mean_x_, dy = measured - mean_y_;
    mean_x_ += dx / n_;
    mean_y_ += dy / n_;
    xx_ += dx * (expected - mean_x_);
    xy_ += dx * (measured - mean_y_);
    yy_ += dy * (measured - mean_y_);
  }

  std::vector<std::pair<double, double>> points_; ///< expected, measured
  double arch_v_ = 0;                             ///< height of a sound peak within its sector
  double n_ = 0, mean_x_ = 0, mean_y_ = 0, xx_ = 0, xy_ = 0, yy_ = 0;
};

std::string clipped_channel(const char *name, const std::vector<double> &v, double centre,
                            double amplitude, const std::vector<double> &other, double other_centre,
                            double other_amplitude, double delta, double noise_v) {
  PeakSlope top, bottom;
  const double cos_d = std::cos(delta), sin_d = std::sin(delta);
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double x = (other[i] - other_centre) / other_amplitude;
    if (!(std::abs(x) < kPeakSector) || !std::isfinite(v[i]))
      continue;
    const double arch = std::sqrt(1 - x * x) * cos_d, tilt = x * sin_d;
    if (v[i] > centre)
      top.add(amplitude * (arch + tilt), v[i]);
    else
      bottom.add(amplitude * (tilt - arch), v[i]);
  }
  const double step_v = converter_step(v);
  for (PeakSlope *side : {&top, &bottom}) {
    side->draw(amplitude);
    if (side->clipped(noise_v, step_v))
      return std::string(name) + " is clipped at about " + number("%.3f", side->level()) +
             " V: its peaks are cut off, so amplitude and offset cannot be measured";
  }
  return {};
}

} // namespace

void refuse(const std::string &why) {
  if (!why.empty())
    throw Error(ADA4571_ERROR_UNUSABLE_DATA, why);
}

void refuse_dead_channels(const Capture &capture) {
  const double sin_travel = travel(capture.vsin_v), cos_travel = travel(capture.vcos_v);
  const double still = kStillFraction * capture.meta.supply_v;
  if (sin_travel < still && cos_travel < still)
    refuse("the magnet does not turn: VSIN and VCOS move by less than " +
           number("%.0f", still * 1e3) + " mV");
  const auto stuck = [&](const char *name, double own, double other) {
    if (own < kStuckRatio * other)
      refuse(std::string(name) + " is stuck: it moves by " + number("%.2g", own * 1e3) +
             " mV while the other channel moves by " + number("%.3g", other) + " V");
  };
  stuck("VSIN", sin_travel, cos_travel);
  stuck("VCOS", cos_travel, sin_travel);
}

void refuse_stuck_stretches(const Capture &capture) {
  const double sin_travel = travel(capture.vsin_v), cos_travel = travel(capture.vcos_v);
  // Less than what a fit leaves out anyway does no harm: a stretch at a rail, say.
  const double most = kMaxRejected * static_cast<double>(capture.size());
  const auto samples = [&](const std::optional<Stuck> &found) {
    const double n = found ? static_cast<double>(found->samples) : 0;
    return n > most ? n : 0;
  };
  const auto partly = [&](const char *name, const std::optional<Stuck> &found) {
    refuse(std::string(name) + " is stuck for a part of the capture, from " +
           moment_text(capture.time_s[found->first]));
  };
  const auto sin = stuck_stretches(capture.vsin_v, sin_travel, capture.vcos_v, cos_travel);
  const auto cos = stuck_stretches(capture.vcos_v, cos_travel, capture.vsin_v, sin_travel);
  // Where either stands while the other one jumps they know some levels only: no channel is stuck.
  if (std::min(samples(sin), samples(cos)) > kAsOften * std::max(samples(sin), samples(cos)))
    return;
  if (std::max(samples(sin), samples(cos)) > 0)
    samples(sin) > samples(cos) ? partly("VSIN", sin) : partly("VCOS", cos);
}

std::string why_no_circle(const EllipseFit &fit) {
  const EllipseParameters &e = fit.value;
  const double least_v = e.amplitude_v * (1 - std::abs(e.k) / 2);
  if (!(kOutlierSigmas * fit.residual_rms_v <= least_v))
    return "VSIN and VCOS draw no circle: their distance from the best one scatters by " +
           number("%.0f", 100 * fit.residual_rms_v / e.amplitude_v) +
           " % of its radius, so nothing shows that they follow a magnet";
  const std::size_t needed = fit.free_parameters + 1;
  if (fit.directions < needed)
    return "the samples stand at " + std::to_string(fit.directions) +
           " angles only, which prove no circle: at least " + std::to_string(needed) +
           " that differ by " + number("%.0f", kDirectionDeg) + " electrical degrees are needed";
  return {};
}

void refuse_scattered(const Capture &capture, const EllipseFit &fit) {
  const double fraction = static_cast<double>(fit.rejected) /
                          static_cast<double>(std::max<std::size_t>(fit.used + fit.rejected, 1));
  if (fraction <= kMaxRejected)
    return;
  refuse(number("%.0f", 100 * fraction) +
         " % of the samples do not lie on the ellipse of the others, the longest stretch from " +
         moment_text(capture.time_s[longest_rejected_run(fit)]));
}

std::string why_clipped(const Capture &capture, const EllipseFit &fit) {
  const EllipseParameters &e = fit.value;
  const double a_sin = e.amplitude_v * (1 + e.k / 2), a_cos = e.amplitude_v * (1 - e.k / 2);
  const double noise_v = std::sqrt(std::max(
      fit.residual_rms_v * fit.residual_rms_v - fit.structure_rms_v * fit.structure_rms_v, 0.0));
  std::string why = clipped_channel("VSIN", capture.vsin_v, e.centre_sin_v, a_sin, capture.vcos_v,
                                    e.centre_cos_v, a_cos, e.delta_rad, noise_v);
  return !why.empty()
             ? why
             : clipped_channel("VCOS", capture.vcos_v, e.centre_cos_v, a_cos, capture.vsin_v,
                               e.centre_sin_v, a_sin, e.delta_rad, noise_v);
}

} // namespace ada

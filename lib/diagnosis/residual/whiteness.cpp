// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/residual/whiteness.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <span>

#include "base/angle.h"
#include "base/robust.h"
#include "base/solve.h"
#include "diagnosis/criteria.h"
#include "diagnosis/lines/spectrum.h"
#include "diagnosis/residual/components.h"
#include "diagnosis/residual/few_rows.h"
#include "diagnosis/residual/noise_power.h"
#include "diagnosis/search/fit.h"

namespace ada {

namespace {

/// Means of a component over the bins of a key against what white noise would give.
struct BinTest {
  double z;     ///< excess of chi square in its standard deviations
  double rms_v; ///< structure in the component, noise taken off
};

/// `sigma`: of that noise; 0: the scatter within each bin, which may differ from one to another.
BinTest test_bins(const std::vector<double> &component, const std::vector<int> &bin, int bins,
                  double sigma) {
  std::vector<double> sum(static_cast<std::size_t>(bins), 0.0), count = sum, squares = sum;
  for (std::size_t i = 0; i < component.size(); ++i) {
    if (bin[i] < 0)
      continue;
    const auto b = static_cast<std::size_t>(bin[i]);
    sum[b] += component[i];
    squares[b] += component[i] * component[i];
    count[b] += 1.0;
  }
  constexpr double kFewest = 8.0;
  double between = 0.0, used = 0.0, n = 0.0, within = 0.0, spread = 0.0;
  for (std::size_t b = 0; b < sum.size(); ++b) {
    if (count[b] < kFewest)
      continue;
    between += sum[b] * sum[b] / count[b];
    used += 1.0;
    n += count[b];
    // What noise alone would give: the variance of the bin, which c values know to 2 / (c - 1).
    const double own = std::max(0.0, squares[b] - sum[b] * sum[b] / count[b]) / (count[b] - 1.0);
    within += own;
    spread += 2.0 * own * own * count[b] / (count[b] - 1.0);
  }
  if (used < 2.0)
    return {0.0, 0.0};
  if (sigma == 0.0)
    return spread > 0.0 ? BinTest{(between - within) / std::sqrt(spread),
                                  std::sqrt(std::max(0.0, between - within) / n)}
                        : BinTest{0.0, 0.0};
  const double chi2 = between / (sigma * sigma);
  return {(chi2 - used) / std::sqrt(2.0 * used), sigma * std::sqrt(std::max(0.0, chi2 - used) / n)};
}

template <class T> std::vector<int> bins_of(const std::vector<T> &key, int bins) {
  std::vector<T> sorted = key;
  std::sort(sorted.begin(), sorted.end());
  std::vector<T> edges;
  for (int b = 1; b < bins; ++b)
    edges.push_back(
        sorted[sorted.size() * static_cast<std::size_t>(b) / static_cast<std::size_t>(bins)]);
  std::vector<int> out;
  out.reserve(key.size());
  for (T x : key)
    out.push_back(
        static_cast<int>(std::upper_bound(edges.begin(), edges.end(), x) - edges.begin()));
  return out;
}

constexpr const char *kComponent[] = {"VSIN", "VCOS", "the radius", "the angle"};

/// The component that shows most of it, when any does.
void report_bins(const Components &split, const std::vector<int> &bin, int bins, double sigma,
                 double least, const char *along, const char *where, std::vector<Structure> &out) {
  int best = -1;
  BinTest strongest{0.0, 0.0};
  for (int k : split.judged) {
    const BinTest t = test_bins(split.of[k], bin, bins, sigma * split.noise[k]);
    // Noise that grows with the speed, say, is not the same in all: each mean errs by its own
    // scatter.
    if (t.z > 8.0 && t.rms_v > least && t.rms_v > strongest.rms_v &&
        test_bins(split.of[k], bin, bins, 0.0).z > 8.0) {
      strongest = t;
      best = k;
    }
  }
  if (best >= 0)
    out.push_back({along,
                   fmt::format("{} changes with {}: {:.3g} mV rms that no cause explains",
                               kComponent[best], where, 1e3 * strongest.rms_v),
                   strongest.rms_v});
}

/// What two groups of samples have in common in the means of a component over ranges of a level, V
/// rms; `second`: whether a sample is of the second one.
template <class Second>
double alike_v(const std::vector<double> &level, const std::vector<double> &component, double low,
               double width, Second second) {
  struct Sum {
    double sum = 0.0, count = 0.0;
  };
  std::map<long, std::array<Sum, 2>> of_range;
  for (std::size_t i = 0; i < level.size(); ++i) {
    Sum &s = of_range[std::lround(std::floor((level[i] - low) / width))][second(i) ? 1 : 0];
    s.sum += component[i];
    s.count += 1.0;
  }
  double power = 0.0, weight = 0.0;
  for (const auto &[range, groups] : of_range) {
    const double w = std::min(groups[0].count, groups[1].count);
    if (w <= 0.0)
      continue;
    power += w * groups[0].sum / groups[0].count * groups[1].sum / groups[1].count;
    weight += w;
  }
  return weight > 0.0 ? std::sqrt(std::max(0.0, power / weight)) : 0.0;
}

/// A converter whose steps are uneven errs with the level of a channel, finer than any bin of the
/// angle: means over narrow bins of the modelled level (the measured one carries the noise along),
/// none so narrow that an even converter's own steps show. Against the scatter of the channel
/// itself: one of the two may be the noisier one. It errs alike whenever it reads a level: in
/// either half of the record, however fast the level comes and from whichever side of its peak.
/// What goes on for a while, with the speed or with the angle is in one of the two.
void report_levels(const Observations &data, const ResidualColumns &residual,
                   const Components &split, double least, std::vector<Structure> &out) {
  constexpr double kSteps = 4.0, kEach = 16.0, kFewest = 128.0, kMost = 8192.0;
  constexpr double kFiner = 1.2; ///< more than the bins of the angle show
  constexpr double kAgree = 0.7; ///< half of the power
  const double n = static_cast<double>(data.size());
  double known = least;
  for (const Structure &s : out)
    if (s.along == "angle")
      known = std::max(known, kFiner * s.rms_v);
  std::vector<double> speed;
  for (float omega : data.omega)
    speed.push_back(std::abs(omega));
  const double usual_speed = quantile(std::vector<double>(speed), 0.5);
  const auto look = [&](const std::vector<double> &level, std::span<const float> measured,
                        const std::vector<double> &component, const std::vector<double> &other,
                        double centre_of_other_v, const char *name) {
    const auto [low, high] = std::minmax_element(level.begin(), level.end());
    const double span = *high - *low, step = converter_step(measured);
    BinTest strongest{0.0, 0.0};
    double width = 0.0;
    std::vector<int> bin(level.size());
    for (double bins = std::min({kMost, n / kEach, step > 0.0 ? span / (kSteps * step) : kMost});
         bins >= kFewest; bins /= 4.0) {
      const int count = static_cast<int>(bins);
      for (std::size_t i = 0; i < level.size(); ++i)
        bin[i] = std::min(count - 1, static_cast<int>((level[i] - *low) / span * count));
      const BinTest t = test_bins(component, bin, count, 0.0);
      if (t.z > 8.0 && t.rms_v > strongest.rms_v) {
        strongest = t;
        width = span / count;
      }
    }
    const auto alike = [&](auto second) {
      return alike_v(level, component, *low, width, second) > kAgree * strongest.rms_v;
    };
    if (strongest.rms_v > known && alike([&](std::size_t i) { return 2 * i >= level.size(); }) &&
        alike([&](std::size_t i) { return speed[i] > usual_speed; }) &&
        alike([&](std::size_t i) { return other[i] > centre_of_other_v; }))
      out.push_back({"angle",
                     fmt::format("{} errs with its own level by {:.3g} mV rms, in ranges of about "
                                 "{:.2g} mV: the steps of the converter may be uneven",
                                 name, 1e3 * strongest.rms_v, 1e3 * width),
                     strongest.rms_v});
  };
  const bool pair = split.judged.size() > 1;
  look(residual.model_sin, data.vsin, split.of[pair ? 0 : 2], residual.model_cos, data.centre_cos_v,
       kComponent[0]);
  look(residual.model_cos, data.vcos, split.of[pair ? 1 : 2], residual.model_sin, data.centre_sin_v,
       kComponent[1]);
}

void report_spectrum(const Observations &data, const Components &split, const Memory &memory,
                     double sigma, double least, std::vector<Structure> &out) {
  const bool pair = split.judged.size() > 1;
  const Spectrum of_time = spectrum_over_time(data.time, data.frame_period_s, [&](std::size_t i) {
    return pair ? std::complex(split.of[1][i], split.of[0][i]) : std::complex(split.of[2][i]);
  });
  const std::vector<std::complex<float>> &spectrum = of_time.line;
  const std::size_t size = spectrum.size();
  const double bin = of_time.bin_hz;
  if (size == 0)
    return;
  const double n = static_cast<double>(data.size());
  const auto cycles = [&](std::size_t k) { // a sample
    return bin * static_cast<double>(std::min(k, size - k)) * data.frame_period_s;
  };
  const auto noise = [&](std::size_t k) { // expected |.|^2 of a line
    const double own = sigma * split.noise[2];
    return (pair ? 2.0 * sigma * sigma : own * own) * n * memory.density(cycles(k));
  };
  // Bands over both signs of frequency: the pair turns, so the two differ. The record fills only a
  // part of the transform, so neighbouring lines are not independent.
  const double independent = n / static_cast<double>(size);
  constexpr std::size_t kBands = 64;
  double worst_z = 0.0, worst_excess = 0.0, from_hz = 0.0, to_hz = 0.0;
  for (std::size_t b = 0; b < kBands; ++b) {
    const std::size_t from = std::max<std::size_t>(1, b * size / kBands);
    const std::size_t to = (b + 1) * size / kBands;
    double sum = 0.0, expected = 0.0;
    for (std::size_t k = from; k < to; ++k) {
      sum += static_cast<double>(std::norm(spectrum[k]));
      expected += noise(k);
    }
    const double lines = static_cast<double>(to - from);
    const double ratio = sum / expected;
    const double z = (ratio - 1.0) * std::sqrt(lines * independent * (pair ? 1.0 : 0.5));
    const double excess =
        (sum - expected) / ((pair ? 2.0 : 1.0) * sigma * sigma * n) / static_cast<double>(size);
    if (z > worst_z && excess > worst_excess) {
      worst_z = z;
      worst_excess = excess;
      const auto hz = [&](std::size_t k) { // whatever its sign
        return bin * static_cast<double>(std::min(k, size - k));
      };
      from_hz = std::min(hz(b * size / kBands), hz(to));
      to_hz = std::max(hz(b * size / kBands), hz(to));
    }
  }
  const double rms = sigma * std::sqrt(worst_excess);
  if (worst_z > 10.0 && rms > least)
    out.push_back({"frequency",
                   fmt::format("{:.3g} mV rms above white noise between {:.3g} and {:.3g} Hz",
                               1e3 * rms, from_hz, to_hz),
                   rms});
}

/// The strongest line, of the channels or of what lies along or across the vector, wherever it has
/// most of its power: what turns a vector that turns shows in the channels to both sides of its own
/// frequency, and nothing there.
void report_line(const Observations &data, const Components &split, const Memory &memory,
                 double sigma, double least, std::vector<Structure> &out) {
  struct Line {
    double rms_v = 0.0, hz = 0.0; ///< of a channel
  } strongest;
  const char *of_what = "";
  const double n = static_cast<double>(data.size());
  constexpr double kFewestPeriods = 3.0; // over the record: below that it is a drift or a step
  const double fewest_hz = kFewestPeriods / std::max(data.time.back() - data.time.front(), 1e-300);
  const auto look = [&](auto value, double noise_v2, bool real, const char *name) {
    const Spectrum of_time = spectrum_over_time(data.time, data.frame_period_s, value);
    const std::size_t size = of_time.line.size();
    const auto power = [&](std::size_t k) {
      return static_cast<double>(std::norm(of_time.line[k]));
    };
    const auto hz_of = [&](std::size_t k) {
      return of_time.bin_hz * static_cast<double>(std::min(k, size - k));
    };
    std::size_t peak = 0;
    for (std::size_t k = 1; k < size; ++k)
      if (hz_of(k) >= fewest_hz && (peak == 0 || power(k) > power(peak)))
        peak = k;
    if (peak == 0)
      return;
    const double hz = hz_of(peak);
    const double expected = noise_v2 * n * memory.density(hz * data.frame_period_s);
    // A real line has as much at the other sign of its frequency, and half of that in each channel.
    const double rms_v = std::sqrt(power(peak)) / n / (real ? 1.0 : std::numbers::sqrt2);
    if (power(peak) > expected * (std::log(n) + 25.0) && rms_v > strongest.rms_v) {
      strongest = {rms_v, hz};
      of_what = name;
    }
  };
  const auto own_v2 = [&](int k) { return std::pow(sigma * split.noise[k], 2); };
  const bool pair = split.judged.size() > 1;
  if (pair)
    look([&](std::size_t i) { return std::complex(split.of[1][i], split.of[0][i]); },
         2.0 * sigma * sigma, false, "");
  look([&](std::size_t i) { return std::complex(split.of[2][i]); }, own_v2(2), true,
       " along the vector");
  if (pair)
    look([&](std::size_t i) { return std::complex(split.of[3][i]); }, own_v2(3), true,
         " across the vector");
  if (strongest.rms_v > least)
    out.push_back({"frequency",
                   fmt::format("a line of {:.3g} mV rms{} at {:.5g} Hz", 1e3 * strongest.rms_v,
                               of_what, strongest.hz),
                   strongest.rms_v});
}

/// Radial or tangential part of a residual, V.
std::vector<double> part_of(const ResidualColumns &r, const Observations &data, bool radial) {
  std::vector<double> out(r.sin.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double s = r.model_sin[i] - data.centre_sin_v, c = r.model_cos[i] - data.centre_cos_v;
    const double inverse = 1.0 / std::max(std::hypot(s, c), 1e-9);
    out[i] = (radial ? r.sin[i] * s + r.cos[i] * c : r.sin[i] * c - r.cos[i] * s) * inverse;
  }
  return out;
}

} // namespace

std::vector<Structure> find_structure_in_rough(const Scene &scene, const Model &model,
                                               double floor_v) {
  constexpr std::size_t kFewest = 100;
  constexpr double kAbove = 1.6, kSpikes = 0.99; ///< of the noise; the rest may be spikes
  if (scene.rough.size() < kFewest)
    return {};
  const Observations data = at_own_angle(scene.rough, model);
  std::vector<double> radial = part_of(residual_columns(data, model), data, true);
  for (double &x : radial)
    x = std::abs(x);
  const double most = quantile(radial, kSpikes);
  double sum = 0.0, n = 0.0, first = data.time.back(), last = data.time.front();
  for (std::size_t i = 0; i < radial.size(); ++i) {
    if (radial[i] > most)
      continue;
    sum += radial[i] * radial[i];
    n += 1.0;
    if (radial[i] > 4.0 * floor_v) {
      first = std::min(first, data.time[i]);
      last = std::max(last, data.time[i]);
    }
  }
  const double rms = std::sqrt(sum / n);
  if (rms < kAbove * floor_v || last <= first)
    return {};
  return {{"time",
           fmt::format("between {:.4g} and {:.4g} s the radius moves by {:.3g} mV rms where no "
                       "smooth motion fits: no cause explains it",
                       first, last, 1e3 * rms),
           rms}};
}

std::vector<Structure> find_bursts(const Scene &scene, const Model &model, double floor_v) {
  constexpr std::size_t kFewest = 12;
  constexpr double kAbove = 6.0;
  if (scene.bursts.size() < kFewest)
    return {};
  const Observations data = scene.has_reference ? scene.bursts : at_own_angle(scene.bursts, model);
  const ResidualColumns r = residual_columns(data, model);
  std::vector<double> off;
  for (std::size_t i = 0; i < data.size(); ++i)
    off.push_back(std::hypot(r.sin[i], r.cos[i]));
  const double middle = quantile(off, 0.5);
  if (middle < kAbove * floor_v)
    return {};
  return {{"time",
           fmt::format("from {:.4g} s on {} samples stand out by {:.3g} mV, several in a row: no "
                       "spikes, and no cause explains it",
                       data.time.front(), data.size(), 1e3 * middle),
           middle * std::sqrt(static_cast<double>(data.size()) /
                              static_cast<double>(scene.all.size() + data.size()))}};
}

std::vector<Structure> find_jitter(const Observations &data, const ResidualColumns &residual) {
  constexpr std::size_t kFewest = 2000;
  constexpr double kMore = 1.3;
  if (data.size() < kFewest)
    return {};
  // Third differences only within runs of neighbouring samples.
  std::vector<char> beside(data.size(), 1);
  for (std::size_t i = 1; i < data.size(); ++i)
    if (data.time[i] - data.time[i - 1] > 1.5 * data.frame_period_s)
      beside[i] = 0;
  const double radius = noise_between(part_of(residual, data, true), beside);
  const double angle = noise_between(part_of(residual, data, false), beside);
  if (angle < kMore * radius || !(radius > 0.0))
    return {};
  const double rms = std::sqrt(angle * angle - radius * radius);
  return {{"frequency",
           fmt::format("the angle moves from sample to sample by {:.3g} mV rms more than the "
                       "radius: no noise of the pair, and no cause explains it",
                       1e3 * rms),
           rms}};
}

std::vector<Structure> find_structure(const Scene &scene, const Observations &data,
                                      const ResidualColumns &residual, const Model &model,
                                      double sigma_v, double least_rms_v, int orders) {
  std::vector<Structure> out;
  const std::size_t n = data.size();
  if (!(sigma_v > 0.0))
    return out;
  if (n < criteria::kFewestForMeans)
    return scene.stops ? out : find_lines_of_rows(scene, data, residual, least_rms_v, orders);
  const Components split = components(scene, residual);
  const Memory memory(scene, data, split);
  sigma_v = std::max(sigma_v, memory.rms_v());
  const double of_means_v = sigma_v * std::sqrt(memory.of_means());

  std::vector<int> angle(n);
  for (std::size_t i = 0; i < n; ++i)
    angle[i] = std::min(71, static_cast<int>(wrap(data.alpha[i], kTwoPi) / kTwoPi * 72.0));
  report_bins(split, angle, 72, of_means_v, least_rms_v, "angle", "the angle within the turn", out);
  report_levels(data, residual, split, least_rms_v, out);

  const int time_bins = static_cast<int>(std::clamp<std::size_t>(n / 300, 8, 100));
  const std::vector<int> time = bins_of(data.time, time_bins);
  report_bins(split, time, time_bins, of_means_v, least_rms_v, "time", "time", out);
  const std::vector<char> passes = where_outputs_pass(data, model);
  const NoisePower power(data, split, passes);
  report_variance(power, memory, time, time_bins, sigma_v, least_rms_v, "time", sentence_of_times,
                  out);
  report_variance(power, memory, angle, 72, sigma_v, criteria::kWorthAWord * sigma_v, "angle",
                  sentence_of_places, out);

  if (scene.why_no_temperature.empty())
    report_bins(split, bins_of(data.temp, 20), 20, of_means_v, least_rms_v, "temperature", "VTEMP",
                out);
  if (scene.several_speeds || scene.both_directions)
    report_bins(split, bins_of(data.omega, 20), 20, of_means_v, least_rms_v, "speed",
                "the signed speed", out);
  report_spectrum(data, split, memory, sigma_v, least_rms_v, out);
  report_line(data, split, memory, sigma_v, least_rms_v, out);
  return out;
}

} // namespace ada

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
#include "diagnosis/residual/few_rows.h"
#include "diagnosis/search/fit.h"

namespace ada {

namespace {

/// Components of the residual: VSIN, VCOS, radial, tangential.
struct Components {
  std::vector<double> of[4];
  std::vector<double> cos2, sin2; ///< of twice the electrical angle
  std::vector<int> judged; ///< without a reference only the radius is no matter of the motion
  /// Noise of each from sample to sample over that of a channel in the mean.
  double noise[4] = {1.0, 1.0, 1.0, 1.0};
};

Components components(const Scene &scene, const ResidualColumns &r) {
  Components out;
  out.judged = scene.has_reference ? std::vector<int>{0, 1, 2, 3} : std::vector<int>{2};
  for (auto &v : out.of)
    v.resize(r.sin.size());
  out.cos2.resize(r.sin.size());
  out.sin2.resize(r.sin.size());
  for (std::size_t i = 0; i < r.sin.size(); ++i) {
    const double c = r.model_cos[i] - scene.all.centre_cos_v,
                 s = r.model_sin[i] - scene.all.centre_sin_v;
    const double inverse = 1.0 / std::max(std::hypot(c, s), 1e-9);
    out.cos2[i] = (c * c - s * s) * inverse * inverse;
    out.sin2[i] = 2.0 * s * c * inverse * inverse;
    out.of[0][i] = r.sin[i];
    out.of[1][i] = r.cos[i];
    out.of[2][i] = (r.cos[i] * c + r.sin[i] * s) * inverse;
    out.of[3][i] = (r.sin[i] * c - r.cos[i] * s) * inverse;
  }
  double own[4];
  for (int k = 0; k < 4; ++k)
    own[k] = noise_between(out.of[k]);
  const double mean = std::hypot(own[0], own[1]) / std::numbers::sqrt2;
  // Where the angle is the pair's own, the noise that is known is that of the radius.
  const bool radius = out.judged.size() == 1 && !scene.radius_only;
  for (int k : out.judged)
    if ((k < 2 || radius) && mean > 0.0 && own[k] > 0.0)
      out.noise[k] = own[k] / mean;
  return out;
}

/// How long noise remembers itself: a converter that averages, or a filter before it, makes it
/// alike in neighbouring samples. Its autocorrelation is what that of the residual has at short
/// lags above its plateau, as structure is still the same some samples later. White: nothing.
class Memory {
public:
  Memory(const Scene &scene, const Observations &data, const Components &split) {
    const double turn = scene.fastest_omega * scene.periods * data.frame_period_s;
    const double least = static_cast<double>(criteria::kMemory * criteria::kMemory);
    if (turn > kTwoPi / least) // structure is not the same then
      return;
    // What averages or filters does so to both channels: along the vector the noise remembers
    // itself for as long as across it. What does so in one of the two only is a motion, or a gain.
    constexpr std::size_t kAlong = 2, kAcross = 3;
    *this = Memory(data, split.of[kAlong]);
    if (split.judged.size() > 1)
      if (Memory across(data, split.of[kAcross]);
          across.rms_v() * across.of_means() < rms_v() * of_means())
        *this = std::move(across);
  }

  /// Rms of noise that remembers itself, V; 0: it is white.
  double rms_v() const { return rms_v_; }
  /// Variance of a mean over that of as many independent samples.
  double of_means() const { return density(0.0); }
  /// The same of a mean of squares, whose correlation is the square.
  double of_squares() const {
    double out = 1.0;
    for (double r : correlation_)
      out += 2.0 * r * r;
    return out;
  }
  /// Power at a frequency, in cycles a sample, over that of white noise.
  double density(double cycles) const {
    double out = 1.0;
    for (std::size_t k = 0; k < correlation_.size(); ++k)
      out += 2.0 * correlation_[k] * std::cos(kTwoPi * cycles * static_cast<double>(k + 1));
    return std::max(out, kLeastDensity);
  }

private:
  Memory(const Observations &data, const std::vector<double> &noise) {
    std::vector<double> sum(2 * criteria::kMemory + 1, 0.0), count = sum;
    for (std::size_t lag = 0; lag < sum.size(); ++lag)
      for (std::size_t i = 0; i + lag < data.size(); ++i) {
        if (data.time[i + lag] - data.time[i] >
            (static_cast<double>(lag) + 0.5) * data.frame_period_s)
          continue;
        sum[lag] += noise[i] * noise[i + lag];
        count[lag] += 1.0;
      }
    for (std::size_t lag = 0; lag < sum.size(); ++lag)
      sum[lag] /= std::max(1.0, count[lag]);
    double plateau = 0.0;
    for (std::size_t lag = criteria::kMemory + 1; lag < sum.size(); ++lag)
      plateau += sum[lag] / static_cast<double>(criteria::kMemory);
    const double own = sum[0] - std::max(0.0, plateau);
    if (!(own > 0.0))
      return;
    std::vector<double> of(criteria::kMemory);
    double all = 1.0;
    for (std::size_t lag = 1; lag <= criteria::kMemory; ++lag)
      all += 2.0 * (of[lag - 1] = (sum[lag] - std::max(0.0, plateau)) / own);
    // Each correlation of n samples of white noise has an error of the root of 1/n.
    const double error = 2.0 * std::sqrt(static_cast<double>(criteria::kMemory) / count[0]);
    if (all < 1.0 + criteria::kClearErrors * error)
      return;
    correlation_ = std::move(of);
    rms_v_ = std::sqrt(own);
  }

  static constexpr double kLeastDensity = 0.05; ///< what few lags leave negative
  std::vector<double> correlation_;             ///< at lags 1, 2, ...
  double rms_v_ = 0.0;
};

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

/// What two halves of a record have in common in the means of a component over ranges of a level, V
/// rms. A converter errs alike whenever it reads a level; what goes on for a while stays in one of
/// the halves, however finely it is cut.
double alike_v(const std::vector<double> &level, const std::vector<double> &component, double low,
               double width) {
  struct Sum {
    double sum = 0.0, count = 0.0;
  };
  std::map<long, std::array<Sum, 2>> of_range;
  for (std::size_t i = 0; i < level.size(); ++i) {
    Sum &s = of_range[std::lround(std::floor((level[i] - low) / width))][2 * i / level.size()];
    s.sum += component[i];
    s.count += 1.0;
  }
  double power = 0.0, weight = 0.0;
  for (const auto &[range, halves] : of_range) {
    const double w = std::min(halves[0].count, halves[1].count);
    if (w <= 0.0)
      continue;
    power += w * halves[0].sum / halves[0].count * halves[1].sum / halves[1].count;
    weight += w;
  }
  return weight > 0.0 ? std::sqrt(std::max(0.0, power / weight)) : 0.0;
}

/// A converter whose steps are uneven errs with the level of a channel, finer than any bin of the
/// angle: means over narrow bins of the modelled level (the measured one carries the noise along),
/// none so narrow that an even converter's own steps show. Against the scatter of the channel
/// itself: one of the two may be the noisier one.
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
  const auto look = [&](const std::vector<double> &level, std::span<const float> measured,
                        const std::vector<double> &component, const char *name) {
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
    if (strongest.rms_v > known &&
        kAgree * strongest.rms_v < alike_v(level, component, *low, width))
      out.push_back({"angle",
                     fmt::format("{} errs with its own level by {:.3g} mV rms, in ranges of about "
                                 "{:.2g} mV: the steps of the converter may be uneven",
                                 name, 1e3 * strongest.rms_v, 1e3 * width),
                     strongest.rms_v});
  };
  const bool pair = split.judged.size() > 1;
  look(residual.model_sin, data.vsin, split.of[pair ? 0 : 2], kComponent[0]);
  look(residual.model_cos, data.vcos, split.of[pair ? 1 : 2], kComponent[1]);
}

/// Power of noise along and across the vector where the two channels differ, are correlated, or
/// share a noise of the supply, the gain or the angle: each goes with twice the electrical angle on
/// its own; what comes of a scatter of instants goes across with the square of the speed as well.
class NoisePower {
public:
  /// `passes`: whether both outputs follow what comes before them. One that stands at its stop has
  /// no noise of the sensor.
  NoisePower(const Observations &data, const Components &split, const std::vector<char> &passes)
      : data_(data), split_(split), passes_(passes), across_(split.judged.size() > 1) {
    double sum = 0.0;
    for (double w : data.omega)
      sum += w * w;
    mean_omega2_ = sum / static_cast<double>(std::max<std::size_t>(1, data.size()));
    along_law_ = law(2);
    if (across_)
      across_law_ = law(3);
  }

  /// Parts of a sample over the root of the power that is expected of them: of the radius, 0, and
  /// where there is a reference of the angle, 1.
  template <typename Take> void each(Take take) const {
    for (std::size_t i = 0; i < split_.cos2.size(); ++i) {
      if (!passes_[i])
        continue;
      take(i, 0, split_.of[2][i] / std::sqrt(at(along_law_, i)));
      if (across_)
        take(i, 1, split_.of[3][i] / std::sqrt(at(across_law_, i)));
    }
  }

private:
  /// Of the mean power at a speed: a channel with a tenth of the noise of the other. Of the mean
  /// over all speeds: a speed at which next to nothing scatters.
  static constexpr double kLeastOfMean = 0.01, kLeastOfAll = 1e-4;
  using Row = Eigen::Vector4d;

  double square(int component, std::size_t i) const {
    return split_.of[component][i] * split_.of[component][i];
  }
  Row row(std::size_t i) const {
    const double speed = mean_omega2_ > 0.0 ? data_.omega[i] * data_.omega[i] / mean_omega2_ : 1.0;
    return {1.0, split_.cos2[i], split_.sin2[i], speed - 1.0};
  }
  /// The square of a normal variable scatters in proportion to its mean: weighted by the law
  /// itself, and so a few times over (Nelder and Wedderburn, J. R. Stat. Soc. A 135, 1972).
  Row law(int component) const {
    constexpr int kPasses = 5;
    Row out = Row::Zero();
    for (int pass = 0; pass < kPasses; ++pass) {
      Eigen::Matrix4d normal = Eigen::Matrix4d::Identity() * 1e-9;
      Row right = Row::Zero();
      for (std::size_t i = 0; i < split_.cos2.size(); ++i) {
        if (!passes_[i])
          continue;
        Row x = row(i);
        if (component == 2)
          x[3] = 0.0;
        const double weight = pass == 0 ? 1.0 : std::pow(out[0] / at(out, i), 2);
        normal += weight * x * x.transpose();
        right += weight * x * square(component, i);
      }
      out = solved(normal, right);
      if (!(out[0] > 0.0))
        break;
    }
    return out;
  }
  double at(const Row &of, std::size_t i) const {
    const Row x = row(i);
    const double at_speed = std::max(of[0] + of[3] * x[3], kLeastOfAll * of[0]);
    return std::max({of.dot(x), kLeastOfMean * at_speed, 1e-300});
  }

  const Observations &data_;
  const Components &split_;
  const std::vector<char> &passes_;
  bool across_;
  double mean_omega2_ = 0.0;
  Row along_law_ = Row::Zero(), across_law_ = Row::Zero();
};

/// Noise that comes and goes with time, or with the place in the turn. `of`: one sentence about the
/// bins by power over the mean.
void report_variance(const NoisePower &power, const Memory &memory, const std::vector<int> &bin,
                     int bins, double sigma, double least, const char *along,
                     const std::function<std::string(const std::vector<double> &)> &sentence,
                     std::vector<Structure> &out) {
  constexpr double kClear = 12.0; // standard deviations of chi square
  constexpr double kMore = 0.25;  // of the mean power
  const auto of_bins = static_cast<std::size_t>(bins);
  // About the mean of each bin: what a model misses there is no noise.
  std::array<std::vector<double>, 2> middle{std::vector<double>(of_bins),
                                            std::vector<double>(of_bins)},
      number = middle;
  const auto at = [&](std::size_t i) { return static_cast<std::size_t>(bin[i]); };
  power.each([&](std::size_t i, std::size_t part, double x) {
    middle[part][at(i)] += x;
    number[part][at(i)] += 1.0;
  });
  std::vector<double> sum(of_bins, 0.0), count = sum;
  double all = 0.0, squares = 0.0, n = 0.0;
  power.each([&](std::size_t i, std::size_t part, double x) {
    const double off = x - middle[part][at(i)] / number[part][at(i)], x2 = off * off;
    sum[at(i)] += x2;
    count[at(i)] += 1.0;
    all += x2;
    squares += x2 * x2;
    n += 1.0;
  });
  const double mean = all / n;
  // Variance of a square by its own scatter: 2 of a normal variable, more where a few values stand
  // out, which then prove less.
  const double scatter = memory.of_squares() * std::max(squares / n / (mean * mean) - 1.0, 2.0);
  double chi2 = 0.0, worst = 0.0, above = 0.0;
  for (std::size_t b = 0; b < sum.size(); ++b) {
    if (count[b] == 0.0)
      continue;
    const double ratio = sum[b] / count[b] / mean - 1.0;
    above += std::max(0.0, ratio) * count[b];
    chi2 += ratio * ratio * count[b] / scatter;
    worst = std::max(worst, ratio);
    sum[b] = 1.0 + ratio;
  }
  const double z = (chi2 - bins) / std::sqrt(2.0 * bins);
  const double rms = sigma * std::sqrt(above / n);
  if (z > kClear && worst > kMore && rms > least)
    out.push_back({along, sentence(sum), rms});
}

std::string sentence_of_times(const std::vector<double> &power) {
  return fmt::format("the noise is not constant: up to {:.2g} times its mean power",
                     *std::max_element(power.begin(), power.end()));
}

/// By places in the turn: `power` over its mean, in even bins.
std::string sentence_of_places(const std::vector<double> &power) {
  const auto most = std::max_element(power.begin(), power.end());
  const double width = 360.0 / static_cast<double>(power.size());
  return fmt::format(
      "the noise goes with the place in the turn: up to {:.2g} times its mean power, "
      "about {:.3g} deg",
      *most, width * (static_cast<double>(most - power.begin()) + 0.5));
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
  std::size_t peak = 1;
  for (std::size_t k = 1; k < size; ++k)
    if (std::norm(spectrum[k]) > std::norm(spectrum[peak]))
      peak = k;
  const double strongest = static_cast<double>(std::norm(spectrum[peak]));
  const double line = std::sqrt(strongest) / n / std::sqrt(2.0);
  if (strongest > noise(peak) * (std::log(n) + 25.0) && line > least)
    out.push_back({"frequency",
                   fmt::format("a line of {:.3g} mV rms at {:.5g} Hz", 1e3 * line,
                               bin * static_cast<double>(std::min(peak, size - peak))),
                   line});
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
  return out;
}

} // namespace ada

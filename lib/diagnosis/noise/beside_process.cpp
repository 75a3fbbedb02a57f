// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/noise/beside_process.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/angle.h"
#include "diagnosis/noise/along_and_across.h"
#include "diagnosis/search/fit.h"

namespace ada {

namespace {

using Channels = std::array<std::vector<double>, 2>;

/// What a process of this pattern moves: both channels, or the length.
Channels seen_by(const Observations &data, ResidualColumns by, Pattern pattern) {
  if (pattern == Pattern::offset)
    return {std::move(by.sin), std::move(by.cos)};
  Channels out;
  std::vector<double> across;
  along_and_across(data, by, out[0], across);
  out[1].assign(out[0].size(), 0.0);
  return out;
}

/// How a parameter moves it.
Channels moved(const Observations &data, const Model &model, const Model &other, Pattern pattern) {
  const ResidualColumns here = residual_columns(data, model), there = residual_columns(data, other);
  ResidualColumns by = here;
  for (std::size_t i = 0; i < data.size(); ++i) {
    by.sin[i] = there.model_sin[i] - here.model_sin[i];
    by.cos[i] = there.model_cos[i] - here.model_cos[i];
  }
  return seen_by(data, std::move(by), pattern);
}

double mean_of(const std::vector<double> &x) {
  return std::accumulate(x.begin(), x.end(), 0.0) /
         static_cast<double>(std::max<std::size_t>(1, x.size()));
}

/// The part of a walk's mean square that its k-th half wave has, k from 1 on: 1 / k^2 of their sum.
double of_half_wave(int k) {
  return 6.0 / std::pow(k * std::numbers::pi, 2);
}

/// Means of values over even parts of a record, of those that have some, with their times.
struct Means {
  std::vector<double> time, value;
};

Means means_of(const std::vector<double> &x, const std::vector<double> &time, std::size_t parts) {
  const double span = std::max(time.back() - time.front(), 1e-300);
  std::vector<double> sum(parts, 0.0), count(parts, 0.0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto part =
        static_cast<std::size_t>((time[i] - time.front()) / span * static_cast<double>(parts));
    sum[std::min(part, parts - 1)] += x[i];
    count[std::min(part, parts - 1)] += 1.0;
  }
  Means out;
  for (std::size_t k = 0; k < parts; ++k)
    if (count[k] > 0.0) {
      out.time.push_back(time.front() +
                         span * (static_cast<double>(k) + 0.5) / static_cast<double>(parts));
      out.value.push_back(sum[k] / count[k]);
    }
  return out;
}

/// Power of the first half waves over the record: of means over parts of them, as a few samples
/// here and there have the fast ones in the slow.
std::vector<double> half_waves_of(const std::vector<double> &samples,
                                  const std::vector<double> &sampled, int waves) {
  constexpr int kParts = 8; // of a half wave
  const auto [time, x] = means_of(samples, sampled, static_cast<std::size_t>(kParts * waves));
  const double mean = mean_of(x), n = static_cast<double>(std::max<std::size_t>(1, x.size()));
  const double span = std::max(sampled.back() - sampled.front(), 1e-300);
  std::vector<double> out;
  for (int k = 1; k <= waves; ++k) {
    double sum = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i)
      sum += (x[i] - mean) * std::cos(k * std::numbers::pi * (time[i] - sampled.front()) / span);
    out.push_back(2.0 * sum * sum / (n * n));
  }
  return out;
}

/// Mean square about the mean, the part of it in the first half waves, and what a walk of mean
/// square 1 has of that shape: of its power the k-th half wave has a part that falls with the
/// square of k.
struct Power {
  double all = 0.0, slow = 0.0, of_walk = 0.0;
};

Power power_of(const std::vector<double> &x, const std::vector<double> &time, int waves) {
  const double mean = mean_of(x), n = static_cast<double>(std::max<std::size_t>(1, x.size()));
  Power out;
  for (double v : x)
    out.all += (v - mean) * (v - mean) / n;
  int k = 0;
  for (double power : half_waves_of(x, time, waves)) {
    out.slow += power;
    out.of_walk += power * of_half_wave(++k);
  }
  return out;
}

} // namespace

std::vector<double> errors_beside(const Observations &data, const Model &model, std::size_t effect,
                                  const RandomCause &process, int waves) {
  constexpr double kSlow = 0.1; // of its power: of what goes with the angle chance has less
  const EffectInstance &cause = model.effects[effect];
  std::vector<double> out(cause.values.size(), 0.0);
  const Pattern pattern = process.effect->info().pattern;
  if (data.size() < 2 || waves < 1 || cause.std_errors.size() != out.size())
    return out;
  const double of_gain = std::abs(model.baseline.amplitude_v) * process.values.front();
  const std::array<double, 2> process_v{pattern == Pattern::gain ? of_gain : process.values[0],
                                        pattern == Pattern::gain ? 0.0 : process.values[1]};
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double step = cause.std_errors[k];
    if (!(step > 0.0))
      continue;
    Model other = model;
    other.effects[effect].values[k] += step;
    const Channels by = moved(data, model, other, pattern);
    double sum = 0.0, all = 0.0;
    for (std::size_t c = 0; c < by.size(); ++c) {
      const Power of = power_of(by[c], data.time, waves);
      if (of.slow > kSlow * of.all)
        sum += process_v[c] * process_v[c] * of.of_walk;
      all += of.all;
    }
    if (all > 0.0)
      out[k] = step * std::sqrt(sum) / all;
  }
  return out;
}

namespace {

/// The largest log likelihood of powers of half waves as those of a walk of any size, with noise of
/// the same power in each: each is the square of one normal number.
double most_as_walk(const std::vector<double> &power, double noise) {
  constexpr double kLeast = 1e-300; // V^2
  constexpr double kDecades = 12.0;
  constexpr int kSteps = 240;
  double largest = 0.0;
  int k = 0;
  for (double p : power)
    largest = std::max(largest, p / of_half_wave(++k));
  double best = -std::numeric_limits<double>::infinity();
  for (int step = 0; step <= kSteps; ++step) {
    const double size = largest * std::pow(10.0, -kDecades * step / kSteps);
    double nats = 0.0;
    k = 0;
    for (double p : power) {
      const double expected = std::max(size * of_half_wave(++k) + noise, kLeast);
      nats -= 0.5 * (std::log(expected) + p / expected);
    }
    best = std::max(best, nats);
  }
  return best;
}

} // namespace

double nats_over_walk(const Observations &data, const Model &with, const Model &less,
                      Pattern pattern) {
  constexpr int kWaves = 32; // and as many above them tell the noise
  const Channels left = seen_by(data, residual_columns(data, with), pattern),
                 without = seen_by(data, residual_columns(data, less), pattern);
  double nats = 0.0;
  for (std::size_t c = 0; c < left.size(); ++c) {
    std::vector<double> here = half_waves_of(left[c], data.time, 2 * kWaves);
    const double noise = std::accumulate(here.begin() + kWaves, here.end(), 0.0) / kWaves;
    here.resize(kWaves);
    nats += most_as_walk(here, noise) -
            most_as_walk(half_waves_of(without[c], data.time, kWaves), noise);
  }
  return nats;
}

double more_of_walk(int taken) {
  double left = 1.0;
  for (int k = 1; k <= taken; ++k)
    left -= of_half_wave(k);
  return 1.0 / left;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "wander.h"

#include "motion.h"
#include "random.h"

#include <cmath>

namespace truth {
namespace {

/// Scales to the wanted rms about the mean.
std::vector<double> with_rms(std::vector<double> values, double rms) {
  double mean = 0.0;
  for (double v : values)
    mean += v / static_cast<double>(values.size());
  double power = 0.0;
  for (double v : values)
    power += (v - mean) * (v - mean) / static_cast<double>(values.size());
  for (double &v : values)
    v = (v - mean) * rms / std::sqrt(power);
  return values;
}

} // namespace

Track random_walk(Random &random, double duration, std::size_t points, double rms) {
  std::vector<double> values(points);
  double sum = 0.0;
  for (double &v : values)
    v = sum += random.normal();
  return {duration, with_rms(std::move(values), rms)};
}

/// 1/f noise as a sum of relaxations whose time constants are spread evenly over the octaves, from
/// two points.
Track flicker(Random &random, double duration, std::size_t points, double rms) {
  constexpr int kOctaves = 17;
  std::vector<double> state(kOctaves);
  std::vector<double> values(points);
  for (double &x : state)
    x = random.normal();
  for (double &v : values) {
    v = 0.0;
    for (int i = 0; i < kOctaves; ++i) {
      double &x = state[static_cast<std::size_t>(i)];
      const double keep = std::exp(-std::ldexp(0.5, -i));
      x = keep * x + std::sqrt(1 - keep * keep) * random.normal();
      v += x;
    }
  }
  return {duration, with_rms(std::move(values), rms)};
}

Track smooth_walk(Random &random, double duration, double rms) {
  constexpr std::size_t kSteps = 12;
  constexpr std::size_t kPoints = 3000;
  std::vector<double> knots(kSteps + 1);
  double sum = 0.0;
  for (double &knot : knots)
    knot = sum += random.normal();
  std::vector<double> values(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double x = static_cast<double>(kSteps * i) / static_cast<double>(kPoints);
    const auto k = static_cast<std::size_t>(x);
    const double part = 0.5 * (1.0 - std::cos(0.5 * kTurn * (x - static_cast<double>(k))));
    values[i] = knots[k] + part * (knots[k + 1] - knots[k]);
  }
  return {duration, with_rms(std::move(values), rms)};
}

} // namespace truth

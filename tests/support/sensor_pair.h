// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A small independent sensor for the tests of conversion and calibration: it shares no code with
// the library's forward model. Angles in radians, volts absolute.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>

#include "recording/capture.h"

namespace ada::test {

/// The pair as the data sheets of such sensors describe it, plus what can be wrong with it.
struct SensorPair {
  double supply_v = 5.0;
  int periods = 2;
  double amplitude_v = 0.29 * 5.0;
  double k = 0.0, delta_rad = 0.0;
  double offset_sin_v = 0.031, offset_cos_v = -0.018;
  double tc_sin = 0, tc_cos = 0, tc_amplitude = 0; ///< over VTEMP minus vtemp_reference_v
  double vtemp_reference_v = 1.6;
  double noise_rms_v = 0.0005;
  int adc_bits = 16;
  double stray = 0; ///< relative stray field along angle 0

  /// VTEMP of a temperature: 0.77 V + 11 mV/K at 3.3 V, ratiometric.
  double vtemp_of(double deg_c) const { return supply_v / 3.3 * (0.77 + 0.011 * deg_c); }
};

using Motion = std::function<double(double time_s)>;      ///< mechanical angle, rad
using Temperature = std::function<double(double time_s)>; ///< deg C

inline Motion constant_speed(double turns_per_s, double start_rad = 0.3) {
  return [=](double t) { return start_rad + 2 * std::numbers::pi * turns_per_s * t; };
}

/// Speed that swings by `depth` (below 1) about its mean, `order` times a turn.
inline Motion swinging_speed(double turns_per_s, double depth, double order,
                             double start_rad = 0.3) {
  return [=](double t) {
    const double even = 2 * std::numbers::pi * turns_per_s * t;
    return start_rad + even + depth / order * std::sin(order * even);
  };
}

class Sampler {
public:
  Sampler(const SensorPair &pair, std::uint64_t seed) : pair_(pair), rng_(seed) {}

  double noise(double rms) { return rms > 0 ? rms * normal_(rng_) : 0.0; }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(rng_);
  }

  void pair_at(double alpha, double vtemp, double &vsin, double &vcos) {
    const SensorPair &p = pair_;
    if (p.stray != 0) // vector sum of the magnet's field and a constant one
      alpha = std::atan2(std::sin(alpha), std::cos(alpha) + p.stray);
    const double psi = p.periods * alpha, dv = vtemp - p.vtemp_reference_v;
    const double a = p.amplitude_v * (1 + p.tc_amplitude * dv);
    vsin = p.supply_v / 2 + p.offset_sin_v + p.tc_sin * dv +
           a * (1 + p.k / 2) * std::sin(psi + p.delta_rad / 2);
    vcos = p.supply_v / 2 + p.offset_cos_v + p.tc_cos * dv +
           a * (1 - p.k / 2) * std::cos(psi - p.delta_rad / 2);
  }

  double convert(double v) {
    v += noise(pair_.noise_rms_v);
    if (pair_.adc_bits == 0)
      return v;
    const double lsb = pair_.supply_v / std::exp2(pair_.adc_bits);
    return lsb * std::round(v / lsb);
  }

  Capture capture(double rate_hz, double duration_s, const Motion &motion,
                  const Temperature &temperature = {}) {
    Capture c;
    c.meta.supply_v = pair_.supply_v;
    c.meta.periods_per_turn = pair_.periods;
    c.identity = "test";
    const auto n = static_cast<std::size_t>(std::lround(rate_hz * duration_s));
    for (std::size_t i = 0; i < n; ++i) {
      const double t = static_cast<double>(i) / rate_hz, alpha = motion(t);
      const double vtemp = temperature ? pair_.vtemp_of(temperature(t)) : pair_.vtemp_reference_v;
      double s, k;
      pair_at(alpha, vtemp, s, k);
      c.time_s.push_back(t);
      c.vsin_v.push_back(convert(s));
      c.vcos_v.push_back(convert(k));
      if (temperature)
        c.vtemp_v.push_back(convert(vtemp));
      c.reference_deg.push_back(alpha * 180 / std::numbers::pi);
    }
    return c;
  }

private:
  SensorPair pair_;
  std::mt19937_64 rng_;
  std::normal_distribution<double> normal_;
};

} // namespace ada::test

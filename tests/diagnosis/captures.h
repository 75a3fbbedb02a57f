// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Small captures from the forward model. They test the arithmetic of fits and searches, whose truth
// is then known exactly; whether the model is right is a matter of the truth engine.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "base/angle.h"
#include "model/effect_text.h"
#include "model/forward.h"
#include "recording/capture.h"

namespace ada::test {

inline Model plain_sensor() {
  Model model;
  model.supply_v = 5.0;
  model.periods_per_turn = 2;
  model.baseline = {1.45, 0.004, -0.003, 1.0};
  return model;
}

struct Drive {
  std::size_t samples = 20000;
  double rate_hz = 2000.0;
  double slow_rpm = 120.0, fast_rpm = 600.0; ///< a slow ramp between them
  bool turns_back = true;                    ///< second half in the other sense
  double noise_v = 5e-4;
};

/// How a shaft moves, sample by sample, in rad and s.
struct ShaftMotion {
  std::vector<double> alpha, omega;
  std::vector<signed char> direction;
};

/// The pair alone, with noise.
inline Capture pair_of(const Model &model, const ShaftMotion &shaft, double rate_hz, double noise_v,
                       std::mt19937_64 &rng) {
  const std::size_t n = shaft.alpha.size();
  Capture c;
  c.meta.supply_v = model.supply_v;
  c.meta.periods_per_turn = model.periods_per_turn;
  c.meta.noise_rms_v = noise_v;
  c.meta.sample_rate_hz = rate_hz;
  for (std::size_t i = 0; i < n; ++i)
    c.time_s.push_back(static_cast<double>(i) / rate_hz);
  c.vsin_v.resize(n);
  c.vcos_v.resize(n);
  const std::vector<float> omega(shaft.omega.begin(), shaft.omega.end()), accel(n, 0.0f);
  const Conditions at{.n = n,
                      .time = c.time_s.data(),
                      .alpha = shaft.alpha.data(),
                      .omega = omega.data(),
                      .accel = accel.data(),
                      .direction = shaft.direction.data(),
                      .frame_period_s = 1.0 / rate_hz};
  ForwardModel(model, AlphaIs::shaft).evaluate(at, c.vsin_v.data(), c.vcos_v.data());
  std::normal_distribution<> noise(0.0, noise_v);
  for (std::size_t i = 0; i < n; ++i) {
    c.vsin_v[i] += noise(rng);
    c.vcos_v[i] += noise(rng);
  }
  return c;
}

/// With a reference, from a slow swing of the speed.
inline Capture capture_of(const Model &model, const Drive &drive, std::mt19937_64 &rng) {
  const double length = static_cast<double>(drive.samples) / drive.rate_hz;
  double angle = std::uniform_real_distribution<>(0.0, kTwoPi)(rng);
  ShaftMotion shaft;
  for (std::size_t i = 0; i < drive.samples; ++i) {
    const double t = static_cast<double>(i) / drive.rate_hz;
    const double swing = std::sin(0.5 * kTwoPi * t / length);
    double w = (drive.slow_rpm + (drive.fast_rpm - drive.slow_rpm) * swing) * kTwoPi / 60.0;
    if (drive.turns_back)
      w *= std::tanh((0.5 * length - t) / (0.02 * length));
    shaft.omega.push_back(w);
    shaft.direction.push_back(w < 0.0 ? -1 : 1);
    shaft.alpha.push_back(angle);
    angle += w / drive.rate_hz;
  }
  Capture c = pair_of(model, shaft, drive.rate_hz, drive.noise_v, rng);
  for (double a : shaft.alpha)
    c.reference_deg.push_back(wrap(a * kDegPerRad, 360.0));
  return c;
}

} // namespace ada::test

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "model/forward.h"

#include <algorithm>
#include <cmath>

#include "base/angle.h"
#include "base/sincos.h"

namespace ada {

namespace {

/// (re, im) times (x, y), as complex numbers.
void multiply(std::size_t n, const double *x, const double *y, double *re, double *im) {
  for (std::size_t i = 0; i < n; ++i) {
    const double product = re[i] * x[i] - im[i] * y[i];
    im[i] = re[i] * y[i] + im[i] * x[i];
    re[i] = product;
  }
}

/// e^(j p x) of the direction of (fx, fy): its unit vector to the power of p, by squaring.
void electrical(Wave &w) {
  if (w.periods == 2) {
    for (std::size_t i = 0; i < w.n; ++i) {
      const double x = w.fx[i], y = w.fy[i];
      const double inverse = 1.0 / (x * x + y * y);
      w.ex[i] = (x * x - y * y) * inverse;
      w.ey[i] = 2.0 * x * y * inverse;
    }
    return;
  }
  double x[kWaveBlock], y[kWaveBlock];
  for (std::size_t i = 0; i < w.n; ++i) {
    const double inverse = 1.0 / std::sqrt(w.fx[i] * w.fx[i] + w.fy[i] * w.fy[i]);
    x[i] = w.fx[i] * inverse;
    y[i] = w.fy[i] * inverse;
    w.ex[i] = 1.0;
    w.ey[i] = 0.0;
  }
  for (auto rest = static_cast<unsigned>(w.periods);;) {
    if ((rest & 1u) != 0)
      multiply(w.n, x, y, w.ex, w.ey);
    if ((rest >>= 1) == 0)
      break;
    for (std::size_t i = 0; i < w.n; ++i) {
      const double square = x[i] * x[i] - y[i] * y[i];
      y[i] *= 2.0 * x[i];
      x[i] = square;
    }
  }
}

} // namespace

ForwardModel::ForwardModel(const Model &model, AlphaIs alpha)
    : baseline_(model.baseline), mid_v_(0.5 * model.supply_v),
      temp_reference_v_(model.vtemp_reference_v), periods_(model.periods_per_turn) {
  if (model.remainder) {
    remainder_ = model.remainder->series(baseline_.amplitude_v);
    remainder_periods_ = model.remainder->electrical ? periods_ : 1.0;
  }
  for (EffectInstance &e : in_physical_order(model.effects)) {
    e.effect->dynamics(e.values, taps_);
    apart_rad_ += e.effect->channels_apart_rad(e.values);
    Step step{e.effect, std::move(e.values)};
    switch (e.effect->info().stage) {
    case Stage::motion:
      motion_.push_back(std::move(step));
      break;
    case Stage::field:
      field_.push_back(std::move(step));
      break;
    case Stage::bridge:
      bridge_.push_back(std::move(step));
      break;
    case Stage::chain:
      chain_.push_back(std::move(step));
      break;
    case Stage::record:
      if (alpha == AlphaIs::reference) // undone in the reverse of the order in which they act
        reference_.insert(reference_.begin(), step);
      later_.push_back(std::move(step));
      break;
    case Stage::sampler:
    case Stage::converter:
      later_.push_back(std::move(step));
      break;
    }
  }
}

void ForwardModel::until_sampler(Wave &w, double delay_s, const double *shaft) const {
  for (std::size_t i = 0; i < w.n; ++i) {
    double a = shaft[i];
    if (delay_s != 0.0) {
      a -= w.at.omega[i] * delay_s;
      if (w.at.accel)
        a += 0.5 * w.at.accel[i] * delay_s * delay_s;
    }
    w.alpha[i] = a;
    w.temp[i] = w.at.temp ? w.at.temp[i] - temp_reference_v_ : 0.0;
  }
  w.delay_s = delay_s;
  sincos_of(w.alpha, w.n, w.fy, w.fx);
  for (const Step &step : field_)
    step.effect->apply(step.values, w);
  if (field_.empty() && periods_ != 2) { // the field points where the magnet does
    double x[kWaveBlock];
    for (std::size_t i = 0; i < w.n; ++i)
      x[i] = periods_ * w.alpha[i];
    sincos_of(x, w.n, w.ey, w.ex);
  } else
    electrical(w);
  std::copy(w.ex, w.ex + w.n, w.c);
  std::copy(w.ey, w.ey + w.n, w.s);
  for (const Step &step : bridge_)
    step.effect->apply(step.values, w);
  for (std::size_t i = 0; i < w.n; ++i) {
    w.s[i] *= baseline_.amplitude_v;
    w.c[i] *= baseline_.amplitude_v;
    w.offset_s[i] = w.offset_c[i] = 0.0;
    w.add_offset(i, baseline_.offset_sin_v, baseline_.offset_cos_v);
  }
  for (const Step &step : chain_)
    step.effect->apply(step.values, w);
  if (!remainder_.empty())
    add_remainder(w);
}

void ForwardModel::add_remainder(Wave &w) const {
  double x[kWaveBlock];
  for (std::size_t i = 0; i < w.n; ++i)
    x[i] = remainder_periods_ * w.alpha[i];
  add_fourier_pair(x, w.n, remainder_, w.s, w.c);
}

void ForwardModel::motion(Wave &w, double *shaft, double *speed) const {
  std::copy(w.at.alpha, w.at.alpha + w.n, shaft);
  for (const Step &step : reference_)
    step.effect->shaft_from_reference(step.values, w.at, {shaft, w.n});
  if (!reference_.empty()) {
    // The reference's own ripple is in its speed as well: what the shaft does while it moves by a
    // little.
    constexpr double kLittle = 1e-4;
    double moved[kWaveBlock];
    for (std::size_t i = 0; i < w.n; ++i)
      moved[i] = w.at.alpha[i] + kLittle;
    for (const Step &step : reference_)
      step.effect->shaft_from_reference(step.values, w.at, {moved, w.n});
    if (w.at.omega != nullptr)
      for (std::size_t i = 0; i < w.n; ++i)
        speed[i] = w.at.omega[i] * (moved[i] - shaft[i]) / kLittle;
    w.at.omega = w.at.omega != nullptr ? speed : nullptr;
    w.at.alpha = shaft;
  }
  std::copy(shaft, shaft + w.n, w.alpha);
  for (const Step &step : motion_)
    step.effect->apply(step.values, w);
}

void ForwardModel::magnet_angle(const Conditions &at, double *alpha) const {
  Wave w;
  double shaft[kWaveBlock], speed[kWaveBlock];
  for (std::size_t first = 0; first < at.n; first += kWaveBlock) {
    w.n = std::min(kWaveBlock, at.n - first);
    w.at = at.slice(first, w.n);
    motion(w, shaft, speed);
    std::copy(w.alpha, w.alpha + w.n, alpha + first);
  }
}

void ForwardModel::block(const Conditions &at, double *vsin_v, double *vcos_v, Wave &w) const {
  w.n = at.n;
  w.at = at;
  double shaft[kWaveBlock], speed[kWaveBlock];
  motion(w, shaft, speed);
  for (std::size_t i = 0; i < w.n; ++i)
    shaft[i] = w.alpha[i] + baseline_.angle_zero_deg * kRadPerDeg;

  if (taps_.trivial()) {
    until_sampler(w, 0.0, shaft);
  } else {
    double s[kWaveBlock] = {}, c[kWaveBlock] = {};
    std::vector<double> done;
    for (const auto *taps : {&taps_.sin, &taps_.cos})
      for (const Tap &tap : *taps) {
        if (std::find(done.begin(), done.end(), tap.delay_s) != done.end())
          continue;
        done.push_back(tap.delay_s);
        until_sampler(w, tap.delay_s, shaft);
        for (const Tap &other : taps_.sin)
          if (other.delay_s == tap.delay_s)
            for (std::size_t i = 0; i < w.n; ++i)
              s[i] += other.weight * w.s[i];
        for (const Tap &other : taps_.cos)
          if (other.delay_s == tap.delay_s)
            for (std::size_t i = 0; i < w.n; ++i)
              c[i] += other.weight * w.c[i];
      }
    std::copy(s, s + w.n, w.s);
    std::copy(c, c + w.n, w.c);
  }
  for (std::size_t i = 0; i < w.n; ++i) {
    w.s[i] += mid_v_;
    w.c[i] += mid_v_;
  }
  for (const Step &step : later_)
    step.effect->apply(step.values, w);
  std::copy(w.s, w.s + w.n, vsin_v);
  std::copy(w.c, w.c + w.n, vcos_v);
}

void ForwardModel::evaluate(const Conditions &at, double *vsin_v, double *vcos_v) const {
  Wave w;
  w.amplitude_v = baseline_.amplitude_v;
  w.mid_v = mid_v_;
  w.periods = periods_;
  w.apart_rad = apart_rad_;
  for (std::size_t first = 0; first < at.n; first += kWaveBlock) {
    const std::size_t count = std::min(kWaveBlock, at.n - first);
    block(at.slice(first, count), vsin_v + first, vcos_v + first, w);
  }
}

} // namespace ada

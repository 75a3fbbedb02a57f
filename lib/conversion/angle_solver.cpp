// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "conversion/angle_solver.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/angle.h"
#include "base/pick.h"
#include "base/robust.h"
#include "conversion/sample_status.h"
#include "model/wires.h"
#include "motion/kinematics.h"
#include "motion/surroundings.h"

namespace ada {

namespace {

/// Newton doubles the digits: from a twentieth of the circle, four times. The short waves of a
/// remainder end that sooner, and some angles then take longer.
constexpr int kIterations = 4, kIterationsOfRemainder = 24;
/// rad; a further step would be this one's square.
constexpr double kConverged = 1e-9;
/// For the slope, in rad of the angle and of the highest order of a remainder.
constexpr double kStep = 1e-4, kStepOfHighest = 0.02;

std::uint32_t status_of(double vsin, double vcos, double radius, double supply_v) {
  if (!std::isfinite(vsin) || !std::isfinite(vcos))
    return ADA4571_SAMPLE_INVALID;
  return radius_status(radius) | rail_status(vsin, vcos, supply_v);
}

bool needs_motion(const Model &model) {
  Taps taps;
  for (const EffectInstance &e : model.effects) {
    e.effect->dynamics(e.values, taps);
    if (e.effect->info().remembers)
      return true;
  }
  return !taps.trivial();
}

/// Median of the third differences of an angle: large when the motion is uneven. A reversal or a
/// sudden change of speed is in few of them, and no part of a turn makes it even.
double unevenness(std::span<const double> alpha) {
  // Over a twentieth of a turn and more, so that noise does not hide the ripple.
  double travel = 0.0;
  for (std::size_t i = 1; i < alpha.size(); ++i)
    travel += std::abs(alpha[i] - alpha[i - 1]);
  if (travel <= 0.0)
    return 0.0;
  const double per_sample = travel / static_cast<double>(alpha.size());
  const auto stride = static_cast<std::size_t>(std::clamp(0.6 / per_sample, 1.0, 1e6));
  std::vector<double> bends;
  for (std::size_t i = 0; i + 3 * stride < alpha.size(); ++i)
    bends.push_back(std::abs(alpha[i + 3 * stride] - 3.0 * alpha[i + 2 * stride] +
                             3.0 * alpha[i + stride] - alpha[i]));
  return bends.empty() ? 0.0 : quantile(std::move(bends), 0.5);
}

/// Columns of conditions for a capture.
struct Columns {
  SupplyOverTime supply;
  Derivatives of_supply{{}, {}};
  TemperatureOverTime temperature;
  Kinematics motion;
  std::vector<float> vtemp, omega; ///< as the conditions take them
  /// `supply_fraction`: rms of the supply that the model was fitted with; 0: it does not matter.
  /// `level_v`: where that supply counts from; nothing: from its mean here.
  Columns(const Capture &capture, double supply_fraction, std::optional<double> level_v)
      : supply(capture, level_v), temperature(capture, supply),
        vtemp(as_floats(temperature.vtemp_v)) {
    if (supply_fraction == 0.0)
      supply.unit.clear();
    for (float &x : supply.unit)
      x *= static_cast<float>(supply.scale / supply_fraction);
    of_supply = Derivatives(capture.time_s, supply.unit);
  }
  Conditions view(const Capture &c, double period_s) const {
    const auto data = [](const auto &v) { return v.empty() ? nullptr : v.data(); };
    return {.n = c.size(),
            .time = c.time_s.data(),
            .alpha = nullptr,
            .omega = data(omega),
            .accel = data(motion.accel),
            .direction = data(motion.direction),
            .travel = data(motion.travel),
            .temp = data(vtemp),
            .temp_rate = data(temperature.rate),
            .supply = data(supply.unit),
            .supply_rate = data(of_supply.rate),
            .supply_bend = data(of_supply.bend),
            .vtemp_scan = data(vtemp),
            .frame_period_s = period_s,
            .mid_shift_v = supply.mid_shift_v};
  }
};

/// Noise of a channel over the amplitude, where the model does not say.
constexpr double kNoiseOfAmplitude = 1e-3;

} // namespace

AngleSolver::AngleSolver(const Model &model)
    : model_(correctable_part(model)), forward_(model_), amplitude_v_(model.baseline.amplitude_v),
      centre_sin_v_(recorded_centre_v(model_)[0]), centre_cos_v_(recorded_centre_v(model_)[1]),
      zero_rad_(model.baseline.angle_zero_deg * kRadPerDeg), periods_(model.periods_per_turn),
      back_rad_(kBackBeyondNoise * model.noise_rms_v.value_or(kNoiseOfAmplitude * amplitude_v_) /
                (amplitude_v_ * model.periods_per_turn)),
      supply_fraction_(0.0), step_rad_(kStep), iterations_(kIterations) {
  for (const EffectInstance &e : model_.effects)
    if (follows_supply(e.effect->info()))
      supply_fraction_ = e.values[0];
  if (model_.remainder) {
    const double highest = static_cast<double>(model_.remainder->orders()) *
                           (model_.remainder->electrical ? periods_ : 1.0);
    step_rad_ = std::min(step_rad_, kStepOfHighest / highest);
    iterations_ = kIterationsOfRemainder;
  }
  find_sense();
}

void AngleSolver::find_sense() {
  // Over one period at rest: what bends the curve on the way averages out.
  std::array<double, 64> a, s, c, zero{};
  std::array<float, 64> at_rest{};
  std::array<signed char, 64> one;
  one.fill(1);
  const double step = kTwoPi / static_cast<double>(a.size());
  for (std::size_t k = 0; k < a.size(); ++k)
    a[k] = step * static_cast<double>(k) / periods_;
  forward_.evaluate({.n = a.size(),
                     .time = zero.data(),
                     .alpha = a.data(),
                     .omega = at_rest.data(),
                     .direction = one.data()},
                    s.data(), c.data());
  double travel = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const std::size_t next = (k + 1) % a.size();
    travel += wrap_centred(phase(s[next], c[next]) - phase(s[k], c[k]), kTwoPi);
  }
  backwards_ = travel < 0.0;
  double x = 0.0, y = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double psi = step * static_cast<double>(k);
    const double from_zero = phase(s[k], c[k]) + (backwards_ ? psi : -psi);
    x += std::cos(from_zero);
    y += std::sin(from_zero);
  }
  phase_at_zero_ = std::atan2(y, x);
}

double AngleSolver::phase(double vsin, double vcos) const {
  return std::atan2(vsin - centre_sin_v_, vcos - centre_cos_v_);
}

void AngleSolver::start(std::span<const double> vsin, std::span<const double> vcos,
                        std::span<double> alpha) const {
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    const double psi = phase(vsin[i], vcos[i]) - phase_at_zero_;
    alpha[i] = wrap((backwards_ ? -psi : psi) / periods_, kTwoPi / periods_);
  }
}

void AngleSolver::solve(const Conditions &at, std::span<const double> vsin,
                        std::span<const double> vcos, std::span<double> alpha,
                        std::span<double> radius) const {
  std::array<double, kWaveBlock> s0, c0, s1, c1, moved;
  std::array<float, kWaveBlock> at_rest{};
  std::array<signed char, kWaveBlock> ones;
  ones.fill(1);
  for (std::size_t first = 0; first < at.n; first += kWaveBlock) {
    const std::size_t n = std::min(kWaveBlock, at.n - first);
    Conditions here = at;
    here.alpha = alpha.data();
    here = here.slice(first, n);
    if (!here.omega)
      here.omega = at_rest.data();
    if (!here.direction)
      here.direction = ones.data();
    double longest = kTwoPi;
    for (int iteration = 0; iteration < iterations_ && longest > kConverged; ++iteration) {
      longest = 0.0;
      here.alpha = alpha.data() + first;
      forward_.evaluate(here, s0.data(), c0.data());
      for (std::size_t i = 0; i < n; ++i)
        moved[i] = alpha[first + i] + step_rad_;
      here.alpha = moved.data();
      forward_.evaluate(here, s1.data(), c1.data());
      for (std::size_t i = 0; i < n; ++i) {
        // The direction of the vector decides, not its length: an amplitude that is not the model's
        // (another temperature, an aged magnet) must not turn the angle.
        const double ms = s0[i] - centre_sin_v_, mc = c0[i] - centre_cos_v_;
        const double rs = vsin[first + i] - centre_sin_v_, rc = vcos[first + i] - centre_cos_v_;
        const double ds = (s1[i] - s0[i]) / step_rad_, dc = (c1[i] - c0[i]) / step_rad_;
        const double length2 = ms * ms + mc * mc;
        const double slope = length2 > 0.0 ? (ds * mc - dc * ms) / length2 : 0.0;
        const double turned = std::atan2(rs * mc - rc * ms, rs * ms + rc * mc);
        const double step = slope != 0.0 ? turned / slope : 0.0;
        const double limit = 0.3 / periods_;
        alpha[first + i] += std::clamp(step, -limit, limit);
        longest = std::max(longest, std::abs(step)); // a step that is no number does not count
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double ms = s0[i] - centre_sin_v_, mc = c0[i] - centre_cos_v_;
      const double r = std::hypot(vsin[first + i] - centre_sin_v_, vcos[first + i] - centre_cos_v_);
      radius[first + i] = r / std::max(std::hypot(ms, mc), 1e-9);
    }
  }
}

void AngleSolver::capture(const Capture &capture, std::span<ada4571_angle> out) const {
  const std::size_t n = capture.size();
  if (n == 0)
    return;
  const double period = kTwoPi / periods_;
  const double frame =
      n > 1 ? (capture.time_s.back() - capture.time_s.front()) / static_cast<double>(n - 1) : 0.0;
  Columns x(capture, supply_fraction_, model_.vdd_reference_v);
  std::vector<double> alpha(n), radius(n);
  start(capture.vsin_v, capture.vcos_v, alpha);
  for (double &a : alpha)
    if (!std::isfinite(a))
      a = 0.0;
  if (n > 1)
    unwrap(alpha, period);
  if (capture.has_reference()) {
    // The reference only says which part of the turn the record begins in.
    const double first = capture.reference_deg[0] * kRadPerDeg - alpha[0];
    const double shift = period * std::round(first / period);
    for (double &a : alpha)
      a += shift;
  }
  const auto run = [&](std::vector<double> a) {
    solve(x.view(capture, frame), capture.vsin_v, capture.vcos_v, a, radius);
    if (needs_motion(model_)) { // once more with the speed of the corrected angle
      x.motion = differentiate(capture.time_s, a, 10);
      x.omega = as_floats(x.motion.omega);
      solve(x.view(capture, frame), capture.vsin_v, capture.vcos_v, a, radius);
    }
    return a;
  };
  std::vector<double> best = run(alpha);
  if (!capture.has_reference() && periods_ > 1) {
    double lowest = unevenness(best);
    for (int part = 1; part < periods_; ++part) {
      std::vector<double> other = alpha;
      for (double &a : other)
        a += part * period;
      other = run(std::move(other));
      const double value = unevenness(other);
      if (value < lowest) {
        lowest = value;
        best = std::move(other);
      }
    }
    solve(x.view(capture, frame), capture.vsin_v, capture.vcos_v, best, radius);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t status =
        status_of(capture.vsin_v[i], capture.vcos_v[i], radius[i], model_.supply_v);
    const bool sound = (status & ADA4571_SAMPLE_INVALID) == 0;
    out[i] = {capture.time_s[i], sound ? wrap(best[i], period) * kDegPerRad : kAbsent, radius[i],
              status};
  }
  for (std::size_t gap : capture.gaps)
    if (gap < n)
      out[gap].status |= ADA4571_SAMPLE_GAP;
}

void AngleSolver::frames(std::span<const Frame> frames, std::span<ada4571_angle> out) {
  const double period = kTwoPi / periods_;
  constexpr double kSpeedTime = 0.002; ///< s, of the filter that follows the speed
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Frame &f = frames[i];
    out[i] = {f.time_s, kAbsent, kAbsent, ADA4571_SAMPLE_INVALID};
    if (!std::isfinite(f.vsin_v) || !std::isfinite(f.vcos_v))
      continue;
    double alpha, radius;
    start({&f.vsin_v, 1}, {&f.vcos_v, 1}, {&alpha, 1});
    const double dt = stream_.running ? f.time_s - stream_.time : 0.0;
    const double expected =
        stream_.running ? stream_.alpha + stream_.omega * dt
                        : (std::isfinite(f.reference_deg) ? f.reference_deg * kRadPerDeg : alpha);
    alpha += period * std::round((expected - alpha) / period);
    double mid_shift_v = 0.0;
    float supply = 0.0f;
    if (std::isfinite(f.vdd_v)) {
      stream_.vdd_count = std::min(stream_.vdd_count + 1.0, 1e5);
      stream_.vdd_mean += (f.vdd_v - stream_.vdd_mean) / stream_.vdd_count;
      mid_shift_v = 0.5 * (stream_.vdd_mean - model_.supply_v);
      if (supply_fraction_ != 0.0)
        supply = static_cast<float>(
            (f.vdd_v / model_.vdd_reference_v.value_or(stream_.vdd_mean) - 1.0) / supply_fraction_);
    }
    const float rate = 0.0f;
    const auto travel = static_cast<float>(stream_.sense * (alpha - stream_.turned));
    const bool has_temp = std::isfinite(f.vtemp_v);
    const float vtemp = as_float(f.vtemp_v), omega = as_float(stream_.omega);
    Conditions at{.n = 1,
                  .time = &f.time_s,
                  .alpha = nullptr,
                  .omega = &omega,
                  .accel = nullptr,
                  .direction = &stream_.sense,
                  .travel = &travel,
                  .temp = has_temp ? &vtemp : nullptr,
                  .temp_rate = has_temp ? &rate : nullptr,
                  .supply = supply_fraction_ != 0.0 ? &supply : nullptr,
                  .vtemp_scan = has_temp ? &vtemp : nullptr,
                  .frame_period_s = dt,
                  .mid_shift_v = mid_shift_v};
    solve(at, {&f.vsin_v, 1}, {&f.vcos_v, 1}, {&alpha, 1}, {&radius, 1});
    const std::uint32_t status = status_of(f.vsin_v, f.vcos_v, radius, model_.supply_v);
    out[i] = {f.time_s, wrap(alpha, period) * kDegPerRad, radius, status};
    if (stream_.running && dt > 0.0) {
      const double speed = (alpha - stream_.alpha) / dt;
      stream_.omega += (speed - stream_.omega) * -std::expm1(-dt / kSpeedTime);
    }
    // At rest the sense is that of the motion before: it changes with the angle, not with its
    // noise.
    if (!stream_.running)
      stream_.furthest = alpha;
    if (stream_.sense * (alpha - stream_.furthest) > 0.0)
      stream_.furthest = alpha;
    if (stream_.sense * (stream_.furthest - alpha) > back_rad_) {
      stream_.sense = static_cast<signed char>(-stream_.sense);
      stream_.turned = stream_.furthest;
      stream_.furthest = alpha;
    }
    stream_.running = true;
    stream_.time = f.time_s;
    stream_.alpha = alpha;
  }
}

} // namespace ada

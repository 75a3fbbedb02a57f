// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "simulation/generator.h"

#include <algorithm>
#include <cmath>

#include "base/angle.h"

namespace ada {

namespace {

constexpr double kVtempNoiseV = 0.0002; ///< assumed, both
constexpr double kVddNoiseV = 0.0001;

double value_of(const Model &model, std::string_view id, double fallback) {
  for (const EffectInstance &e : model.effects)
    if (e.effect->info().id == id)
      return e.values[0];
  return fallback;
}

} // namespace

struct Generator::Columns {
  std::vector<double> time, alpha;
  std::vector<float> omega, temp, accel, travel, rate, supply, supply_rate, supply_bend;
  std::vector<signed char> direction;
  explicit Columns(std::size_t n)
      : time(n), alpha(n), omega(n), temp(n), accel(n), travel(n), rate(n), supply(n),
        supply_rate(n), supply_bend(n), direction(n) {}
  Conditions view(double period_s, bool vtemp_scanned) const {
    return {.n = time.size(),
            .time = time.data(),
            .alpha = alpha.data(),
            .omega = omega.data(),
            .accel = accel.data(),
            .direction = direction.data(),
            .travel = travel.data(),
            .temp = temp.data(),
            .temp_rate = rate.data(),
            .supply = supply.data(),
            .supply_rate = supply_rate.data(),
            .supply_bend = supply_bend.data(),
            .vtemp_scan = vtemp_scanned ? temp.data() : nullptr,
            .frame_period_s = period_s};
  }
};

Generator::Generator(const Simulation &simulation)
    : model_(simulation.model()), options_(simulation.options()), forward_(model_),
      speed_(parse_motion(options_.motion, options_.duration_s)),
      temperature_(parse_temperature(options_.temperature, options_.duration_s)),
      rng_(simulation.seed()), effects_(in_physical_order(model_.effects)),
      memory_(effects_.size()) {
  std::uniform_real_distribution<double> turn(0.0, kTwoPi);
  supply_phase_slow_ = turn(rng_);
  supply_phase_fast_ = turn(rng_);
  start_angle_ = turn(rng_);
  // The source of these two wave forms is here; the effects only act on them.
  lag_s_ = value_of(model_, "temperature-lag", 0.0);
  supply_rms_ = value_of(model_, "supply-variation", 0.0);
}

void Generator::conditions(std::size_t count, Columns &x) {
  const double period = 1.0 / options_.sample_rate_hz;
  const double volts = model_.supply_v * kVtempFractionPerDegree;
  const double zero = model_.supply_v * kVtempFractionAtZero;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(index_ + i) * period;
    x.time[i] = t;
    x.alpha[i] = start_angle_ + speed_.integral(t);
    x.omega[i] = static_cast<float>(speed_.value(t));
    x.accel[i] = static_cast<float>(speed_.slope(t));
    x.direction[i] = x.omega[i] < 0.0f ? -1 : 1;
    if (x.direction[i] != sense_ && index_ + i > 0)
      turned_ = i > 0 ? x.alpha[i - 1] : x.alpha[i];
    sense_ = x.direction[i];
    x.travel[i] = static_cast<float>(std::abs(x.alpha[i] - turned_));
    const double bridge = zero + volts * temperature_.value(t);
    if (index_ + i == 0 || lag_s_ <= 0.0)
      vtemp_ = bridge;
    x.rate[i] = static_cast<float>(lag_s_ > 0.0 ? (bridge - vtemp_) / lag_s_
                                                : volts * temperature_.slope(t));
    x.temp[i] = static_cast<float>(vtemp_);
    if (lag_s_ > 0.0)
      vtemp_ += (bridge - vtemp_) * -std::expm1(-period / lag_s_);
    // Unit rms: a slow wander and a mains ripple.
    constexpr double kSlow = kTwoPi * 1.3, kFast = kTwoPi * 100.0;
    const double slow = 0.8 * std::sqrt(2.0), fast = 0.6 * std::sqrt(2.0);
    const double a = kSlow * t + supply_phase_slow_, b = kFast * t + supply_phase_fast_;
    x.supply[i] = static_cast<float>(slow * std::sin(a) + fast * std::sin(b));
    x.supply_rate[i] = static_cast<float>(slow * kSlow * std::cos(a) + fast * kFast * std::cos(b));
    x.supply_bend[i] = static_cast<float>(-slow * kSlow * kSlow * std::sin(a) -
                                          fast * kFast * kFast * std::sin(b));
  }
}

double Generator::quantised(double volts) const {
  if (options_.adc_bits <= 0)
    return volts;
  const double lsb = options_.adc_reference_v / std::ldexp(1.0, options_.adc_bits);
  const double top = std::ldexp(1.0, options_.adc_bits) - 1.0;
  return std::clamp(std::round(volts / lsb), 0.0, top) * lsb;
}

void Generator::disturb(const Conditions &at, Capture &capture) {
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < capture.size(); ++i) {
    capture.vsin_v[i] += options_.noise_rms_v * normal(rng_);
    capture.vcos_v[i] += options_.noise_rms_v * normal(rng_);
  }
  for (std::size_t i = 0; i < effects_.size(); ++i) {
    Take take{model_, at, options_.duration_s, rng_, memory_[i], capture};
    effects_[i].effect->record(effects_[i].values, take);
  }
  for (double &r : capture.reference_deg)
    r = wrap(r, 360.0);
  for (auto *column : {&capture.vsin_v, &capture.vcos_v, &capture.vtemp_v})
    for (double &v : *column)
      v = quantised(v);
}

Capture Generator::next(std::size_t count) {
  Columns x(count);
  conditions(count, x);
  Capture capture;
  capture.time_s = x.time;
  capture.vsin_v.resize(count);
  capture.vcos_v.resize(count);
  const Conditions at = x.view(1.0 / options_.sample_rate_hz, options_.has_vtemp);
  forward_.evaluate(at, capture.vsin_v.data(), capture.vcos_v.data());
  std::normal_distribution<double> normal;
  if (options_.has_vtemp)
    for (std::size_t i = 0; i < count; ++i)
      capture.vtemp_v.push_back(x.temp[i] * (1.0 + supply_rms_ * static_cast<double>(x.supply[i])) +
                                kVtempNoiseV * normal(rng_));
  if (options_.has_vdd)
    for (std::size_t i = 0; i < count; ++i)
      capture.vdd_v.push_back(model_.vdd_reference_v.value_or(model_.supply_v) *
                                  (1.0 + supply_rms_ * static_cast<double>(x.supply[i])) +
                              kVddNoiseV * normal(rng_));
  if (options_.has_reference)
    for (std::size_t i = 0; i < count; ++i)
      capture.reference_deg.push_back(x.alpha[i] * kDegPerRad);
  disturb(at, capture);
  index_ += count;
  return capture;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Kalman filter of a value that drifts at a slowly changing rate. A constant drift is followed
// without lag, because each measurement counts for the time at which it was taken and the rate
// carries it to the present.
#pragma once

#include <algorithm>
#include <cmath>

namespace ada {

class TrendFilter {
public:
  /// `max_rate`: drift that is believed, per second. `start_error`: what the value may be off by at
  /// the beginning.
  TrendFilter(double max_rate, double start_error)
      : max_rate_(max_rate), p00_(start_error * start_error),
        p11_(kTypical * kTypical * max_rate * max_rate), rate_noise_(2 * p11_ / kCorrelation_s) {}

  /// Value at time t. Beyond `horizon` seconds after the last measurement the rate is not believed
  /// any longer: a drift that was seen may have ended since.
  double at(double t) const {
    const double ahead = std::max(t - time_, 0.0);
    return value_ + rate_ * std::min(ahead, horizon_);
  }
  double rate() const { return rate_; }

  /// Starts the clock.
  void begin(double t) { time_ = t; }
  /// The rate is forgotten: nothing is seen any more.
  void hold(double t) {
    value_ = at(t);
    spread(t - time_);
    time_ = std::max(t, time_);
    rate_ = 0;
    p01_ = 0;
    p11_ = kTypical * kTypical * max_rate_ * max_rate_;
  }
  /// Largest step from the prediction that a believable drift explains at time t.
  double believable(double t, double measured_error) const {
    const double dt = std::max(t - time_, 0.0);
    return 2 * max_rate_ * dt + 5 * std::sqrt(p00_) + 5 * measured_error;
  }
  /// `innovation`: measured minus at(t), of standard error `error`.
  void update(double t, double innovation, double error, double horizon) {
    const double predicted = at(t);
    spread(t - time_);
    time_ = std::max(t, time_);
    const double s = p00_ + error * error;
    const double g0 = p00_ / s, g1 = p01_ / s;
    value_ = predicted + g0 * innovation;
    rate_ = std::clamp(rate_ + g1 * innovation, -max_rate_, max_rate_);
    p11_ -= g1 * p01_;
    p01_ -= g0 * p01_;
    p00_ -= g0 * p00_;
    horizon_ = horizon;
  }

  /// The same for the rate, measured at the time of the last update.
  void update_rate(double innovation, double error) {
    if (!std::isfinite(error))
      return;
    const double s = p11_ + error * error;
    const double g0 = p01_ / s, g1 = p11_ / s;
    value_ += g0 * innovation;
    rate_ = std::clamp(rate_ + g1 * innovation, -max_rate_, max_rate_);
    p00_ -= g0 * p01_;
    p01_ -= g1 * p01_;
    p11_ -= g1 * p11_;
  }

private:
  static constexpr double kTypical = 0.1;        ///< usual rate, of the greatest one believed
  static constexpr double kCorrelation_s = 10.0; ///< after which a rate may be another one

  void spread(double dt) {
    if (!(dt > 0))
      return;
    const double q = rate_noise_;
    p00_ += 2 * dt * p01_ + dt * dt * p11_ + q * dt * dt * dt / 3;
    p01_ += dt * p11_ + q * dt * dt / 2;
    p11_ = std::min(p11_ + q * dt, max_rate_ * max_rate_);
  }

  double max_rate_;
  double time_ = 0, value_ = 0, rate_ = 0, horizon_ = 0;
  double p00_, p01_ = 0, p11_, rate_noise_;
};

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Pieces that several effects share.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/angle.h"
#include "base/sincos.h"
#include "model/effect.h"
#include "model/residual.h"

namespace ada {

inline constexpr double kInf = std::numeric_limits<double>::infinity();

/// Channel parameters: 0 is VSIN, 1 is VCOS.
inline double *channel_of(Wave &w, double channel) {
  return channel < 0.5 ? w.s : w.c;
}
inline std::vector<double> &channel_of(Capture &capture, double channel) {
  return channel < 0.5 ? capture.vsin_v : capture.vcos_v;
}

/// Effects whose parameters end in an amplitude and a phase in degrees: fitted as x, y of
/// amplitude * (cos, sin)(multiplicity * phase), where the two parameters are singular at zero.
class PolarEffect : public Effect {
public:
  std::vector<double> to_coordinates(Values v) const override {
    const double phase = multiplicity() * v[phase_index()] * kRadPerDeg;
    const double amplitude = v[amplitude_index()];
    return {amplitude * std::cos(phase), amplitude * std::sin(phase)};
  }
  std::vector<double> from_coordinates(Values v, std::span<const double> x) const override {
    std::vector<double> out(v.begin(), v.end());
    out[amplitude_index()] = std::hypot(x[0], x[1]);
    out[phase_index()] =
        wrap(std::atan2(x[1], x[0]) * kDegPerRad / multiplicity(), 360.0 / multiplicity());
    return out;
  }
  std::vector<double> steps(Values) const override {
    const double h = info().parameters[amplitude_index()].step;
    return {h, h};
  }

protected:
  virtual std::size_t amplitude_index() const { return 0; }
  virtual std::size_t phase_index() const { return 1; }
};

/// Where the transfer of a channel is straight: absent at mid-supply, 1 at the channel's own
/// offset, which then comes after the bent stage and not before it.
inline constexpr ParameterInfo kOrigin{"origin", "1", std::numeric_limits<double>::quiet_NaN(),
                                       0.0,      1.0, Role::chosen};

/// A transfer error of order n: adds g A x^n to each channel, x = signal/A from its origin.
class TransferError : public Effect {
public:
  void apply(Values v, Wave &w) const override;
  std::vector<std::vector<double>> choices(Values v) const override;

protected:
  virtual int order() const = 0;
};

/// The reference's own periodic error: it reads alpha + e sin(n alpha + phase). Whoever names it
/// says where n comes from.
class ReferenceError : public PolarEffect {
public:
  void shaft_from_reference(Values v, const Conditions &at, std::span<double> angle) const override;
  OrderRipple reference_ripple(Values v) const override;
  void record(Values v, Take &take) const override;
  std::string invisible(const Residual &r) const override;

protected:
  virtual double order(Values v) const = 0;
};

/// Why a capture does not tell an error of the field's direction from a ripple of the shaft of the
/// same order; empty where it does.
std::string looks_like_ripple(const Residual &r, const std::string &of_order);

/// Why what adds to the field of one magnet on the axis is not to be seen; empty where that may be
/// what turns. An AMR pair passes two periods with it, and any other pair one. With more of them a
/// ring of poles turns the field as often: a constant field comes with each pole there, and so does
/// the place of the sensor.
std::string turns_with_poles(const Residual &r);

/// Which of sensor and reference is at fault.
inline constexpr std::string_view kSteadySpin =
    "capture a steady spin: whichever of sensor and reference keeps uniform time is the innocent "
    "one; or turn the reference on the shaft by a part of its period";

/// A random smooth course over a capture, with zero mean and an rms of 1 over its duration: a sum
/// of cosines with periods from a tenth of the duration on. Kept as plain numbers from one part of
/// a capture to the next.
class SlowCourse {
public:
  static void draw(double duration_s, Rng &rng, std::vector<double> &numbers);
  static constexpr std::size_t kNumbers = 1 + 3 * 6;
  explicit SlowCourse(std::span<const double> numbers) : numbers_(numbers) {}
  double operator()(double time_s) const;

private:
  std::span<const double> numbers_; ///< mean, then rate (rad/s), phase and amplitude of each cosine
};

/// The duration over which what has no end is drawn, s.
inline constexpr double kEndless = 100.0;

/// Multiplies the vector of one sample, seen from the centre of its circle, by re + j im.
void turn_vector(Take &take, std::size_t i, double re, double im);

/// Starting points that differ in one chosen parameter, everything else absent.
std::vector<std::vector<double>> one_of_each(std::size_t parameters, std::size_t index, int first,
                                             int last);

/// Adds the orders that the residual shows as lines and `out` does not try yet: teeth, poles and
/// balls come at any. `order` is the first parameter.
enum class Orders { any, whole };
void add_orders_seen(const Residual &residual, const ParameterInfo &order, Orders which,
                     std::vector<std::vector<double>> &out);

} // namespace ada

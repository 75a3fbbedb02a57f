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
  virtual double multiplicity() const { return 1.0; }
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

/// Starting points that differ in one chosen parameter, everything else absent.
std::vector<std::vector<double>> one_of_each(std::size_t parameters, std::size_t index, int first,
                                             int last);

} // namespace ada

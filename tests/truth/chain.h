// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// From the unit signal of a bridge to the voltage at the sensor's output.
///
/// In the order in which it happens: gain and its mismatch and drift, offset and its drift,
/// harmonic distortion, transfer errors (q2 A x^2 and q3 A x^3 of x = signal/A, the signal
/// with its offset, as the amplifier sees it), supply (all outputs are ratiometric), clipping.
/// The low pass behind all this has memory and is run by the sampler.

#pragma once

#include "bridge.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace truth {

struct Harmonic {
  Channel channel = Channel::sine;
  int order = 0;
  double amplitude = 0.0; // relative to A
  double phase = 0.0;     // rad: adds amplitude A sin(order psi + phase)
};

/// Offset, drift and steps of one channel; \p drift and \p curvature per V of VTEMP.
struct ChannelOffset {
  double offset = 0.0;    // V
  double drift = 0.0;     // V/V
  double curvature = 0.0; // V/V^2
  double step = 0.0;      // V
};

struct ClipLevels {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

struct Chain {
  double supply = 5.0;          // V, nominal
  double amplitude = 1.45;      // V
  double mismatch = 0.0;        // k
  double amplitude_drift = 0.0; // relative, per V of VTEMP
  double vtemp_centre = 0.0;    // V: VTEMP about which the drifts are counted
  ChannelOffset sine, cosine;
  double step_time = 0.0;
  double quadratic = 0.0;         // q2
  double cubic = 0.0;             // q3
  bool offset_after_bend = false; // the bent stage comes before the offset is added
  std::vector<Harmonic> harmonics;
  ClipLevels clip_sine, clip_cosine;
  double low_pass_corner = 0.0; // Hz; 0: none

  /// \p unit is the bridge's signal, \p psi the electrical angle that it stands for,
  /// \p vtemp the VTEMP of the bridge's true temperature, \p gain and \p extra what an effect
  /// outside the catalogue adds, \p supply_ratio VDD/nominal.
  double output(Channel channel, double unit, double psi, double vtemp, double t, double gain,
                double extra, double supply_ratio) const {
    const bool is_sine = channel == Channel::sine;
    const ChannelOffset &o = is_sine ? sine : cosine;
    const double warm = vtemp - vtemp_centre;
    double signal = amplitude * gain * (1 + (is_sine ? mismatch : -mismatch) / 2) *
                    (1 + amplitude_drift * warm) * unit;
    double offset = o.offset + o.drift * warm + o.curvature * warm * warm + extra;
    if (o.step != 0.0 && t >= step_time)
      offset += o.step;
    signal += offset;
    for (const Harmonic &harmonic : harmonics)
      if (harmonic.channel == channel)
        signal += harmonic.amplitude * amplitude * std::sin(harmonic.order * psi + harmonic.phase);
    const double x = (signal - (offset_after_bend ? offset : 0.0)) / amplitude;
    signal += amplitude * (quadratic * x * x + cubic * x * x * x);
    const double volts = supply_ratio * (supply / 2 + signal);
    const ClipLevels &clip = is_sine ? clip_sine : clip_cosine;
    return std::clamp(volts, clip.low, clip.high);
  }
};

} // namespace truth

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// The sample clock, the order of conversions, and the multiplexer.
///
/// - Clock: runs a few ppm off its nominal rate and jitters by nanoseconds; the time column
///   shows neither. A larger jitter is an effect outside the catalogue.
/// - Skew: VCOS is taken dt after VSIN.
/// - Memory: the sampling capacitor keeps a part m of what it held before, in scan order VSIN,
///   VCOS, VTEMP: u_n = (1 - m) v_n + m u_(n-1).

#pragma once

namespace truth {

struct Sampler {
  double rate = 10000.0;    // S/s
  double clock_error = 0.0; // relative
  double jitter = 5e-9;     // s rms
  double skew = 0.0;        // s
  double memory = 0.0;      // m
  bool scans_vtemp = true;
};

class Multiplexer {
public:
  explicit Multiplexer(double memory, double first) : memory_(memory), held_(first) {}
  double operator()(double volts) { return held_ = (1 - memory_) * volts + memory_ * held_; }

private:
  double memory_;
  double held_;
};

} // namespace truth

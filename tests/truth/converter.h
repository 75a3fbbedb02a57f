// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// The supply, what is picked up on the lines, noise, and the analog to digital converter.
///
/// - Supply: VDD(t) = V0 (1 + sum of slow lines). All of the sensor's outputs follow it, the
///   converter's reference does not.
/// - Quantisation: code = round(v / lsb), lsb = reference / 2^bits, held to the code range.
/// - Spikes: hit both channels of a sample, each with its own sign and height.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace truth {

struct SupplyLine {
  double amplitude = 0.0; // relative
  double rate = 0.0;      // rad/s
  double phase = 0.0;
};

struct Supply {
  double ratio = 1.0; // mean VDD / nominal
  std::vector<SupplyLine> lines;

  double at(double t) const {
    double sum = 1.0;
    for (const SupplyLine &line : lines)
      sum += line.amplitude * std::sin(line.rate * t + line.phase);
    return ratio * sum;
  }
};

struct Tone {
  double frequency = 0.0; // Hz
  double sine = 0.0;      // V peak
  double cosine = 0.0;    // V peak
  double phase = 0.0;     // rad
};

struct Spike {
  std::size_t sample = 0;
  double sine = 0.0; // V
  double cosine = 0.0;
};

enum class StuckAt { last_value, low_rail, high_rail, middle };

struct Stuck {
  bool active = false;
  bool sine = false; // else cosine
  double time = 0.0; // s
  StuckAt at = StuckAt::last_value;
};

struct Converter {
  int bits = 16;
  double reference = 5.0;    // V
  double noise = 0.5e-3;     // V rms: what the metadata states
  double excess_noise = 0.0; // V rms on top of it
  double vtemp_noise = 0.5e-3;
  double vdd_noise = 0.1e-3;
  std::vector<Tone> tones;
  std::vector<Spike> spikes; // in the order of samples
  Stuck stuck;

  double quantise(double volts) const {
    const double lsb = reference / std::ldexp(1.0, bits);
    return lsb * std::clamp(std::round(volts / lsb), 0.0, std::ldexp(1.0, bits) - 1);
  }
};

} // namespace truth

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The simulated sensor: the forward model, a motion, a temperature, noise and a converter, seeded.
// The same seed, model and options give the same capture.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "acquisition/source.h"
#include "model/model.h"
#include "recording/capture.h"

namespace ada {

struct SimulationOptions {
  double sample_rate_hz = 10000.0;
  double duration_s = 7.0; ///< 0: without end
  double noise_rms_v = 0.0005;
  int adc_bits = 16; ///< 0: not quantised
  double adc_reference_v = 5.0;
  std::string motion = "steps:rpm=300/900/-900/-300";
  std::string temperature = "constant:deg_c=25";
  bool gain_control = true;
  bool has_vtemp = true, has_vdd = true, has_reference = true;
};

/// Of a simulation with an end.
inline constexpr double kMostSimulatedSamples = 1e8;

/// VTEMP over the supply, read with two digits from a published graph of the part at 3.3 V: 23.3 %
/// of VDD at 0 degrees Celsius and 3.33 mV/V more a degree. Assumed, not a limit of the part.
inline constexpr double kVtempFractionAtZero = 0.233;
inline constexpr double kVtempFractionPerDegree = 0.00333;

/// A sound ADA4571: amplitude 0.29 VDD (assumed), offsets and their drift drawn from the seed, the
/// drift in part proportional to the offset. With the gain control off the amplitude falls by
/// 0.3 % a degree (assumed).
Model sound_sensor(std::uint64_t seed, double supply_v, bool gain_control);

class Simulation {
public:
  /// `model` absent: sound_sensor(). Throws Error on options out of range.
  Simulation(std::optional<Model> model, SimulationOptions options, std::uint64_t seed);

  const Model &model() const { return model_; }
  const SimulationOptions &options() const { return options_; }
  std::uint64_t seed() const { return seed_; }

  /// The whole capture. Needs a duration.
  Capture run() const;
  /// A stream of the same frames; realtime paces it by the clock.
  std::unique_ptr<Source> source(bool realtime) const;

private:
  Model model_;
  SimulationOptions options_;
  std::uint64_t seed_;
};

} // namespace ada

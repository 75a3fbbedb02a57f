// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A model of one sensor: the note's baseline, the effects beyond it, and where they came from.
// A calibration is such a model; the TOML file (model_file.h) holds exactly this.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "model/remainder.h"

namespace ada {

class Effect; // effect.h

/// One effect of the catalogue with its numbers, in the units of its parameters.
struct EffectInstance {
  const Effect *effect = nullptr;
  std::vector<double> values;     ///< one a parameter of effect->info(); NaN = not present
  std::vector<double> std_errors; ///< the same length, or empty where unknown
};

/// The application note's model: s = A sin psi + O_sin, c = A cos psi + O_cos about VDD/2.
/// All voltages at the supply `supply_v`; everything is ratiometric, so another supply scales them.
struct Baseline {
  double amplitude_v = 1.45;
  double offset_sin_v = 0.0;
  double offset_cos_v = 0.0;
  double angle_zero_deg = 0.0; ///< mechanical: psi = p (alpha + zero)
};

/// What of a sensor's errors leaves the figure of the pair an ellipse, at every temperature.
struct EllipseParts {
  double k = 0.0, delta_rad = 0.0;                       ///< as in conversion/ellipse.h
  double tc_sin = 0.0, tc_cos = 0.0, tc_amplitude = 0.0; ///< V/V, V/V, 1/V: along VTEMP
  bool swapped = false, sin_inverted = false, cos_inverted = false;
};

struct Provenance {
  std::string serial;
  std::string date;             ///< ISO 8601, UTC
  std::string method;           ///< "single fit", "dual fit", "diagnose", ...
  std::string capture_identity; ///< Capture::identity of the data
  std::string generator;        ///< "libada4571 1.0.0"
  std::optional<double> vtemp_min_v, vtemp_max_v;
  std::optional<bool> gain_control;
  std::optional<double> fit_residual_rms_v, heldout_residual_rms_v;
};

struct Model {
  int periods_per_turn = 2;
  double supply_v = 5.0;
  Baseline baseline;
  Baseline baseline_std_error{0, 0, 0, 0}; ///< 0 where unknown
  double vtemp_reference_v = 0.0;          ///< temperature effects act on VTEMP minus this
  /// A recorded supply counts from here, V: its mean where the model was learnt; nothing: from the
  /// mean of each capture.
  std::optional<double> vdd_reference_v;
  std::optional<double> noise_rms_v;
  std::vector<EffectInstance> effects; ///< at most one of each type, harmonics and tones excepted
  std::optional<PeriodicRemainder> remainder; ///< what has no name
  Provenance provenance;

  /// The same model less the effect in this place of `effects`.
  Model without(std::size_t effect) const;

  /// Throws ADA4571_ERROR_UNUSABLE_DATA where `what`, a capture say, has other periods a turn than
  /// this model, which the message calls `name`.
  void require_periods(int here, const std::string &name, const std::string &what) const;

  /// The same model at another supply: voltages scale, ratios stay.
  Model at_supply(double volts) const;
};

/// What a model says of readings to come: the effects that may be taken out of the angle, and what
/// the events of its capture left behind.
Model correctable_part(const Model &model);

} // namespace ada

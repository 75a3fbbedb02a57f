// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What every effect of the catalogue knows about itself. One effect is one object in one file of
// effects/; the table in catalogue.cpp lists them. Simulation, correction, calibration and
// diagnosis are readers of these objects and know no effect by name.
#pragma once

#include <array>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/model.h"
#include "model/taps.h"
#include "model/wave.h"
#include "recording/capture.h"

namespace ada {

class Residual;  // residual.h: what the diagnosis shows an effect
struct Screened; // residual.h: what a first look at a capture found

/// Physical order: a signal passes the stages from top to bottom.
enum class Stage { motion, field, bridge, chain, sampler, converter, record };

std::string_view stage_name(Stage stage);

/// How a parameter takes part in a fit.
enum class Role {
  fitted, ///< continuous
  chosen, ///< found by a search and then held: an order, a channel, a moment
};

struct ParameterInfo {
  std::string_view name; ///< as in the catalogue: "k", "delta_deg", ...
  std::string_view unit; ///< "1", "V", "deg", "s", "Hz", "V/V", ...; "channel" prints vsin or vcos
  double fallback;       ///< value when `simulate --effect NAME` does not give it
  double minimum, maximum; ///< accepted range, inclusive
  Role role = Role::fitted;
  double step = 1e-4; ///< for finite differences: a size at which the effect is small and linear
};

/// Whether a parameter says where a cause lies rather than how much it does: it is not 0 where the
/// cause is absent.
inline bool is_place(const ParameterInfo &p) {
  return p.name == "order" || p.name == "frequency_hz" || p.name == "time_s";
}

/// An experiment that would tell this effect from a rival.
struct Separation {
  std::string_view rival;
  std::string_view experiment;
};

/// How a capture shows the effect, which decides how the diagnosis looks for it.
enum class Evidence {
  signal,    ///< a deterministic part of VSIN and VCOS: joint least squares
  screening, ///< seen before any fit: wiring, dead channels, lost samples, spikes
  noise,     ///< changes the noise, not the signal
  process,   ///< a slow random change, whose course is known only from the data
};

/// What happens to the vector of the two signals.
enum class Pattern {
  other,
  offset, ///< a shift, whatever the angle
  gain,   ///< along the vector, both channels in proportion
  turn,   ///< across the vector: the angle moves and the circle stays
};

/// What kind of thing the cause is.
enum class Character {
  fixed,    ///< the same again at the same angle and temperature
  dynamic,  ///< grows with a rate: of the rotation, of the temperature
  event,    ///< happens at a moment
  recorded, ///< follows a column of the record
  process,  ///< random, and slow against the samples
  white,    ///< random, each sample by itself
};

/// What of the record it makes useless.
enum class Spoils { nothing, readings, rows, peaks, channel };

struct EffectInfo {
  std::string_view id;    ///< identifier of the catalogue
  std::string_view cause; ///< one sentence for a person
  Stage stage;
  std::span<const ParameterInfo> parameters;
  bool correctable; ///< whether a reader may take it out of the angle
  Evidence evidence = Evidence::signal;
  bool signature = false; ///< names a shape whose physical cause is open: physical causes go first
  std::span<const Separation> separations = {};
  /// A simpler effect that goes first where the data cannot tell it from this one.
  std::string_view yields_to = {};
  /// Its wave form is a column of the record: nothing of higher order is left of it.
  bool recorded = false;
  /// On which most of it shows: angle, speed, temperature, supply, time, frequency or noise.
  std::string_view axis = "angle";
  Pattern pattern = Pattern::other;
  Character character = Character::fixed;
  /// Which of several causes that data cannot tell apart leads, the least first: 0 what every pair
  /// has; 1 drift, delay, skew, field errors; 2 transfer errors, memory and the rest; 3 signatures.
  int prior_rank = 2;
  Spoils spoils = Spoils::nothing;
  bool remembers = false; ///< a reading depends on those before it
  bool repeats = false; ///< may be there several times: at other orders, frequencies, moments
  bool affine = false;  ///< of the pair's two volts: an ellipse stays an ellipse
};

using Values = std::span<const double>;
using Rng = std::mt19937_64;

/// A ripple a cos(n alpha) + b sin(n alpha) with the mechanical angle.
struct OrderRipple {
  double order = 0.0, cos = 0.0, sin = 0.0; ///< n per turn (0: none); rad
};

/// One part of a capture while the simulation makes it.
struct Take {
  const Model &model;
  const Conditions &at; ///< the true ones, sample by sample
  double duration_s;    ///< of the whole capture; 0: without end
  Rng &rng;
  /// What the effect carries from one part to the next; empty at the first.
  std::vector<double> &memory;
  Capture &capture; ///< its reference is unwrapped here
};

/// What an effect adds to the pair where it is one line and nothing else: of so many periods in an
/// electrical period, or in a second.
struct OneLine {
  enum class Per { electrical_period, second } per;
  double periods = 0.0;
};

class Effect {
public:
  virtual ~Effect() = default;
  virtual const EffectInfo &info() const = 0;
  /// Why values that are each in their range make no sense together; empty when they do.
  virtual std::string contradiction(Values) const { return {}; }

  // --- what it does, each at its place in the physical order; the default does nothing

  /// Acts on one block at the effect's stage. `values` as in info().parameters.
  virtual void apply(Values, Wave &) const {}
  /// Linear dynamics before the sampler.
  virtual void dynamics(Values, Taps &) const {}
  /// From what the reference reads to the shaft's angle, rad, in place, for at most kWaveBlock
  /// samples; `at` as the reference shows it.
  virtual void shaft_from_reference(Values, const Conditions &, std::span<double>) const {}
  /// How much more than a quarter of a period VSIN leads VCOS, rad of the period.
  virtual double channels_apart_rad(Values) const { return 0.0; }
  /// The part of VCOS that VTEMP carries over, where VTEMP is in the scan.
  virtual double vtemp_on_vcos(Values) const { return 0.0; }
  /// What an event leaves behind for good: what is read after the capture begins there. False:
  /// nothing.
  virtual bool leaves_behind(Values, Baseline &) const { return false; }
  /// Error of one order of the turn that the reference itself shows against smooth time.
  virtual OrderRipple reference_ripple(Values) const { return {}; }
  /// Step in which the reference counts, rad; 0: none.
  virtual double reference_step_rad(Values) const { return 0.0; }
  /// Acts on a simulated capture: lost rows, spikes, wander, the reference column.
  virtual void record(Values, Take &) const {}

  /// Folds the effect into the ellipse of the pair. False: it does not fold.
  virtual bool fold(Values, EllipseParts &) const { return false; }

  /// The one line that the effect adds; nothing: it adds more, or moves what is there.
  virtual std::optional<OneLine> one_line(Values) const { return {}; }

  // --- how it is fitted

  /// Periods a turn of its direction or phase.
  virtual double multiplicity() const { return 1.0; }

  /// Coordinates in which the effect is smooth and zero means absent. The default: the fitted
  /// parameters themselves.
  virtual std::vector<double> to_coordinates(Values values) const;
  /// Back again; `values` gives the chosen parameters.
  virtual std::vector<double> from_coordinates(Values values, std::span<const double> x) const;
  /// Finite-difference step of each coordinate.
  virtual std::vector<double> steps(Values values) const;

  // --- how it is found

  /// Why this capture cannot show the effect at all; empty when it can.
  virtual std::string invisible(const Residual &) const { return {}; }
  /// What of the effect this capture cannot show, as opposed to the rest; empty: it shows all of
  /// it.
  virtual std::string invisible_part(const Residual &) const { return {}; }
  /// Whether a capture that shows the effect shows it with these values. Where it does not, they are
  /// an alternative to what looks the same.
  virtual bool shows(Values, const Residual &) const { return true; }
  /// Whether what was measured rules these values out, whatever the fit gains by them.
  virtual bool refuted(Values, const Residual &) const { return false; }
  /// The same by how the shaft moved against a reference: time, s, and angle, rad, of every usable
  /// sample.
  virtual bool refuted_by_motion(Values, std::span<const double>, std::span<const double>) const {
    return false;
  }
  /// Starting points, best first. Coordinates near zero mean: let the linear fit decide.
  virtual std::vector<std::vector<double>> guesses(const Residual &) const;
  /// Values with another choice of what no search for a place decides; the best is kept.
  virtual std::vector<std::vector<double>> choices(Values) const { return {}; }
  /// Evidence::screening: looks at the capture before any fit, marks what the fit must not use.
  virtual bool screen(Screened &) const { return false; }
};

/// All effects in physical order.
std::span<const Effect *const> catalogue();

/// The same effects in the order of the catalogue.
std::vector<EffectInstance> in_physical_order(std::vector<EffectInstance> effects);

/// The effect with this identifier, or nullptr.
const Effect *find_effect(std::string_view id);

// --- effects by what they are: whoever needs one asks for its kind

/// Scales the pair with the recorded supply.
inline bool follows_supply(const EffectInfo &e) {
  return e.recorded && e.axis == "supply";
}
/// Both channels late by one time.
inline bool is_common_delay(const EffectInfo &e) {
  return e.evidence == Evidence::signal && e.stage == Stage::chain && e.pattern == Pattern::turn &&
         e.character == Character::dynamic;
}
/// One line of the spectrum over time lies on both channels.
inline bool is_tone(const EffectInfo &e) {
  return e.axis == "frequency" && e.pattern == Pattern::offset && e.character == Character::process;
}
/// The angle jumps at one moment.
inline bool is_jump(const EffectInfo &e) {
  return e.pattern == Pattern::turn && e.character == Character::event;
}

/// The one effect of the catalogue of this kind. Throws Error where there is none or several.
const Effect &the_effect(bool (*is)(const EffectInfo &));
const Effect &the_effect_that_spoils(Spoils what);

inline const EffectInfo &effect_info(const Effect &effect) {
  return effect.info();
}

} // namespace ada

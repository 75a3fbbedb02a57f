// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What the diagnosis shows an effect: what a capture can show at all, and what the model so far
// leaves over. The finders below are shared by the effects that begin with a search.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "model/effect.h"
#include "recording/capture.h"

namespace ada {

/// What several effects ask of one residual: worked out at the first question, in one thread. A
/// copy, whose columns may be replaced, begins without it.
template <class Value> class AskedOften {
public:
  AskedOften() = default;
  AskedOften(const AskedOften &) {}
  AskedOften &operator=(const AskedOften &) {
    value_.reset();
    return *this;
  }
  template <class Work> const Value &get(Work work) const {
    if (!value_)
      value_ = work();
    return *value_;
  }

private:
  mutable std::optional<Value> value_;
};

/// The data minus the model so far, and what the capture holds. Arrays of one length, in time
/// order; samples that a fit must not use are left out.
class Residual {
public:
  bool has_reference = false, has_supply = false;
  bool both_directions = false, several_speeds = false;
  bool own_motion = false;        ///< the speed is known of whole periods of the pair only
  std::string why_no_temperature; ///< empty when the capture shows a range of temperatures
  double turns = 0.0;             ///< mechanical, whatever their sense
  double arc_turns() const;       ///< from one end of the motion to the other; asked often
  double fastest_omega = 0.0;     ///< rad/s, mechanical
  int periods = 2;
  double amplitude_v = 1.0, noise_v = 0.0, supply_v = 5.0;
  double centre_sin_v = 2.5, centre_cos_v = 2.5; ///< middle of the circle
  double sample_period_s = 0.0;
  double stretch_s = 0.0; ///< the longest without a pause of the record; 0: as long as the times
  std::span<const double> time;
  std::span<const float> omega;
  std::span<const signed char> sense; ///< of rotation, +-1; at rest that of the way there
  std::span<const double> sin_v, cos_v;             ///< residual
  std::span<const double> model_sin_v, model_cos_v; ///< absolute volts of the model so far
  /// Absolute volts as they were read: the residual above may be weighed, and is then not the rest.
  std::span<const float> read_sin_v, read_cos_v;
  std::span<const double> alpha;                    ///< mechanical angle, rad
  /// Absolute volts of the model without the effect that is asked; empty where nobody needs them.
  std::span<const double> without_sin_v, without_cos_v;
  AskedOften<std::vector<double>> orders;           ///< of find_orders
  AskedOften<double> slowest;                       ///< of slowest_speed
  AskedOften<double> arc;                           ///< of arc_turns
};

struct StepGuess {
  double time_s, first, second; ///< offsets: V in VSIN and VCOS; angle: rad mechanical and 0
};
enum class StepIn { angle, offsets };

/// Moments at which the mean of the residual changes: most suddenly, and most over the whole
/// record.
std::vector<StepGuess> find_steps(const Residual &residual, StepIn where);

/// Strongest lines of the residual's spectrum over time, as values of `periodic-interference`.
std::vector<std::vector<double>> find_tones(const Residual &residual);

/// Frequencies, Hz, at which gain and angle are modulated: the strongest lines of the residual's
/// parts along and across the vector.
std::vector<double> find_modulations(const Residual &residual);

/// Levels at which the signal stops below what the model expects, as values of `clipping`.
std::vector<std::vector<double>> find_clipping(const Residual &residual);

/// What comes round less often over the way from one end of a motion to the other is a course of the
/// motion, or of time, and no order of the turn.
inline constexpr double kFewestPeriodsOfOrder = 6.0;

/// Orders of the turn, whole or not, at which the angle of the residual shows lines against the
/// angle; the strongest first.
const std::vector<double> &find_orders(const Residual &residual);

/// Slowest speed, rad/s, of a motion that without a reference tells a ripple of the shaft, which
/// falls with the speed, from what the sensor makes of the same order; 0: it does not.
double slowest_speed(const Residual &residual);

/// A cause that is seen before any fit.
struct ScreenFinding {
  const Effect *effect;
  std::vector<double> values, std_errors;
  std::vector<std::string> alternatives;
  std::string explanation; ///< what the parameters do not say
};

/// A capture on its first look, and what came of it.
struct Screened {
  const Capture &capture;
  std::vector<char> usable = {};  ///< 0: a fit must not use this sample
  std::vector<double> angle = {}; ///< unwrapped mechanical angle from the pair itself, rad
  /// The pair at the mean supply, V, where one is recorded that moves the outputs; otherwise empty.
  std::vector<double> steady_sin_v = {}, steady_cos_v = {};
  const std::vector<double> &turning_sin_v() const {
    return steady_sin_v.empty() ? capture.vsin_v : steady_sin_v;
  }
  const std::vector<double> &turning_cos_v() const {
    return steady_cos_v.empty() ? capture.vcos_v : steady_cos_v;
  }
  double centre_sin_v = 2.5, centre_cos_v = 2.5; ///< middle of the circle
  std::vector<std::size_t> jumps = {};     ///< first sample after each jump of the angle over time
  std::vector<double> jump_rad = {};       ///< mechanical, beyond what the speed explains
  std::vector<std::size_t> jump_lost = {}; ///< samples lost there; 0 at a slip
  /// First sample after each jump that others undo, and how far ahead it goes, mechanical rad.
  std::vector<std::size_t> disorder = {};
  std::vector<double> disorder_rad = {};
  std::vector<std::size_t> lost_before = {}; ///< jumps in which an earlier look saw samples lost
  std::vector<std::uint32_t> spikes = {};    ///< samples with an isolated spike, ascending
  std::vector<ScreenFinding> findings = {};
  /// Rows in which a channel stands still: the first, and the one after the last.
  std::vector<std::pair<std::size_t, std::size_t>> stuck = {};
  double white_noise_v = 0.0; ///< sample-to-sample noise of one channel
  /// Whether the pair turns often enough that its own smooth motion shows jumps and losses.
  bool smooth = true;

  /// Mechanical turns that the pair makes, whatever their sense.
  double turns() const;
};

/// The spacing, rad, of which all spacings of a reference's readings are multiples; 0 where there
/// is none.
double reference_grid_rad(std::span<const double> reference_deg);
/// Whether it moves by the same from row to row, forth or back, in all but a few: as it was told
/// to, or as a counter that goes a whole number of its steps a row. Either has rounded nothing that
/// could be told.
bool goes_on_evenly(std::span<const double> reference_deg);

bool screen_spikes(Screened &look, const Effect &effect);
bool screen_stuck(Screened &look, const Effect &effect);
/// Levels that the readings of a channel reach in several peaks, stay on while the other channel
/// goes on, and never pass: findings of [low, high, channel], V. The readings on them are not
/// usable then: where the motion is the pair's own they give a wrong angle.
///
/// Any smooth peak is a parabola at its top: of two equal bands below the highest reading the upper
/// one holds 2.4 times as many readings of an even motion as the lower one, and while the channel
/// is in it the other one goes on by what lets it fall by one band. On a level there are far more,
/// and the other one goes on further.
bool screen_cut_peaks(Screened &look, const Effect &effect);
/// Whether the readings speak for levels as of `clipping`: where one acts in the model, what is
/// left of them does not go with the other channel as a round peak would, which is a parabola. Not
/// where they are too few to tell; true where the model without the levels was not worked out.
bool lie_on_levels(const Residual &residual, std::span<const double> levels);
bool screen_orientation(Screened &look, const Effect &effect);
bool screen_losses(Screened &look, const Effect &effect);
/// Width of the steps in which the reference moves, degrees; 0 where it does not, or where they are
/// too fine to matter.
double find_reference_step(const Screened &look);
/// The same where the shaft turns too unevenly for its differences to tell, from what is left of
/// the angle, mechanical rad, once the sensor and the reference are modelled: on a grid a count is
/// anywhere within half a step of where the shaft is, and nowhere else. `noise_rad`: of the pair.
double counted_step(std::span<const double> reference_deg, std::span<const double> off_rad,
                    double noise_rad);
bool screen_slip(Screened &look, const Effect &effect); ///< only where there is no reference

/// Places of isolated outliers: residuals that stand out of their neighbours by more than
/// `threshold` robust standard deviations, or of `floor_v` where that is larger.
void find_spikes(std::span<const double> residual, double threshold, double floor_v,
                 std::vector<std::size_t> &places);

/// Takes `samples` rows out of the capture at `events` random places; time runs on unbroken.
void drop_rows(std::size_t events, std::size_t samples, Rng &rng, Capture &capture);

} // namespace ada

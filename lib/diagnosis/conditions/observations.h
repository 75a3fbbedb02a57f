// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A capture made ready for fits: usable samples only, with the conditions under which each was
// taken, and split by whole revolutions into what fits may see and what only judges them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "diagnosis/conditions/dead_outputs.h"
#include "diagnosis/conditions/episodes.h"
#include "diagnosis/conditions/held_rows.h"
#include "diagnosis/conditions/holdout.h"
#include "diagnosis/conditions/level_gap.h"
#include "diagnosis/conditions/own_jumps.h"
#include "health/wrong_stretches.h"
#include "model/residual.h"
#include "model/wave.h"
#include "motion/reference_rows.h"
#include "recording/capture.h"

namespace ada {

class Coloured; // anonymous/discrepancy.h

enum class Direction { none, supply, motion, radius };

/// Columns of one length, in time order.
struct Observations {
  std::vector<double> time, alpha;
  /// Floats where they do: a long capture has no memory to spare. Of a pair they keep 24 bits, as
  /// much as any converter gives.
  std::vector<float> vsin, vcos, omega, accel;
  std::vector<signed char> direction;
  std::vector<float> travel; ///< empty without a reference
  /// From the reading of the reference to alpha, rad; empty unless several records have a zero
  /// angle each.
  std::vector<float> moved;
  std::vector<float> temp;   ///< empty without VTEMP, and so is its rate
  std::vector<float> temp_rate;
  std::vector<float> supply, supply_rate, supply_bend; ///< empty without VDD
  double frame_period_s = 0.0;
  double speed_reach_s = 0.0; ///< of omega, as in Conditions
  bool vtemp_scanned = false;
  /// Slope of VTEMP on VCOS: what a multiplexer would carry over. Standard error 0: not measured.
  double vtemp_on_vcos = 0.0, vtemp_on_vcos_error = 0.0;
  /// A disturbance that is not recorded moves the pair in a known direction: a supply along the
  /// absolute voltages, a rough motion without reference along the figure. Residuals in that
  /// direction weigh less, by this factor.
  Direction disturbed = Direction::none;
  double weight_along = 1.0;
  /// Whether a second capture is judged with offsets of its own.
  bool own_offsets = false;
  double mid_shift_v = 0.0; ///< of mid-supply by the recorded VDD, as in Conditions
  /// Middle of the figure, near enough for a direction, V.
  double centre_sin_v = 2.5, centre_cos_v = 2.5;
  /// The ellipse that the pair draws, x^T M x constant of (VSIN, VCOS) from the middle: M's
  /// elements sin sin, sin cos, cos cos. An error of the angle moves the pair along it, and not
  /// across the vector: of a reference that is off by much, what goes into the length by that would
  /// pass for noise of the sensor.
  std::array<double, 3> figure{1.0, 0.0, 1.0};
  double figure_v = 0.0; ///< its longer half axis; 0: not known
  /// Nothing but noise lies off the figure. What noise takes off a curve and what it takes along it
  /// are independent of each other at the nearest point and nowhere else: by its direction alone an
  /// ellipse comes out rounder than it is. Where more lies off it, as beside a step or a gain that
  /// wanders, the nearest point is none that the pair belongs to.
  bool noise_alone = false;

  /// What nobody can name, as a part of the noise of these samples; nullptr: white noise only.
  std::shared_ptr<const Coloured> coloured;

  std::size_t size() const { return time.size(); }
  /// The vector from the middle to a point of the figure, and its derivative.
  struct Place {
    std::array<double, 2> vector, along; ///< (VSIN, VCOS), V; V a radian of the electrical angle
    double long_axis_v, short_axis_v;    ///< half axes of the figure of that length
  };
  /// In the direction of this pair, and as long.
  Place place(double sin_v, double cos_v) const;
  /// How far along the figure, in electrical radians, the point of it that is nearest to a pair
  /// lies from the one in its direction; 0 unless `noise_alone`.
  double to_nearest(const Place &pair) const;
  /// The vector of a pair, turned to there.
  std::array<double, 2> nearest(double sin_v, double cos_v) const;
  /// Unit vector (VSIN, VCOS) out of the figure where the pair is there.
  std::array<double, 2> outward(double sin_v, double cos_v) const;
  /// Unit vector (VSIN, VCOS) of the disturbance at sample i. A supply moves what the model gives
  /// there, absolute volts: the measured pair carries noise, and a model that shrinks would seem to
  /// leave less of it across.
  std::array<double, 2> direction_at(std::size_t i, double model_sin, double model_cos) const;
  /// Makes pairs of residuals of one sample white: identity unless weight_along says otherwise.
  struct Whitener {
    double us, uc, weight; ///< along (us, uc)
    void operator()(double &sin, double &cos) const {
      if (weight == 1.0)
        return;
      const double along = weight * (sin * us + cos * uc), across = sin * uc - cos * us;
      sin = along * us + across * uc;
      cos = along * uc - across * us;
    }
  };
  Whitener whitener_at(std::size_t i, double model_sin, double model_cos) const;
  void whiten(std::size_t i, double model_sin, double model_cos, double &sin, double &cos) const {
    whitener_at(i, model_sin, model_cos)(sin, cos);
  }
  Conditions conditions() const;
  Observations select(const std::vector<std::uint32_t> &indices) const;
  /// The same in place, with one column more in memory at a time.
  void keep(const std::vector<std::uint32_t> &indices);
  bool operator==(const Observations &) const = default;
};

/// Single rows in which the reference alone is wrong: none of them is used.
struct WrongRows {
  std::size_t count = 0;
  double worst_rad = 0.0, squares_rad2 = 0.0; ///< of their departures; the sum over all
  WrongRows &operator+=(const WrongRows &more) {
    count += more.count;
    worst_rad = std::max(worst_rad, more.worst_rad);
    squares_rad2 += more.squares_rad2;
    return *this;
  }
};

/// What a capture as a whole can show.
struct Scene {
  const Capture *capture = nullptr;
  int periods = 2;
  double supply_v = 5.0;
  bool has_reference = false, both_directions = false, several_speeds = false;
  bool reference_errs = false; ///< in each row for itself
  /// Without a reference and with a shaft that turns too unevenly to be one itself: the angle is
  /// the pair's own, and only the radius can be judged.
  bool radius_only = false;
  std::vector<double> knots; ///< s: of the smooth motion that the pair itself told, where it did
  /// Several records with a zero angle each, in none of which the speed changes: what lags behind a
  /// reference is in the zero angles.
  bool lag_in_zeros = false;
  std::string why_no_temperature;
  double turns = 0.0, fastest_omega = 0.0;
  double stretch_s = 0.0;  ///< the longest of the record without a pause
  double seen_turns = 1.0; ///< from one end of the motion to the other, at most one
  /// How often the shaft comes round a part of a turn: on less than that, to and fro.
  double rounds(double part_of_turn) const {
    return turns / std::min(part_of_turn, 2.0 * seen_turns);
  }
  double vtemp_mean_v = 0.0, supply_rms = 0.0;
  double white_noise_v = 0.0; ///< from sample to sample, one channel
  /// Step of a converter that stands so far above the noise that its error is none; otherwise 0.
  double coarse_step_v = 0.0;
  /// Ripples of the reference against smooth time, entry n - 1 is order n of the turn; empty where
  /// there is no reference, or too little steady motion.
  std::vector<Ripple> reference_ripples;
  double reference_grid_rad = 0.0; ///< of which all its readings are multiples; 0: of none
  WrongRows wrong_rows;
  StaleRows stale;
  /// The reference keeps its value while the pair turns; blocks of rows that came before. Their
  /// places in the capture.
  std::vector<RowRange> held_reference, repeated;
  OwnJumps own_jumps; ///< where the angle is the pair's own, or a smooth motion leaves rows out
  Episodes episodes;
  /// Both outputs stand off their curve at an end of the record.
  std::vector<DeadOutputs> dead;
  std::optional<LevelGap> gap; ///< between two ranges of the readings

  Observations all;                        ///< usable samples
  std::vector<std::uint32_t> index;        ///< their places in the capture
  Observations spiked;                     ///< samples left out because of a spike
  std::vector<std::uint32_t> spiked_index; ///< their places in the capture
  /// Samples left out because the shaft turned too unevenly there to be its own reference: the
  /// radius can still be judged. At the angle that the pair itself gives.
  Observations rough;
  Observations bursts; ///< samples that passed for spikes, yet several in a row
  std::vector<std::uint32_t> train, heldout; ///< places in `all`
  HoldoutUnit unit = HoldoutUnit::turns;     ///< what was held out
  Stops stops;                               ///< of the capture's samples
  std::vector<ScreenFinding> screened;
  std::vector<std::pair<std::size_t, std::size_t>> stuck; ///< as Screened has it
  std::string insufficient; ///< why nothing can be said; empty when something can
};

/// The angle that a pair gives itself says nothing about the pair; not 0, so that the zero angle
/// stays determined.
inline constexpr double kWeightOfOwnAngle = 0.02;
/// Leaves the radius to be judged, and describes the motion as far as it is known then.
void judge_radius_only(Scene &scene);
/// Speed that the shaft reached over whole electrical periods, rad/s: from sample to sample noise
/// adds its own. Where none was whole, from sample to sample.
double fastest_over_periods(const Scene &scene);
/// What the motion of the usable samples can show, and the temperature of the whole capture.
void describe_motion(Scene &scene);
void describe_temperature(const Capture &capture, Scene &scene);
/// Width of the steps in which the reference moves, rad, where they were found; otherwise 0.
double reference_step_rad(const std::vector<ScreenFinding> &screened);

/// Screens a capture and prepares it. `needs_split` false: everything trains (a second capture
/// judges). `known`: what is known of the sensor already, which then no longer bends the motion
/// that is taken from the pair; only for captures without reference. Throws nothing for poor data:
/// that is `insufficient`.
Scene prepare(const Capture &capture, bool needs_split, const Model *known = nullptr,
              std::optional<double> vdd_level_v = std::nullopt);
/// The same of one record, whatever part of the circle it shows.
Scene prepare_record(const Capture &capture, bool needs_split, const Model *known,
                     std::optional<double> vdd_level_v = std::nullopt);

/// Keeps runs of `run` samples spread over the whole, at most about `most` in all.
std::vector<std::uint32_t> thin(const std::vector<std::uint32_t> &indices, std::size_t most,
                                std::size_t run = 400);

} // namespace ada

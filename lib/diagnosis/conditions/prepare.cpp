// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// From a capture to what is known of its samples, and to what it as a whole can show.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "base/pick.h"
#include "base/robust.h"
#include "diagnosis/conditions/dead_outputs.h"
#include "diagnosis/conditions/holdout.h"
#include "diagnosis/conditions/level_gap.h"
#include "diagnosis/conditions/no_circle.h"
#include "diagnosis/conditions/no_pair.h"
#include "diagnosis/conditions/observations.h"
#include "diagnosis/conditions/several.h"
#include "diagnosis/conditions/shaft_motion.h"
#include "diagnosis/criteria.h"
#include "diagnosis/events/first_look.h"
#include "diagnosis/events/screening.h"
#include "diagnosis/search/fit.h"
#include "motion/surroundings.h"

namespace ada {

namespace {

/// Whether the samples about a spike are of use: in a stretch that is left out the angle is not
/// known well enough to say what the spike stands out of.
bool stands_alone(const std::vector<char> &usable, std::size_t spike) {
  constexpr std::size_t kReach = 4;
  const std::size_t from = spike > kReach ? spike - kReach : 0;
  const std::size_t to = std::min(usable.size(), spike + kReach + 1);
  const auto good = std::count(usable.begin() + static_cast<std::ptrdiff_t>(from),
                               usable.begin() + static_cast<std::ptrdiff_t>(to), char{1});
  return static_cast<std::size_t>(good) >= kReach;
}

std::vector<double> counts_of(const Screened &look) {
  const Capture &c = look.capture;
  return turned_by_counts(c.vsin_v, c.vcos_v, look.centre_sin_v, look.centre_cos_v,
                          c.meta.periods_per_turn);
}

/// Jumps to and fro of the pair's own angle at rows that were usable before and no longer are: of
/// what a smooth motion leaves out something has to be said.
OwnJumps jumps_left_out(const Screened &look, const std::vector<char> &before) {
  std::vector<std::uint32_t> rows;
  for (std::size_t i = 0; i < before.size(); ++i)
    if (before[i])
      rows.push_back(static_cast<std::uint32_t>(i));
  OwnJumps out = own_jumps(pick(look.capture.time_s, rows), pick(look.angle, rows),
                           pick(counts_of(look), rows), pick(look.usable, rows));
  out.number_by(rows);
  return out.to_and_fro() ? out : OwnJumps{};
}

/// Spikes that come in rows, as no spikes do: at least four of six samples.
std::vector<std::uint32_t> in_rows(const std::vector<std::uint32_t> &spikes) {
  constexpr std::size_t kFewest = 4;
  constexpr std::uint32_t kWithin = 6;
  std::vector<std::uint32_t> out;
  for (std::size_t k = 0; k + kFewest <= spikes.size(); ++k)
    if (spikes[k + kFewest - 1] - spikes[k] < kWithin)
      for (std::size_t i = k; i < k + kFewest; ++i)
        if (out.empty() || spikes[i] > out.back())
          out.push_back(spikes[i]);
  return out;
}

/// From one end to the other, unwrapped; 0 where that is no more than its noise.
double moved_by_reference_deg(const Capture &capture) {
  constexpr double kOfNoise = 20.0;
  std::vector<double> alpha(capture.size());
  for (std::size_t i = 0; i < alpha.size(); ++i)
    alpha[i] = capture.reference_deg[i] * kRadPerDeg;
  unwrap(alpha, kTwoPi);
  const double moved = quantile(alpha, 0.99) - quantile(alpha, 0.01);
  return moved > kOfNoise * noise_between(alpha) ? moved * kDegPerRad : 0.0;
}

/// `moved_deg`: by the reference, if it moves.
std::string why_at_rest(const Capture &capture, double moved_deg) {
  constexpr double kNoNoise = 0.1; // of the supply: no sensor's noise is as much
  const double scatter_v =
      std::max(spread_but_for_rare(capture.vsin_v), spread_but_for_rare(capture.vcos_v));
  const std::string of_reference =
      fmt::format("the reference moves by {:.0f} degrees and the pair does not show it", moved_deg);
  if (scatter_v > kNoNoise * capture.meta.supply_v)
    return fmt::format("{}; the readings of both signals scatter by {:.0f} mV rms",
                       moved_deg > 0.0 ? of_reference
                                       : "no motion is seen from row to row: the shaft stands, or "
                                         "turns too far in between",
                       1e3 * scatter_v);
  return fmt::format(
      "{}: both signals stand still, but for {:.3g} mV rms by which their readings scatter",
      moved_deg > 0.0 ? of_reference : "the shaft does not turn", 1e3 * scatter_v);
}

void leave_out_stuck_rows(const Capture &capture, std::vector<char> &usable) {
  Screened look{.capture = capture, .usable = std::move(usable)};
  the_effect_that_spoils(Spoils::channel).screen(look);
  usable = std::move(look.usable);
}

} // namespace

Scene prepare_record(const Capture &capture, bool needs_split, const Model *known,
                     std::optional<double> vdd_level_v) {
  Scene scene;
  scene.capture = &capture;
  scene.periods = capture.meta.periods_per_turn;
  scene.supply_v = capture.meta.supply_v;
  scene.has_reference = capture.has_reference();
  if (capture.size() < criteria::kFewestSamples) {
    scene.insufficient = "only " + std::to_string(capture.size()) + " samples; at least " +
                         std::to_string(criteria::kFewestSamples) + " are needed";
    return scene;
  }
  Observations &all = scene.all;
  {
    SupplyOverTime supply(capture, vdd_level_v);
    TemperatureOverTime temperature(capture, supply);
    all.mid_shift_v = supply.mid_shift_v;
    all.supply = std::move(supply.unit);
    scene.supply_rms = supply.rms;
    all.temp = as_floats(temperature.vtemp_v);
    all.temp_rate = std::move(temperature.rate);
    all.vtemp_on_vcos = temperature.on_vcos;
    all.vtemp_on_vcos_error = temperature.on_vcos_error;
  }
  std::vector<char> usable(capture.size());
  for (std::size_t i = 0; i < capture.size(); ++i)
    usable[i] = std::isfinite(capture.vsin_v[i]) && std::isfinite(capture.vcos_v[i]);
  scene.held_reference = held_reference(capture);
  scene.repeated = repeated_blocks(capture);
  for (const auto *ranges : {&scene.held_reference, &scene.repeated})
    for (const RowRange &r : *ranges)
      std::fill(usable.begin() + static_cast<std::ptrdiff_t>(r.first),
                usable.begin() + static_cast<std::ptrdiff_t>(r.end), char{0});
  scene.dead = leave_out_dead_outputs(capture, usable);
  leave_out_stuck_rows(capture, usable); // they are off the curve as well, and have a name
  scene.episodes = leave_out_episodes(capture, usable);
  scene.stale = leave_out_stale_rows(capture, usable);
  Screened look = screen(capture, known, all, std::move(usable));
  scene.screened = look.findings;
  scene.stuck = look.stuck;
  scene.white_noise_v = look.white_noise_v;
  constexpr double kCoarse = 0.5; // of a step; its own error counts as 0.29 of noise
  if (const double step = converter_step(capture.vsin_v); scene.white_noise_v < kCoarse * step)
    scene.coarse_step_v = step;
  if (stands_still(capture, look.white_noise_v)) {
    const double moved_deg = capture.has_reference() ? moved_by_reference_deg(capture) : 0.0;
    scene.insufficient = why_at_rest(capture, moved_deg);
    return scene;
  }
  describe_temperature(capture, scene);

  std::vector<std::uint32_t> rough, bursts;
  scene.own_jumps = unnamed_jumps(look);
  std::vector<char> before = look.usable;
  for (std::uint32_t i : look.spikes)
    before[i] = 1;
  Kinematics motion =
      scene.has_reference ? motion_by_reference(look, scene) : motion_by_pair(look, scene, rough);
  if (scene.radius_only)
    scene.own_jumps = own_jumps(capture.time_s, look.angle, counts_of(look));
  else
    bursts = in_rows(look.spikes);
  if (!rough.empty())
    scene.own_jumps += jumps_left_out(look, before);
  if (!scene.has_reference)
    for (std::uint32_t i : bursts)
      motion.alpha[i] = look.angle[i];
  for (std::size_t i = 0; i < capture.size(); ++i)
    if (look.usable[i])
      scene.index.push_back(static_cast<std::uint32_t>(i));
  for (std::uint32_t i : look.spikes)
    if (stands_alone(look.usable, i))
      scene.spiked_index.push_back(i);
  all.frame_period_s = median_step(capture.time_s);
  all.speed_reach_s = motion.reach_s;
  all.centre_sin_v = look.centre_sin_v;
  all.centre_cos_v = look.centre_cos_v;
  all.time = time_with_losses(look);
  all.vsin = as_floats(capture.vsin_v);
  all.vcos = as_floats(capture.vcos_v);
  all.alpha = std::move(motion.alpha);
  all.omega = as_floats(motion.omega);
  all.accel = std::move(motion.accel);
  all.direction = std::move(motion.direction);
  if (scene.has_reference)
    all.travel = std::move(motion.travel);
  std::vector<double>().swap(look.angle); // a long capture has no memory to spare
  take_derivatives(capture.time_s, all);
  scene.spiked = all.select(scene.spiked_index);
  scene.rough = all.select(rough);
  scene.bursts = all.select(bursts);
  all.keep(scene.index);
  if (all.size() < criteria::kFewestSamples) {
    scene.insufficient = "only " + std::to_string(all.size()) + " usable samples";
    return scene;
  }
  if (scene.radius_only)
    judge_radius_only(scene);
  else
    describe_motion(scene);
  if (needs_split) {
    Stops stops = scene.stops;
    if (stops)
      stops.of = pick(stops.of, scene.index);
    Holdout parts = hold_out(all.alpha, scene.periods, stops);
    scene.unit = parts.unit;
    scene.train = std::move(parts.train);
    scene.heldout = std::move(parts.heldout);
  } else {
    scene.train.resize(all.size());
    std::iota(scene.train.begin(), scene.train.end(), 0u);
  }
  return scene;
}

namespace {

/// A regression of each channel on a constant and on the cosine and the sine of the angle.
struct FirstHarmonic {
  double centre_error;  ///< standard error of the constant, in amplitudes, as far as the noise goes
  Eigen::Matrix2d axes; ///< volts: rows cosine and sine, columns VSIN and VCOS
};

FirstHarmonic first_harmonic(const Observations &all, const Scene &scene) {
  std::vector<std::uint32_t> some(all.size());
  std::iota(some.begin(), some.end(), 0u);
  some = thin(some, criteria::kForCircle);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  for (const std::uint32_t i : some) {
    const double psi = scene.periods * all.alpha[i];
    const Eigen::Vector3d x(1.0, std::cos(psi), std::sin(psi));
    normal += x * x.transpose();
    right += x * Eigen::RowVector2d(all.vsin[i], all.vcos[i]);
  }
  const Eigen::Matrix3d inverse = normal.inverse();
  const Eigen::Matrix2d axes = (inverse * right).bottomRows(2);
  const double share = static_cast<double>(some.size()) / static_cast<double>(all.size());
  const double error =
      scene.white_noise_v * std::sqrt(share * inverse(0, 0)) / (axes.norm() / std::numbers::sqrt2);
  // Of a pair that is none others have more to say.
  return {std::isfinite(error) ? error : 0.0, axes};
}

/// The ellipse that these axes span; a circle where they are those of no pair.
void take_figure(const Eigen::Matrix2d &axes, Observations &of) {
  constexpr double kMostOfAxes = 8.0; // one to the other: 75 degrees off a quarter of a period, 7.6
  const Eigen::Matrix2d moments = axes.transpose() * axes;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> own;
  own.computeDirect(moments, Eigen::EigenvaluesOnly);
  if (!(own.eigenvalues()[0] * kMostOfAxes * kMostOfAxes > own.eigenvalues()[1]))
    return;
  const Eigen::Matrix2d figure = moments.inverse() * own.eigenvalues()[1];
  of.figure = {figure(0, 0), figure(0, 1), figure(1, 1)};
  of.figure_v = std::sqrt(own.eigenvalues()[1]);
}

/// How far off the figure each sample lies, V, along the figure's outward direction.
double off_figure_v(const Observations &all, std::size_t i) {
  const Observations::Place at = all.place(all.vsin[i], all.vcos[i]);
  const auto [s, c] = all.outward(all.vsin[i], all.vcos[i]);
  return (1.0 - all.figure_v / at.long_axis_v) * (at.vector[0] * s + at.vector[1] * c);
}

/// Noise of both channels shows in every direction alike, and so there is no more of it than what
/// leads off the figure. Where a shaft jerks from row to row, differences over rows hold its
/// motion.
double noise_off_figure_v(const Observations &all) {
  constexpr double kFitted = 5.0; // numbers of an ellipse
  const double n = static_cast<double>(all.size());
  if (n <= 2.0 * kFitted)
    return std::numeric_limits<double>::infinity();
  std::vector<double> off(all.size());
  for (std::size_t i = 0; i < off.size(); ++i)
    off[i] = std::abs(off_figure_v(all, i));
  return kSigmasOfMedian * quantile(std::move(off), 0.5) * std::sqrt(n / (n - kFitted));
}

/// A pair that tells its angle itself, off the figure of which nothing but noise lies: each sample
/// at the nearest point of it, and without what noise puts it outside on the average. Noise along a
/// curved line leads off it, by half the curvature times its variance (Chernov, Circular and linear
/// regression, 2010, ch. 7).
void put_on_figure(Observations &all, double noise_v, int periods) {
  constexpr double kOfNoise = 1.2; // rms: what is not noise has less than 0.7 of it
  double squares = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i)
    squares += std::pow(off_figure_v(all, i), 2);
  all.noise_alone = squares < static_cast<double>(all.size()) * std::pow(kOfNoise * noise_v, 2);
  for (std::size_t i = 0; all.noise_alone && i < all.size(); ++i) {
    all.alpha[i] += all.to_nearest(all.place(all.vsin[i], all.vcos[i])) / periods;
    const auto [near_s, near_c] = all.nearest(all.vsin[i], all.vcos[i]);
    const double sin_v = all.centre_sin_v + near_s, cos_v = all.centre_cos_v + near_c;
    const Observations::Place there = all.place(sin_v, cos_v);
    const double curvature = there.long_axis_v * there.short_axis_v /
                             std::pow(std::hypot(there.along[0], there.along[1]), 3);
    const double outside = 0.5 * curvature * noise_v * noise_v;
    const auto [us, uc] = all.outward(sin_v, cos_v);
    all.vsin[i] -= static_cast<float>(outside * us);
    all.vcos[i] -= static_cast<float>(outside * uc);
  }
}

} // namespace

Scene prepare(const Capture &capture, bool needs_split, const Model *known,
              std::optional<double> vdd_level_v) {
  Scene scene = capture.starts.empty() ? prepare_record(capture, needs_split, known, vdd_level_v)
                                       : prepare_several(capture, needs_split, known, vdd_level_v);
  const Observations &all = scene.all;
  if (!scene.insufficient.empty())
    return scene;
  const bool comes_again = scene.rounds(1.0) >= criteria::kFewestTurnsToRepeat;
  const double least = !scene.has_reference ? criteria::kLeastCoverage
                       : comes_again        ? criteria::kLeastCoverageByReference
                                            : criteria::kLeastOfOnePass;
  // An error of the angle moves the pair along the figure that it draws, whoever tells the angle.
  const FirstHarmonic pair = first_harmonic(all, scene);
  for (Observations *o : {&scene.all, &scene.spiked, &scene.rough, &scene.bursts})
    take_figure(pair.axes, *o);
  if (scene.radius_only && scene.all.figure_v > 0.0) {
    const double rounding_v = converter_step(capture.vsin_v) / std::sqrt(12.0);
    scene.white_noise_v =
        std::min(scene.white_noise_v, std::max(noise_off_figure_v(all), rounding_v));
    put_on_figure(scene.all, scene.white_noise_v, scene.periods);
  }
  // By its own angle a pair goes all the way round its centre.
  const double error = scene.has_reference ? pair.centre_error : 0.0;
  const double seen = share_of_circle(all.alpha, scene.periods);
  if (seen < least)
    scene.insufficient = fmt::format("the record shows {:.0f} of 360 electrical degrees; at least "
                                     "{:.0f} are needed to tell centre and axes apart",
                                     360.0 * seen, 360.0 * least);
  else if (error > criteria::kCentreKnown)
    scene.insufficient =
        fmt::format("of {:.0f} electrical degrees and {} samples the centre of the "
                    "pair is known to {:.2g} of its amplitude only",
                    360.0 * seen, all.size(), error);
  else if (on_one_line(all, scene.white_noise_v))
    scene.insufficient =
        "the shaft turns and the vector does not: VSIN and VCOS move along one line";
  else if (!scene.has_reference) {
    // Of all samples in which both channels live: those about the centre turn too fast to be
    // usable.
    std::vector<std::uint32_t> some(capture.size());
    std::iota(some.begin(), some.end(), 0u);
    std::vector<char> lives(capture.size(), 1);
    for (const auto &[first, end] : scene.stuck)
      std::fill(lives.begin() + static_cast<std::ptrdiff_t>(first),
                lives.begin() + static_cast<std::ptrdiff_t>(end), char{0});
    std::erase_if(some, [&](std::uint32_t i) { return !lives[i]; });
    some = thin(some, criteria::kForCircle);
    scene.insufficient = why_no_angle(pick(capture.vsin_v, some), pick(capture.vcos_v, some));
    if (!scene.insufficient.empty() && level_gap(capture)) // a better reason, which is told later
      scene.insufficient.clear();
    if (!scene.insufficient.empty()) // and no turns
      scene.turns = std::numeric_limits<double>::quiet_NaN();
  }
  return scene;
}

} // namespace ada

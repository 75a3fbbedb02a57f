// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/observations.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <numeric>
#include <random>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/conditions/holdout.h"
#include "diagnosis/conditions/level_gap.h"
#include "diagnosis/conditions/no_circle.h"
#include "diagnosis/conditions/several.h"
#include "diagnosis/conditions/uneven_motion.h"
#include "diagnosis/criteria.h"
#include "diagnosis/fit.h"
#include "diagnosis/looks.h"
#include "diagnosis/screening.h"
#include "motion/kinematics.h"
#include "motion/reference_rows.h"
#include "motion/surroundings.h"

namespace ada {

namespace {

/// A shaft that departs this far from a smooth motion is no reference, rad rms mechanical.
constexpr double kRoughMotion = 1.0 * kRadPerDeg;
constexpr double kLeastTemperatureV = 0.03; ///< about 2 degrees Celsius at 5 V
constexpr int kRippleOrders = 20;           ///< clipping alone shows up to order 16
constexpr int kReferenceOrders = 64;        ///< a line disc errs with its segments

template <class T>
std::vector<T> pick(const std::vector<T> &from, const std::vector<std::uint32_t> &indices) {
  std::vector<T> out;
  if (from.empty())
    return out;
  out.reserve(indices.size());
  for (std::uint32_t i : indices)
    out.push_back(from[i]);
  return out;
}

} // namespace

void describe_temperature(const Capture &capture, Scene &scene) {
  if (!capture.has_vtemp()) {
    scene.why_no_temperature = "no VTEMP channel";
    return;
  }
  const std::vector<double> &temp = scene.all.temp;
  scene.vtemp_mean_v = std::accumulate(capture.vtemp_v.begin(), capture.vtemp_v.end(), 0.0) /
                       static_cast<double>(capture.size());
  if (quantile(temp, 0.98) - quantile(temp, 0.02) < kLeastTemperatureV)
    scene.why_no_temperature = "one temperature only";
  scene.all.vtemp_scanned = true;
}

namespace {

/// Where the speed changes within a few samples, speed and sense of each sample are not known.
void leave_out_kinks(const std::vector<double> &omega, std::vector<char> &usable) {
  constexpr std::size_t kReach = 6;
  std::vector<double> speed;
  for (double w : omega)
    speed.push_back(std::abs(w));
  const double top = quantile(std::move(speed), 0.99);
  for (std::size_t i = kReach; i + kReach < omega.size(); ++i)
    if (std::abs(omega[i + kReach] - omega[i - kReach]) > 0.2 * top)
      usable[i] = 0;
}

/// Just after a reversal the sense of rotation is known and yet a hysteresis has not crossed its
/// loop. A few samples about each reversal are not used; where the shaft does little else, the two
/// between which it turned, of which nobody knows which way it went in them.
void leave_out_reversals(const Kinematics &motion, std::vector<char> &usable) {
  constexpr std::size_t kReach = 6;
  constexpr double kLoop = 0.6 * kRadPerDeg; // wider than the loop of any usable sensor
  constexpr double kMost = 0.02;
  const std::size_t n = usable.size();
  std::vector<char> out(n, 0);
  for (std::size_t i = 1; i < n; ++i) {
    if (motion.direction[i] == motion.direction[i - 1])
      continue;
    const auto near = [&](std::size_t k, std::size_t distance) {
      return distance <= kReach || std::abs(motion.alpha[k] - motion.alpha[i]) < kLoop;
    };
    for (std::size_t k = i; k < n && near(k, k - i); ++k)
      out[k] = 1;
    // Before it a shaft that stood still is not left out: its sense is the old one.
    for (std::size_t k = i; k-- > 0 && near(k, i - k) && i - k <= std::max(kReach, n / 500);)
      out[k] = 1;
  }
  const auto count = static_cast<double>(std::count(out.begin(), out.end(), char{1}));
  if (count > kMost * static_cast<double>(n)) {
    std::fill(out.begin(), out.end(), char{0});
    for (std::size_t i = 1; i < n; ++i)
      if (motion.direction[i] != motion.direction[i - 1])
        out[i] = out[i - 1] = 1;
  }
  // Which way it came to where it stands at the start nobody saw.
  const bool turns_back =
      std::any_of(motion.direction.begin(), motion.direction.end(),
                  [&](auto sense) { return sense != motion.direction.front(); });
  const std::size_t moves = turns_back ? first_motion(motion.alpha) : 0;
  std::fill_n(out.begin(), moves < n ? moves : 0, char{1});
  for (std::size_t i = 0; i < n; ++i)
    if (out[i])
      usable[i] = 0;
}

/// Mean speed over one electrical period from each sample on, rad/s, along the stretches between
/// two reversals; none where no stretch holds a period.
std::vector<double> speed_of_periods(const Observations &all, int periods) {
  const double period = kTwoPi / periods;
  std::vector<double> out;
  for (std::size_t from = 0, to = 0; from < all.size(); from = to) {
    const double sense = all.omega[from] < 0.0 ? -1.0 : 1.0;
    for (to = from + 1; to < all.size() && sense * all.omega[to] >= 0.0;)
      ++to;
    for (std::size_t i = from, j = from; i < to; ++i) {
      while (j < to && sense * (all.alpha[j] - all.alpha[i]) < period)
        ++j;
      if (j == to)
        break;
      if (const double took = all.time[j] - all.time[i]; took > 0.0)
        out.push_back(sense * (all.alpha[j] - all.alpha[i]) / took);
    }
  }
  return out;
}

} // namespace

void describe_motion(Scene &scene) {
  const Observations &all = scene.all;
  struct Way {
    double time = 0.0, travel = 0.0;
  } forward, backward;
  std::vector<double> speed;
  for (std::size_t i = 0; i < all.size(); ++i) {
    speed.push_back(std::abs(all.omega[i]));
    double dt = i > 0 ? all.time[i] - all.time[i - 1] : 0.0;
    double step = std::min(std::abs(dt), 10.0 * all.frame_period_s) * all.omega[i];
    if (scene.stops && i > 0) { // it turns from one place to the next, and each way counts alike
      dt = 1.0;
      step = std::copysign(std::abs(all.alpha[i] - all.alpha[i - 1]), all.direction[i]);
    }
    if (step == 0.0)
      continue;
    Way &way = step > 0.0 ? forward : backward;
    way.time += dt;
    way.travel += std::abs(step);
  }
  scene.turns = (forward.travel + backward.travel) / kTwoPi;
  // What a way back tells from the angle it is seen at must be seen at many: a quarter of a turn.
  // The shaft's own smooth motion needs a turn to tell one from the other.
  const double least = scene.has_reference ? 0.25 * kTwoPi : kTwoPi;
  scene.both_directions =
      std::min(forward.time, backward.time) > 0.05 * (forward.time + backward.time) &&
      std::min(forward.travel, backward.travel) > least;
  scene.fastest_omega = quantile(speed, 0.98);
  // Whatever bends the pair's radius within a period bends its angle as well, and so its speed: of
  // an angle that is the pair's own only the speeds of whole periods are the shaft's.
  if (scene.radius_only)
    if (std::vector<double> whole = speed_of_periods(all, scene.periods); !whole.empty())
      speed = std::move(whole);
  scene.several_speeds = quantile(speed, 0.05) < 0.8 * quantile(speed, 0.98);
}

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

/// What was usable before and no longer is, spikes aside; of much only every so many.
std::vector<std::uint32_t> left_out(const std::vector<char> &before, const Screened &look) {
  constexpr std::size_t kMost = 50000;
  std::vector<std::uint32_t> out, some;
  for (std::size_t i = 0; i < before.size(); ++i)
    if (before[i] && !look.usable[i] &&
        !std::binary_search(look.spikes.begin(), look.spikes.end(), static_cast<std::uint32_t>(i)))
      out.push_back(static_cast<std::uint32_t>(i));
  const std::size_t stride = out.size() / kMost + 1;
  for (std::size_t k = 0; k < out.size(); k += stride)
    some.push_back(out[k]);
  return some;
}

/// Jumps to and fro of the pair's own angle at rows that were usable before and no longer are: of
/// what a smooth motion leaves out something has to be said.
OwnJumps jumps_left_out(const Screened &look, const std::vector<char> &before) {
  std::vector<std::uint32_t> rows;
  for (std::size_t i = 0; i < before.size(); ++i)
    if (before[i])
      rows.push_back(static_cast<std::uint32_t>(i));
  OwnJumps out = own_jumps(pick(look.capture.time_s, rows), pick(look.angle, rows),
                           pick(look.usable, rows));
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

/// Whether neither channel moves beyond its noise and a little hum or creep. Of noise the quantiles
/// lie 4.7 standard deviations apart: up to four times that the pair has to draw a circle, as that
/// of a very noisy sensor does.
bool stands_still(const Capture &capture, double noise_v) {
  constexpr double kFew = 10.0, kMany = 20.0;
  double most_v = 0.0;
  for (const auto *v : {&capture.vsin_v, &capture.vcos_v})
    most_v = std::max(most_v, quantile(*v, 0.99) - quantile(*v, 0.01));
  if (most_v <= kFew * noise_v)
    return true;
  return most_v <= kMany * noise_v && !draws_circle(capture.vsin_v, capture.vcos_v);
}

/// Speed and sense of each sample say nothing where they change: those are left out, unless that is
/// most of the record.
void leave_out_changes(const Kinematics &motion, std::vector<char> &usable) {
  std::vector<char> less = usable;
  leave_out_kinks(motion.omega, less);
  leave_out_reversals(motion, less);
  const auto count = [](const std::vector<char> &v) {
    return static_cast<double>(std::count(v.begin(), v.end(), char{1}));
  };
  if (count(less) > criteria::kMostLeftOut * count(usable))
    usable = std::move(less);
}

/// A shaft that stands while it is read does not turn in any sample; the sense is that of the way
/// there.
Kinematics at_rest(std::vector<double> alpha, const Stops &stops) {
  Kinematics out;
  const std::size_t n = alpha.size();
  out.omega.assign(n, 0.0);
  out.accel.assign(n, 0.0f);
  out.direction.assign(n, 1);
  signed char sense = 1;
  for (std::size_t i = 1; i < n; ++i) {
    if (stops.of[i] != stops.of[i - 1])
      sense = alpha[i] < alpha[i - 1] ? -1 : 1;
    out.direction[i] = sense;
  }
  out.travel = travel_since_reversal(alpha, out.direction);
  out.alpha = std::move(alpha);
  return out;
}

/// Rows in which the reference alone errs are not used, and do not count as motion.
void leave_out_wrong_rows(std::vector<double> &reference, Screened &look, Scene &scene) {
  const double step = converter_step(look.capture.reference_deg) * kRadPerDeg;
  const RowsApart apart = mend_rows(reference, look.angle, step);
  for (std::size_t k = 0; k < apart.rows.size(); ++k) {
    if (!look.usable[apart.rows[k]])
      continue;
    look.usable[apart.rows[k]] = 0;
    const double by = apart.by_rad[k];
    scene.wrong_rows += {1, by, by * by};
  }
}

/// Where a smooth motion agrees with every reading of a reference that counts in steps to within
/// one step, it is the better reference: at a steady speed the rounding is the same in each turn,
/// and would pass for an error of the sensor.
void smooth_between_steps(const Screened &look, std::vector<double> &alpha) {
  constexpr double kWithin = 1.05; // of a step, for the noise of what is counted
  constexpr double kShare = 0.999; // of the samples
  double step = 0.0;
  for (const ScreenFinding &f : look.findings)
    step = std::max(step, f.effect->reference_step_rad(f.values));
  if (step <= 0.0)
    return;
  std::vector<char> usable = look.usable;
  const std::vector<double> smooth =
      smooth_motion(look.capture.time_s, alpha, usable, 0).motion.alpha;
  std::vector<double> off;
  for (std::size_t i = 0; i < alpha.size(); ++i)
    if (usable[i])
      off.push_back(alpha[i] - smooth[i]);
  if (off.size() < criteria::kFewestSamples ||
      quantile(off, 0.5 + 0.5 * kShare) - quantile(off, 0.5 - 0.5 * kShare) > kWithin * step)
    return;
  const double middle = quantile(std::move(off), 0.5);
  for (std::size_t i = 0; i < alpha.size(); ++i)
    if (usable[i])
      alpha[i] = smooth[i] + middle;
}

Kinematics motion_by_reference(Screened &look, Scene &scene) {
  const Capture &capture = look.capture;
  std::vector<double> alpha(capture.size());
  for (std::size_t i = 0; i < alpha.size(); ++i)
    alpha[i] = capture.reference_deg[i] * kRadPerDeg;
  leave_out_wrong_rows(alpha, look, scene);
  unwrap(alpha, kTwoPi);
  scene.stops = find_stops(alpha, noise_between(alpha));
  if (scene.stops)
    return at_rest(std::move(alpha), scene.stops);
  scene.reference_ripples =
      ripples_against_time(capture.time_s, alpha, look.usable, kReferenceOrders);
  smooth_between_steps(look, alpha);
  Kinematics motion = differentiate(capture.time_s, std::move(alpha), 4);
  leave_out_changes(motion, look.usable);
  return motion;
}

/// The pair as its own reference: only the radius can be judged then.
Kinematics motion_of_the_pair_itself(const Screened &look, Scene &scene) {
  constexpr std::size_t kHalfWindow = 3;
  scene.radius_only = true;
  return differentiate(look.capture.time_s, look.angle, kHalfWindow);
}

/// A shaft is a reference as long as what the smooth motion leaves over in parts of a turn is not
/// much more than what lies along the radius: a sensor's errors show in both, the motion in the
/// angle alone. A channel that lags gives the angle twice the power that it gives the radius;
/// beyond four times more than half of it is the motion's.
bool more_than_the_radius(const SmoothMotion &smooth, const Screened &look) {
  const double electrical = look.capture.meta.periods_per_turn;
  return electrical * smooth.slow_rad > 2.0 * radius_left_rad(look);
}

/// Whether what a smooth motion calls a ripple makes the speed vary by more than a half: that is no
/// ripple but the motion itself, of which too little was smooth to tell the two apart.
bool ripples_too_much(const SmoothMotion &smooth) {
  constexpr double kMost = 0.5; // of the speed
  for (std::size_t k = 0; k < smooth.cos.size(); ++k)
    if (static_cast<double>(k + 1) * std::hypot(smooth.cos[k], smooth.sin[k]) > kMost)
      return true;
  return false;
}

/// A motion whose ripple is looked for at orders of the electrical period: of a ring of many poles
/// that makes a few turns.
Kinematics motion_by_poles(Screened &look, Scene &scene) {
  constexpr int kOrders = 8; // of the electrical angle
  std::vector<double> psi = look.angle;
  for (double &x : psi)
    x *= scene.periods;
  std::vector<char> usable = look.usable;
  SmoothMotion smooth = smooth_motion(look.capture.time_s, psi, usable, kOrders);
  if (smooth.residual_rms_rad > kRoughMotion * scene.periods)
    return motion_of_the_pair_itself(look, scene);
  look.usable = std::move(usable);
  std::vector<double> alpha = std::move(smooth.motion.alpha);
  for (double &a : alpha)
    a /= scene.periods;
  // Whether a ripple between two poles is the shaft's or the ring's is not known: the speed is that
  // of a quarter of a turn about each sample.
  const double samples_a_turn = static_cast<double>(alpha.size()) / std::max(look.turns(), 1e-6);
  const auto eighth = static_cast<std::size_t>(std::max(8.0, samples_a_turn / 8.0));
  return differentiate(look.capture.time_s, std::move(alpha),
                       std::min(eighth, look.angle.size() / 4));
}

/// `rough`: what is left out of the smooth motion, at the pair's own angle.
Kinematics motion_by_pair(Screened &look, Scene &scene, std::vector<std::uint32_t> &rough) {
  constexpr std::size_t kHalfWindow = 8;
  if (!look.smooth)
    return scene.periods * look.turns() >= 2.0 * criteria::kFewestUnits && scene.periods > 2
               ? motion_by_poles(look, scene)
               : motion_of_the_pair_itself(look, scene);
  const std::vector<char> before = look.usable;
  SmoothMotion smooth = smooth_motion_with_losses(look, kRippleOrders);
  scene.radius_only = smooth.residual_rms_rad > kRoughMotion || ripples_too_much(smooth) ||
                      more_than_the_radius(smooth, look) ||
                      ripples_by_chance(smooth, look.capture.time_s, look.angle, look.usable);
  if (ripples_too_much(smooth)) {
    look.usable = before;
    return motion_of_the_pair_itself(look, scene);
  }
  if (scene.radius_only) {
    smooth.motion.alpha = look.angle;
  } else {
    scene.knots = std::move(smooth.knots);
    rough = left_out(before, look);
  }
  if (!rough.empty()) { // how fast it turned there tells the pair as well
    const Kinematics own = differentiate(look.capture.time_s, look.angle, kHalfWindow);
    for (std::uint32_t i : rough) {
      smooth.motion.alpha[i] = own.alpha[i];
      smooth.motion.omega[i] = own.omega[i];
      smooth.motion.accel[i] = own.accel[i];
    }
  }
  return std::move(smooth.motion);
}

} // namespace

Conditions Observations::conditions() const {
  const auto data = [](const auto &v) { return v.empty() ? nullptr : v.data(); };
  return {.n = size(),
          .time = data(time),
          .alpha = data(alpha),
          .omega = data(omega),
          .accel = data(accel),
          .direction = data(direction),
          .travel = data(travel),
          .temp = data(temp),
          .temp_rate = data(temp_rate),
          .supply = data(supply),
          .supply_rate = data(supply_rate),
          .supply_bend = data(supply_bend),
          .vtemp_scan = vtemp_scanned ? data(temp) : nullptr,
          .frame_period_s = frame_period_s,
          .mid_shift_v = mid_shift_v};
}

std::array<double, 2> Observations::direction_at(std::size_t i, double model_sin,
                                                 double model_cos) const {
  double us = model_sin, uc = model_cos;
  if (disturbed == Direction::motion) {
    us = vcos[i] - centre_cos_v;
    uc = centre_sin_v - vsin[i];
  } else if (disturbed == Direction::radius) {
    us = model_sin - centre_sin_v;
    uc = model_cos - centre_cos_v;
  }
  const double inverse = 1.0 / std::max(std::sqrt(us * us + uc * uc), 1e-12); // volts: no overflow
  return {us * inverse, uc * inverse};
}

Observations::Whitener Observations::whitener_at(std::size_t i, double model_sin,
                                                 double model_cos) const {
  if (weight_along == 1.0)
    return {0.0, 0.0, 1.0};
  const auto [us, uc] = direction_at(i, model_sin, model_cos);
  return {us, uc, weight_along};
}

namespace {

/// Hands each column to `act`, and which member it is.
template <class Data, class Act> void for_each_column(Data &data, Act act) {
  act(data.time, &Observations::time);
  act(data.vsin, &Observations::vsin);
  act(data.vcos, &Observations::vcos);
  act(data.alpha, &Observations::alpha);
  act(data.omega, &Observations::omega);
  act(data.accel, &Observations::accel);
  act(data.direction, &Observations::direction);
  act(data.travel, &Observations::travel);
  act(data.temp, &Observations::temp);
  act(data.temp_rate, &Observations::temp_rate);
  act(data.supply, &Observations::supply);
  act(data.supply_rate, &Observations::supply_rate);
  act(data.supply_bend, &Observations::supply_bend);
}

} // namespace

Observations Observations::select(const std::vector<std::uint32_t> &indices) const {
  Observations out;
  out.frame_period_s = frame_period_s;
  out.vtemp_scanned = vtemp_scanned;
  out.vtemp_on_vcos = vtemp_on_vcos;
  out.vtemp_on_vcos_error = vtemp_on_vcos_error;
  out.disturbed = disturbed;
  out.weight_along = weight_along;
  out.own_offsets = own_offsets;
  out.mid_shift_v = mid_shift_v;
  out.centre_sin_v = centre_sin_v;
  out.centre_cos_v = centre_cos_v;
  for_each_column(out, [&](auto &column, auto which) { column = pick(this->*which, indices); });
  return out;
}

void Observations::keep(const std::vector<std::uint32_t> &indices) {
  if (indices.size() == size())
    return;
  for_each_column(*this, [&](auto &column, auto) { column = pick(column, indices); });
}

void judge_radius_only(Scene &scene) {
  scene.radius_only = true;
  scene.all.disturbed = Direction::motion;
  scene.all.weight_along = kWeightOfOwnAngle;
  describe_motion(scene);
}

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
    all.temp = std::move(temperature.vtemp_v);
    all.temp_rate = std::move(temperature.rate);
    all.vtemp_on_vcos = temperature.on_vcos;
    all.vtemp_on_vcos_error = temperature.on_vcos_error;
  }
  std::vector<char> usable(capture.size());
  for (std::size_t i = 0; i < capture.size(); ++i)
    usable[i] = std::isfinite(capture.vsin_v[i]) && std::isfinite(capture.vcos_v[i]);
  scene.episodes = leave_out_episodes(capture, usable);
  scene.stale = leave_out_stale_rows(capture, usable);
  Screened look = screen(capture, known, all, std::move(usable));
  scene.screened = look.findings;
  scene.white_noise_v = look.white_noise_v;
  constexpr double kCoarse = 0.5; // of a step; its own error counts as 0.29 of noise
  if (const double step = converter_step(capture.vsin_v); scene.white_noise_v < kCoarse * step)
    scene.coarse_step_v = step;
  if (stands_still(capture, look.white_noise_v)) {
    scene.insufficient = fmt::format(
        "the shaft does not turn: both signals stand still, but for {:.3g} mV that differ "
        "from one reading to the next",
        1e3 * look.white_noise_v);
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
    scene.own_jumps = own_jumps(capture.time_s, look.angle);
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
  all.centre_sin_v = look.centre_sin_v;
  all.centre_cos_v = look.centre_cos_v;
  all.time = time_with_losses(look, all.frame_period_s);
  all.vsin = capture.vsin_v;
  all.vcos = capture.vcos_v;
  all.alpha = std::move(motion.alpha);
  all.omega = std::move(motion.omega);
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
    Holdout parts = split(all.alpha, scene.periods, stops);
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

/// Electrical angle of each sample as the raw pair has it.
std::vector<double> own_angle(const Observations &data) {
  std::vector<double> out(data.size());
  for (std::size_t i = 0; i < data.size(); ++i)
    out[i] = std::atan2(data.vsin[i] - data.centre_sin_v, data.vcos[i] - data.centre_cos_v);
  return out;
}

/// Whether VSIN and VCOS move along one line: by the variance across it over that along it, or
/// because it is no more than noise.
bool on_one_line(const Observations &data, double noise_v) {
  // A third of a turn leaves 0.08 of an even pair, a twelfth 0.005, an ellipse of 1 to 10 leaves
  // 0.01; noise of a hundredth of the amplitude on a line leaves 0.0002.
  constexpr double kLine = 1e-3;
  // A shaft that turns by a radian from sample to sample passes for noise, and leaves 0.2 or more.
  constexpr double kLong = 0.1, kOfNoise = 4.0; // the latter of its variance
  const double n = static_cast<double>(data.size());
  const Eigen::Map<const Eigen::ArrayXd> s(data.vsin.data(),
                                           static_cast<Eigen::Index>(data.size()));
  const Eigen::Map<const Eigen::ArrayXd> c(data.vcos.data(),
                                           static_cast<Eigen::Index>(data.size()));
  const Eigen::ArrayXd x = s - s.mean(), y = c - c.mean();
  Eigen::Matrix2d covariance;
  covariance << (x * x).sum() / n, (x * y).sum() / n, (x * y).sum() / n, (y * y).sum() / n;
  const Eigen::Vector2d along =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance).eigenvalues();
  return along[0] < kLine * along[1] ||
         (along[0] < kLong * along[1] && along[0] < kOfNoise * noise_v * noise_v);
}

/// How far the pair keeps step with so many periods a turn, in either sense: 1 all the time, 0
/// never.
double in_step(const std::vector<double> &own, const std::vector<double> &alpha, int periods) {
  constexpr std::size_t kMost = 4000; // of chance 1/sqrt(4000) is left
  const std::size_t every = std::max<std::size_t>(1, own.size() / kMost);
  std::complex<double> with, against;
  double n = 0.0;
  for (std::size_t i = 0; i < own.size(); i += every, n += 1.0) {
    with += std::polar(1.0, own[i] - periods * alpha[i]);
    against += std::polar(1.0, own[i] + periods * alpha[i]);
  }
  return std::max(std::abs(with), std::abs(against)) / n;
}

/// The number of periods a turn with which the pair keeps step and with the stated one it does not.
/// 0: there is none.
int other_periods(const std::vector<double> &own, const std::vector<double> &alpha, int stated) {
  // An ellipse of 1 to 2, or an error of 60 deg, leaves 0.8 of a step; what runs through leaves
  // none.
  constexpr double kInStep = 0.7, kOutOfStep = 0.3;
  if (stated > criteria::kMostPeriodsInTurns || in_step(own, alpha, stated) > kOutOfStep)
    return 0;
  for (int periods = 1; periods <= criteria::kMostPeriodsInTurns; ++periods)
    if (in_step(own, alpha, periods) > kInStep)
      return periods;
  return 0;
}

} // namespace

Scene prepare(const Capture &capture, bool needs_split, const Model *known,
              std::optional<double> vdd_level_v) {
  Scene scene = capture.starts.empty() ? prepare_record(capture, needs_split, known, vdd_level_v)
                                       : prepare_several(capture, needs_split, known, vdd_level_v);
  const Observations &all = scene.all;
  if (!scene.insufficient.empty())
    return scene;
  const double least =
      scene.has_reference ? criteria::kLeastCoverageByReference : criteria::kLeastCoverage;
  const double seen = share_of_circle(all.alpha, scene.periods);
  if (seen < least)
    scene.insufficient = fmt::format("the record shows {:.0f} of 360 electrical degrees; at least "
                                     "{:.0f} are needed to tell centre and axes apart",
                                     360.0 * seen, 360.0 * least);
  else if (on_one_line(all, scene.white_noise_v))
    scene.insufficient =
        "the shaft turns and the vector does not: VSIN and VCOS move along one line";
  else if (!scene.has_reference) {
    // Of all samples: those about the centre turn too fast to be usable.
    std::vector<std::uint32_t> some(capture.size());
    std::iota(some.begin(), some.end(), 0u);
    some = thin(some, criteria::kForCircle);
    scene.insufficient = why_no_angle(pick(capture.vsin_v, some), pick(capture.vcos_v, some));
    if (!scene.insufficient.empty() && level_gap(capture)) // a better reason, which is told later
      scene.insufficient.clear();
  }
  if (!scene.has_reference || !scene.insufficient.empty())
    return scene;
  const std::vector<double> own = own_angle(all);
  if (const int periods = other_periods(own, all.alpha, scene.periods); periods != 0)
    scene.insufficient = fmt::format(
        "the pair makes {} {} a turn of the reference, where the capture states {}: its "
        "periods_per_turn is wrong, or the reference counts other turns than the shaft's",
        periods, periods == 1 ? "period" : "periods", scene.periods);
  return scene;
}

std::vector<std::uint32_t> thin(const std::vector<std::uint32_t> &indices, std::size_t most,
                                std::size_t run) {
  if (indices.size() <= most)
    return indices;
  const std::size_t runs = std::max<std::size_t>(1, most / run);
  const std::size_t length = most / runs;
  const std::size_t share = indices.size() / runs;
  std::vector<std::uint32_t> out;
  // Uneven places: evenly spaced runs would see a tone at several frequencies alike.
  std::minstd_rand place(1);
  for (std::size_t r = 0; r < runs; ++r) {
    const std::size_t from = r * share + place() % (share - length + 1);
    for (std::size_t k = from; k < std::min(from + length, indices.size()); ++k)
      out.push_back(indices[k]);
  }
  return out;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/shaft_motion.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/conditions/uneven_motion.h"
#include "diagnosis/criteria.h"
#include "diagnosis/events/screening.h"
#include "motion/counted_angle.h"
#include "motion/reference_rows.h"

namespace ada {

namespace {

/// A shaft that departs this far from a smooth motion is no reference, rad rms mechanical.
constexpr double kRoughMotion = 1.0 * kRadPerDeg;
constexpr int kRippleOrders = 20;    ///< clipping alone shows up to order 16
constexpr int kReferenceOrders = 64; ///< a line disc errs with its segments

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
  std::size_t moves = turns_back ? first_motion(motion.alpha) : 0;
  const auto most = std::min(n, moves + static_cast<std::size_t>(kMost * static_cast<double>(n)));
  std::size_t crossed = moves; // and a loop that it is in the middle of is crossed first
  while (turns_back && crossed < most &&
         std::abs(motion.alpha[crossed] - motion.alpha.front()) < kLoop)
    ++crossed;
  moves = crossed < most ? crossed : moves;
  std::fill_n(out.begin(), moves < n ? moves : 0, char{1});
  for (std::size_t i = 0; i < n; ++i)
    if (out[i])
      usable[i] = 0;
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
Kinematics at_rest(std::vector<double> alpha, const std::vector<std::uint32_t> &stop_of) {
  Kinematics out;
  const std::size_t n = alpha.size();
  out.omega.assign(n, 0.0);
  out.accel.assign(n, 0.0f);
  out.direction.assign(n, 1);
  signed char sense = 1;
  for (std::size_t i = 1; i < n; ++i) {
    if (stop_of[i] != stop_of[i - 1])
      sense = alpha[i] < alpha[i - 1] ? -1 : 1;
    out.direction[i] = sense;
  }
  out.travel = travel_since_reversal(alpha, out.direction);
  out.alpha = std::move(alpha);
  return out;
}

/// Rows in which the reference alone errs are not used, and do not count as motion. Beside rows in
/// which the pair is wrong, as where a channel dies, nothing says that it is right.
void leave_out_wrong_rows(std::vector<double> &reference, Screened &look, Scene &scene) {
  const double step = converter_step(look.capture.reference_deg) * kRadPerDeg;
  const RowsApart apart = mend_rows(reference, look.angle, step);
  const std::vector<char> pair_is_right = look.usable;
  for (std::size_t k = 0; k < apart.rows.size(); ++k) {
    const std::size_t row = apart.rows[k];
    if (!pair_is_right[row])
      continue;
    look.usable[row] = 0;
    if ((row > 0 && !pair_is_right[row - 1]) ||
        (row + 1 < pair_is_right.size() && !pair_is_right[row + 1]))
      continue;
    const double by = apart.by_rad[k];
    scene.wrong_rows += {1, by, by * by};
  }
}

/// A long capture has no memory to spare, and so many readings tell the grid.
double grid_of_some(const std::vector<double> &reference_deg) {
  constexpr std::size_t kEnough = 50000;
  const std::size_t stride = reference_deg.size() / kEnough + 1;
  std::vector<double> some;
  for (std::size_t i = 0; i < reference_deg.size(); i += stride)
    some.push_back(reference_deg[i]);
  return reference_grid_rad(some);
}

/// Between its steps a reference that counts is better known by the motion that agrees with it: at
/// a steady speed the rounding is the same in each turn, and would pass for an error of the sensor.
/// The few rows of which no motion knows more stand out of the others, and are left out; where they
/// are many all stay as they are read.
void read_between_steps(Screened &look, std::vector<double> &alpha) {
  constexpr double kFew = 0.2; // of the rows
  const double step = reference_step_rad(look.findings);
  if (!(step > 0.0))
    return;
  BetweenSteps read = between_steps(look.capture.time_s, alpha, look.usable, step);
  const auto known = std::count(read.known.begin(), read.known.end(), char{1}),
             used = std::count(look.usable.begin(), look.usable.end(), char{1});
  if (static_cast<double>(known) < (1.0 - kFew) * static_cast<double>(used))
    return;
  alpha = std::move(read.angle);
  look.usable = std::move(read.known);
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

} // namespace

Kinematics motion_by_reference(Screened &look, Scene &scene) {
  const Capture &capture = look.capture;
  std::vector<double> alpha(capture.size());
  for (std::size_t i = 0; i < alpha.size(); ++i)
    alpha[i] = capture.reference_deg[i] * kRadPerDeg;
  leave_out_wrong_rows(alpha, look, scene);
  unwrap(alpha, kTwoPi);
  scene.stops = find_stops(capture, alpha);
  // Places that a table stops at, or a drive was told, are no rounding.
  if (!scene.stops && !goes_on_evenly(capture.reference_deg))
    scene.reference_grid_rad = grid_of_some(capture.reference_deg);
  if (scene.stops)
    return at_rest(std::move(alpha), scene.stops.of);
  if (capture.meta.at_rest) {
    std::vector<std::uint32_t> each(alpha.size());
    std::iota(each.begin(), each.end(), std::uint32_t{0});
    return at_rest(std::move(alpha), each);
  }
  scene.reference_ripples =
      ripples_against_time(capture.time_s, alpha, look.usable, kReferenceOrders);
  read_between_steps(look, alpha);
  // On less than a turn a smooth speed is a function of the angle, and what goes with the one is
  // not told from what goes with the other.
  constexpr std::size_t kLeastWindow = 4;
  const auto [low, high] = std::ranges::minmax(alpha);
  const std::size_t window =
      high - low > kTwoPi ? window_of_speed(capture.time_s, alpha, kLeastWindow) : kLeastWindow;
  Kinematics motion = differentiate(capture.time_s, std::move(alpha), window);
  leave_out_changes(motion, look.usable);
  return motion;
}

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
                      ripples_by_chance(smooth, time_with_losses(look), look.angle, look.usable);
  if (ripples_too_much(smooth)) {
    look.usable = before;
    return motion_of_the_pair_itself(look, scene);
  }
  std::vector<std::uint32_t> unfitted;
  if (scene.radius_only) { // what no smooth motion fits has a radius all the same
    for (std::size_t i = 0; i < before.size(); ++i)
      if (before[i] && !look.usable[i])
        unfitted.push_back(static_cast<std::uint32_t>(i));
    look.usable = before;
    smooth.motion.alpha = look.angle;
  } else {
    scene.knots = std::move(smooth.knots);
    unfitted = rough = left_out(before, look);
  }
  if (!unfitted.empty()) { // how fast it turned there tells the pair as well
    const Kinematics own = differentiate(look.capture.time_s, look.angle, kHalfWindow);
    for (std::uint32_t i : unfitted) {
      smooth.motion.alpha[i] = own.alpha[i];
      smooth.motion.omega[i] = own.omega[i];
      smooth.motion.accel[i] = own.accel[i];
    }
  }
  return std::move(smooth.motion);
}

} // namespace ada

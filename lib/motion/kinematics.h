// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Angle, speed and sense of rotation over time, from a reference or from the sensor itself.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace ada {

/// Columns of one length.
struct Kinematics {
  std::vector<double> alpha, omega;   ///< rad, rad/s
  std::vector<float> accel;           ///< rad/s^2
  std::vector<signed char> direction; ///< -1 or +1
  std::vector<float> travel;          ///< rad, since it last turned back; of a reference only
  double reach_s = 0.0;               ///< omega is about the mean over as much on either side
};

/// Takes the jumps by whole periods out of an angle in place.
void unwrap(std::vector<double> &angle, double period);

/// A shaft has turned back where its angle is this many standard deviations of its noise behind the
/// furthest: a million samples at rest spread over ten of them.
inline constexpr double kBackBeyondNoise = 12.0;

/// Sense of rotation at each value of an unwrapped angle, -1 or +1: at rest that of the motion
/// before, as in the shaft, its bearings and a magnet's hysteresis.
std::vector<signed char> senses_of(std::span<const double> alpha);

/// Way since the shaft last turned back, rad, by its senses; before the first time it is infinite.
std::vector<float> travel_since_reversal(std::span<const double> alpha,
                                         std::span<const signed char> senses);

/// First value of an unwrapped angle that is away from where it began by more than its noise; their
/// number where none is.
std::size_t first_motion(std::span<const double> alpha);

/// Samples to either side over which the speed of an unwrapped angle is told best, from `least` on:
/// twice as many as long as the speeds that they tell differ by no more than the noise of the angle
/// makes them (Lepski, Theory Probab. Appl. 35, 454, 1990). Of an angle without noise that is
/// `least`.
std::size_t window_of_speed(std::span<const double> time, std::span<const double> alpha,
                            std::size_t least);

/// Speed and acceleration of an unwrapped angle by local straight lines over +-half_window samples.
Kinematics differentiate(std::span<const double> time, std::vector<double> alpha,
                         std::size_t half_window);

/// Slowest speed, rad/s, of a motion in one sense over a range in which a ripple of the shaft and
/// an error of the sensor are told apart: what drives or brakes a shaft unevenly has the less time
/// for it the faster it turns, and its ripple of the angle falls with the square of the speed. 0:
/// there is no such range, or the shaft rests in between, where that is no law.
double slowest_of_range(std::span<const double> omega);

/// What is left of a ripple at a speed, of what it is at the slowest.
inline double ripple_at(double omega, double slowest) {
  const double part = slowest / omega;
  return part * part < 1.0 ? part * part : 1.0;
}

/// What a smooth motion leaves over: its periodic part, by mechanical order.
struct SmoothMotion {
  Kinematics motion;                 ///< the smooth motion alone
  std::vector<double> cos, sin;      ///< rad: periodic part, entry n - 1 is order n
  std::vector<double> knots;         ///< of the motion, s
  double residual_rms_rad = 0.0;     ///< what neither explains
  double slow_rad = 0.0;             ///< of that what goes on for a tenth of a turn or more
  std::vector<std::uint32_t> spikes; ///< single samples that stand out of both
};

/// Splits an unwrapped angle into a smooth motion (a spline with knots every three quarters of a
/// turn, which cannot follow a ripple of order 1) and `orders` harmonics of the turn, jointly, so
/// that neither leaks into the other; over a range of speeds also the lowest of them as they fall
/// with the square of the speed. Where one cubic over the whole record does as well as the
/// knots, it is the motion. Stretches that are no smooth motion, such as the kinks between two
/// speeds, are marked unusable, and so are single samples that stand out.
SmoothMotion smooth_motion(std::span<const double> time, std::span<const double> angle,
                           std::span<char> usable, int orders);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// The shaft: true mechanical angle as a closed function of time.
///
/// Everything downstream (delay, skew, oversampled filters) asks for the angle at arbitrary
/// moments, so each piece of the motion is integrated by hand and nothing is tabulated.

#pragma once

#include <cstddef>
#include <vector>

namespace truth {

inline constexpr double kDegree = 3.14159265358979323846 / 180.0;
inline constexpr double kTurn = 2.0 * 3.14159265358979323846;
inline constexpr double kRpm = kTurn / 60.0;

/// Uneven rotation locked to the shaft: alpha = m + amplitude sin(order m + phase), with m the
/// even part of the motion. Amplitude and phase in rad.
struct Ripple {
  int order = 0;
  double amplitude = 0.0;
  double phase = 0.0;
};

/// One line of an irregular drive: adds amplitude sin(rate t + phase) to the angle.
struct WanderLine {
  double amplitude = 0.0; // rad
  double rate = 0.0;      // rad/s
  double phase = 0.0;
};

class Motion {
public:
  /// Turns at \p speed (rad/s) for \p duration (s). A speed of zero is a dwell.
  void hold(double duration, double speed);
  /// Goes from the present speed to \p speed along half a cosine, so that neither speed nor
  /// acceleration jumps; through zero it is a reversal.
  void change(double duration, double speed);
  /// Goes from the present speed to \p speed at constant acceleration.
  void ramp(double duration, double speed);
  /// Drive off, viscous friction: w(t) = w0 exp(-t/tau).
  void coast(double duration, double tau);

  void start_at(double angle) { start_ = angle; }
  void add_ripple(const Ripple &ripple) { ripples_.push_back(ripple); }
  void add_wander(const WanderLine &line) { wander_.push_back(line); }

  double duration() const { return end_; }
  double angle(double t) const;
  double speed(double t) const;
  /// Only for disturbances that depend on it; of the even part of the motion.
  double acceleration(double t) const;

private:
  enum class Kind { hold, change, ramp, coast };
  struct Piece {
    Kind kind;
    double begin;    // s
    double duration; // s
    double angle;    // rad at begin
    double from;     // rad/s
    double to;       // rad/s; for coast the time constant
  };
  void append(Kind kind, double duration, double from, double to);
  const Piece &piece_at(double t) const;
  static double piece_angle(const Piece &piece, double t);
  static double piece_speed(const Piece &piece, double t);

  std::vector<Piece> pieces_;
  std::vector<Ripple> ripples_;
  std::vector<WanderLine> wander_;
  double start_ = 0.0;
  double end_ = 0.0;
};

} // namespace truth

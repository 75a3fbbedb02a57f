// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace truth {
namespace {
constexpr double kPi = std::numbers::pi;
}

double Motion::piece_angle(const Piece &piece, double t) {
  // Before its begin the first piece, and after its end the last one, go on at the speed that
  // they have there: filters are run in before the first sample and delays look back.
  const double local = t - piece.begin;
  const double inside = std::clamp(local, 0.0, piece.duration);
  double angle = piece.angle;
  switch (piece.kind) {
  case Kind::hold:
    angle += piece.from * inside;
    break;
  case Kind::change: // integral of from + (to-from)(1 - cos(pi x/T))/2
    angle += piece.from * inside +
             (piece.to - piece.from) * (inside / 2 - piece.duration / (2 * kPi) *
                                                         std::sin(kPi * inside / piece.duration));
    break;
  case Kind::ramp:
    angle += piece.from * inside + (piece.to - piece.from) * inside * inside / (2 * piece.duration);
    break;
  case Kind::coast:
    angle += piece.from * piece.to * -std::expm1(-inside / piece.to);
    break;
  }
  return angle + (local - inside) * piece_speed(piece, piece.begin + inside);
}

double Motion::piece_speed(const Piece &piece, double t) {
  const double x = std::clamp(t - piece.begin, 0.0, piece.duration);
  switch (piece.kind) {
  case Kind::hold:
    break;
  case Kind::change:
    return piece.from + (piece.to - piece.from) * (1 - std::cos(kPi * x / piece.duration)) / 2;
  case Kind::ramp:
    return piece.from + (piece.to - piece.from) * x / piece.duration;
  case Kind::coast:
    return piece.from * std::exp(-x / piece.to);
  }
  return piece.from;
}

void Motion::append(Kind kind, double duration, double from, double to) {
  const double angle = pieces_.empty() ? 0.0 : piece_angle(pieces_.back(), end_);
  pieces_.push_back({kind, end_, duration, angle, from, to});
  end_ += duration;
}

void Motion::hold(double duration, double speed) {
  append(Kind::hold, duration, speed, speed);
}

void Motion::change(double duration, double speed) {
  append(Kind::change, duration, pieces_.empty() ? 0.0 : piece_speed(pieces_.back(), end_), speed);
}

void Motion::ramp(double duration, double speed) {
  append(Kind::ramp, duration, pieces_.empty() ? 0.0 : piece_speed(pieces_.back(), end_), speed);
}

void Motion::coast(double duration, double tau) {
  append(Kind::coast, duration, pieces_.empty() ? 0.0 : piece_speed(pieces_.back(), end_), tau);
}

const Motion::Piece &Motion::piece_at(double t) const {
  auto after = std::upper_bound(pieces_.begin(), pieces_.end(), t,
                                [](double time, const Piece &piece) { return time < piece.begin; });
  return after == pieces_.begin() ? *after : *(after - 1);
}

double Motion::angle(double t) const {
  const double even = start_ + piece_angle(piece_at(t), t);
  double angle = even;
  for (const Ripple &ripple : ripples_)
    angle += ripple.amplitude * std::sin(ripple.order * even + ripple.phase);
  for (const WanderLine &line : wander_)
    angle += line.amplitude * std::sin(line.rate * t + line.phase);
  return angle;
}

double Motion::speed(double t) const {
  const Piece &piece = piece_at(t);
  const double even = start_ + piece_angle(piece, t);
  const double even_speed = piece_speed(piece, t);
  double speed = even_speed;
  for (const Ripple &ripple : ripples_)
    speed +=
        ripple.amplitude * ripple.order * even_speed * std::cos(ripple.order * even + ripple.phase);
  for (const WanderLine &line : wander_)
    speed += line.amplitude * line.rate * std::cos(line.rate * t + line.phase);
  return speed;
}

double Motion::acceleration(double t) const {
  const Piece &piece = piece_at(t);
  const double x = t - piece.begin;
  if (x < 0.0 || x > piece.duration)
    return 0.0;
  switch (piece.kind) {
  case Kind::hold:
    break;
  case Kind::change:
    return (piece.to - piece.from) * kPi / (2 * piece.duration) *
           std::sin(kPi * x / piece.duration);
  case Kind::ramp:
    return (piece.to - piece.from) / piece.duration;
  case Kind::coast:
    return -piece.from / piece.to * std::exp(-x / piece.to);
  }
  return 0.0;
}

} // namespace truth

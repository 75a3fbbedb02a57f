// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/turn_window.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "base/angle.h"

namespace ada {

namespace {

constexpr std::size_t kBinsPerPeriod = 32;
/// A step longer than this may as well have gone the other way round.
constexpr double kMaxStep = 0.8 * kPi;
/// Longer than this in one bin is standing still, and the drift meanwhile is no part of a turn.
constexpr double kMaxStay_s = 2.0;
/// Windows that last longer say nothing about a drift.
constexpr double kMaxWindow_s = 60.0;

/// The five parameters of the ellipse, and the rates of the two centres.
constexpr int kMoments = kEllipseSize + 2;
using Row = Eigen::Matrix<double, kMoments, 1>;
using Square = Eigen::Matrix<double, kMoments, kMoments>;

} // namespace

TurnWindow::TurnWindow(int periods_per_turn)
    : count_(std::min(kBinsPerPeriod * static_cast<std::size_t>(periods_per_turn), kMaxBins)),
      turn_rad_(kTwoPi * periods_per_turn) {}

void TurnWindow::reset() {
  bins_.fill(Bin());
  empty_ = true;
  several_turns_ = false;
}

std::optional<TurnEstimate> TurnWindow::add(double time_s, double sin_psi, double cos_psi,
                                            double distance_v, double amplitude_v) {
  const double raw = std::atan2(sin_psi, cos_psi);
  const double step = wrap_centred(raw - raw_, kTwoPi);
  const bool lost = std::abs(step) > kMaxStep;
  raw_ = raw;
  if (empty_ || lost || time_s < last_time_) {
    reset();
    empty_ = false;
    psi_ = from_ = raw;
    first_time_ = moved_time_ = time_s;
    bin_ = count_;
  } else {
    psi_ += step;
  }
  last_time_ = time_s;

  const double turn = wrap(psi_ / turn_rad_, 1.0);
  const std::size_t bin =
      std::min(static_cast<std::size_t>(turn * static_cast<double>(count_)), count_ - 1);
  if (bin != bin_) {
    bin_ = bin;
    // Noise at the border between two bins is no motion: the neighbour must be left as well.
    still_ = false;
    moved_time_ = time_s;
  } else if (time_s - moved_time_ > kMaxStay_s) {
    still_ = true;
  }
  if (still_ || time_s - first_time_ > kMaxWindow_s) {
    const bool still = still_;
    reset();
    still_ = still;
    return std::nullopt;
  }

  Bin &b = bins_[bin];
  b.n += 1;
  b.distance += distance_v;
  b.square += distance_v * distance_v;
  b.sin += sin_psi;
  b.cos += cos_psi;
  b.time += time_s;
  if (std::abs(psi_ - from_) < turn_rad_)
    return std::nullopt;
  if (!covered()) {
    from_ += std::copysign(turn_rad_, psi_ - from_); // one more turn into the same bins
    several_turns_ = true;
    return std::nullopt;
  }
  std::optional<TurnEstimate> estimate = solve(amplitude_v);
  reset();
  return estimate;
}

/// No two neighbouring bins empty, seldom one.
bool TurnWindow::covered() const {
  std::size_t empty = 0;
  for (std::size_t i = 0; i < count_; ++i)
    if (bins_[i].n == 0) {
      ++empty;
      if (bins_[(i + 1) % count_].n == 0)
        return false;
    }
  return 10 * empty <= count_;
}

std::optional<TurnEstimate> TurnWindow::solve(double amplitude_v) const {
  double within = 0, samples = 0, occupied = 0, inverse_count = 0, time = 0;
  for (std::size_t i = 0; i < count_; ++i)
    if (const Bin &b = bins_[i]; b.n > 0) {
      within += b.square - b.distance * b.distance / b.n;
      samples += b.n;
      occupied += 1;
      inverse_count += 1 / b.n;
      time += b.time / b.n;
    }
  TurnEstimate e;
  e.time_s = time / occupied;
  e.duration_s = last_time_ - first_time_;
  const int columns = several_turns_ || !(e.duration_s > 0) ? kMoments - 2 : kMoments;
  if (occupied <= kMoments)
    return std::nullopt;

  Square information = Square::Zero();
  Row gradient = Row::Zero();
  double total = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Bin &b = bins_[i];
    if (b.n == 0)
      continue;
    const double mean = b.distance / b.n, s = b.sin / b.n, c = b.cos / b.n;
    const double t = columns == kMoments ? (b.time / b.n - e.time_s) / e.duration_s : 0.0;
    Row row; // derivatives of the distance near a circle, in the order of EllipseIndex
    row << 1, 0.5 * amplitude_v * (s * s - c * c), amplitude_v * s * c, s, c, s * t, c * t;
    information += row * row.transpose();
    gradient += mean * row;
    total += mean * mean;
  }
  for (int i = columns; i < kMoments; ++i)
    information(i, i) = 1; // not estimated
  const auto factor = information.ldlt();
  if (factor.info() != Eigen::Success)
    return std::nullopt;
  const Row change = factor.solve(gradient);
  const Square inverse = factor.solve(Square::Identity());
  const double unexplained = std::max(total - change.dot(gradient), 0.0) / (occupied - columns);
  const double noise =
      samples > occupied ? std::max(within, 0.0) / (samples - occupied) : unexplained;
  // A bin mean carries the noise of its samples, and whatever it has that is no ellipse.
  const double variance = std::max(noise * inverse_count / occupied, unexplained);
  e.unexplained_rms_v = std::sqrt(unexplained);
  const auto error = [&](int i) { return std::sqrt(variance * inverse(i, i)); };
  for (std::size_t i = 0; i < kEllipseSize; ++i) {
    e.change[i] = change[static_cast<Eigen::Index>(i)];
    e.error[i] = error(static_cast<int>(i));
  }
  e.rate_sin_error = e.rate_cos_error = std::numeric_limits<double>::infinity();
  if (columns == kMoments) {
    e.rate_sin = change[kMoments - 2] / e.duration_s;
    e.rate_cos = change[kMoments - 1] / e.duration_s;
    e.rate_sin_error = error(kMoments - 2) / e.duration_s;
    e.rate_cos_error = error(kMoments - 1) / e.duration_s;
  }
  return e;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/watch_history.h"

#include <algorithm>

namespace cli {

namespace {

/// Over which rate, speed and noise are taken.
constexpr double kMoment_s = 0.5;
constexpr double kBin_s = WatchHistory::kSeconds / static_cast<double>(WatchHistory::kBins);
/// Of the second difference of white noise: 1 + 1/4 + 1/4.
constexpr double kSecondDifference = 1.5;
constexpr int kEnough = 8;

} // namespace

void Band::add(double value) {
  low = std::min(low, value);
  high = std::max(high, value);
}

void Band::add(const Band &other) {
  low = std::min(low, other.low);
  high = std::max(high, other.high);
}

void WatchHistory::Noise::add(double value) {
  if (run >= 2) {
    const double rest = before[1] - (before[0] + value) / 2;
    squares += rest * rest;
    ++count;
  }
  before[0] = before[1];
  before[1] = value;
  ++run;
}

void WatchHistory::Noise::close() {
  rms = count >= kEnough ? std::sqrt(squares / (kSecondDifference * count)) : NAN;
  squares = 0;
  count = 0;
}

std::size_t WatchHistory::place(std::size_t bin) const {
  const std::int64_t number =
      newest_ - static_cast<std::int64_t>(kBins) + 1 + static_cast<std::int64_t>(bin);
  const auto size = static_cast<std::int64_t>(kBins);
  return static_cast<std::size_t>((number % size + size) % size);
}

void WatchHistory::add(std::span<const ada4571_frame> frames,
                       std::span<const ada4571_angle> angles) {
  for (const ada4571_angle &angle : angles) {
    if (samples_ == 0)
      moment_s_ = angle.time_s;
    ++samples_;
    ++moment_samples_;
    const auto number = static_cast<std::int64_t>(std::floor(angle.time_s / kBin_s));
    // Whatever was longer ago than the window is gone; times that stand still add to one bin.
    const std::int64_t from = std::max(newest_ + 1, number - static_cast<std::int64_t>(kBins) + 1);
    newest_ = samples_ == 1 ? number : std::max(newest_, number);
    for (std::int64_t fresh = from; fresh <= number; ++fresh)
      bins_[place(kBins - 1 - static_cast<std::size_t>(newest_ - fresh))] = {fresh, {}, {}};
    if ((angle.status & ~unsigned{ADA4571_SAMPLE_GAP}) == 0 && std::isfinite(angle.angle_deg))
      add_sound(angle);
    else
      ++unsound_;
    if (angle.status & ADA4571_SAMPLE_GAP) {
      angle_noise_.cut();
      radius_noise_.cut();
    }
    last_ = angle;
    if (angle.time_s - moment_s_ >= kMoment_s)
      close_moment();
  }
  if (!frames.empty())
    last_frame_ = frames.back();
}

void WatchHistory::add_sound(const ada4571_angle &angle) {
  const double wrapped = angle.angle_deg;
  unwrapped_deg_ = turned_
                       ? unwrapped_deg_ + std::remainder(wrapped - unwrapped_deg_, range_deg_)
                       : wrapped;
  if (!turned_)
    moment_deg_ = unwrapped_deg_;
  turned_ = true;
  Bin &bin = bins_[place(kBins - 1)];
  bin.angle.add(unwrapped_deg_);
  bin.radius.add(angle.radius);
  angle_noise_.add(unwrapped_deg_);
  radius_noise_.add(angle.radius);
}

void WatchHistory::close_moment() {
  const double seconds = last_.time_s - moment_s_;
  rate_hz_ = static_cast<double>(moment_samples_) / seconds;
  speed_deg_per_s_ = (unwrapped_deg_ - moment_deg_) / seconds;
  angle_noise_.close();
  radius_noise_.close();
  moment_s_ = last_.time_s;
  moment_deg_ = unwrapped_deg_;
  moment_samples_ = 0;
}

} // namespace cli

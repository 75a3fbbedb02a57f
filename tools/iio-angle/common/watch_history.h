// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What `watch` shows of a stream of angles: the last seconds, and numbers of the last moment.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "ada4571.h"

namespace cli {

/// The least and the greatest value in a part of the time.
struct Band {
  double low = INFINITY, high = -INFINITY;

  bool empty() const { return low > high; }
  void add(double value);
  void add(const Band &other);
};

class WatchHistory {
public:
  static constexpr double kSeconds = 10.0;
  static constexpr std::size_t kBins = 500;

  explicit WatchHistory(double range_deg) : range_deg_(range_deg) {}

  void add(std::span<const ada4571_frame> frames, std::span<const ada4571_angle> angles);

  double range_deg() const { return range_deg_; }
  bool empty() const { return samples_ == 0; }
  const ada4571_angle &last() const { return last_; }
  const ada4571_frame &last_frame() const { return last_frame_; }
  std::uint64_t samples() const { return samples_; }
  std::uint64_t unsound() const { return unsound_; }
  double rate_hz() const { return rate_hz_; }
  double speed_deg_per_s() const { return speed_deg_per_s_; }
  /// From sample to sample, whatever the shaft does slowly; NaN before there are enough.
  double angle_noise_deg() const { return angle_noise_.rms; }
  double radius_noise() const { return radius_noise_.rms; }

  /// Angle, without its leaps at the ends of the range, and radius; 0 is the oldest bin.
  Band angle(std::size_t bin) const { return bins_[place(bin)].angle; }
  Band radius(std::size_t bin) const { return bins_[place(bin)].radius; }

private:
  struct Bin {
    std::int64_t number = -1;
    Band angle, radius;
  };
  /// Second differences: what is left of a value when its neighbours' mean is taken off.
  struct Noise {
    double before[2] = {}, squares = 0, rms = NAN;
    int run = 0, count = 0;
    void add(double value);
    void cut() { run = 0; }
    void close();
  };

  void add_sound(const ada4571_angle &angle);
  void close_moment();
  std::size_t place(std::size_t bin) const;

  double range_deg_;
  ada4571_angle last_{};
  ada4571_frame last_frame_{};
  std::uint64_t samples_ = 0, unsound_ = 0;
  double unwrapped_deg_ = 0;
  bool turned_ = false; ///< unwrapped_deg_ is of a sample
  std::array<Bin, kBins> bins_;
  std::int64_t newest_ = 0;
  double moment_s_ = 0, moment_deg_ = 0; ///< where the moment began
  std::uint64_t moment_samples_ = 0;
  double rate_hz_ = NAN, speed_deg_per_s_ = NAN;
  Noise angle_noise_, radius_noise_;
};

} // namespace cli

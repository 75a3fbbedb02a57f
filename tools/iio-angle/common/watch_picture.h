// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The live picture of `watch`: numbers from a stream of angles, drawn as text.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "ada4571.h"

namespace cli {

class Picture {
public:
  /// range_deg: 360/p.
  Picture(std::string title, double range_deg);

  void add(std::span<const ada4571_angle> angles);
  void set_lost(std::uint64_t lost) { lost_ = lost; }
  /// Whether a twentieth of a second of samples came since the last drawing.
  bool due() const { return seen_ > 0 && last_.time_s - drawn_s_ >= kInterval_s; }
  /// The picture for a terminal of that width; begins the next interval.
  std::string draw(int columns);
  /// Moves the cursor to where the last drawing began.
  std::string back_to_top() const;

private:
  static constexpr double kInterval_s = 0.05;

  std::string title_;
  double range_deg_;
  ada4571_angle last_{};
  std::uint64_t seen_ = 0, unsound_ = 0, lost_ = 0;
  double drawn_s_ = -1e9;
  double travel_deg_ = 0, travel_s_ = 0; ///< signed, of this interval
  std::uint64_t interval_samples_ = 0;
  double speed_deg_per_s_ = 0, rate_hz_ = 0;
};

} // namespace cli

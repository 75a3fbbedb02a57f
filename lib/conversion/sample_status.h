// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Which samples are sound: the bits of ada4571_angle.status.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/frame.h"

namespace ada {

/// Band of the relative radius in which a sample counts as sound. Wide enough for a sensor whose
/// amplitude follows temperature (gain control off) under a calibration that does not, narrow
/// enough to catch a broken wire: one channel at mid-supply gives |cos psi|, one at a rail more
/// than 1.7 at an amplitude of 0.29 VDD.
inline constexpr double kRadiusMin = 0.7;
inline constexpr double kRadiusMax = 1.3;

/// A channel within this fraction of the supply from ground or VDD sits at a rail.
inline constexpr double kRailMargin = 0.01;

struct Rails {
  double low_v, high_v;
  explicit Rails(double supply_v) : low_v(kRailMargin * supply_v), high_v(supply_v - low_v) {}
};

inline std::uint32_t rail_status(double vsin_v, double vcos_v, double supply_v) {
  const Rails at(supply_v);
  const bool rail =
      vsin_v <= at.low_v || vsin_v >= at.high_v || vcos_v <= at.low_v || vcos_v >= at.high_v;
  return rail ? std::uint32_t{ADA4571_SAMPLE_RAIL} : 0u;
}

inline std::uint32_t radius_status(double radius) {
  const bool sound = radius >= kRadiusMin && radius <= kRadiusMax;
  return sound ? 0u : std::uint32_t{ADA4571_SAMPLE_RADIUS};
}

} // namespace ada

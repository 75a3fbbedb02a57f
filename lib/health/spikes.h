// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Samples that stand alone: a moment before and after them everything is as it was.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "base/robust.h"
#include "calibration/ellipse_fit.h"
#include "health/criteria.h"
#include "recording/capture.h"

namespace ada::health {

/// Places in the pair, ascending: with an ellipse those by the distance from it and those by the
/// angle about it, without one those of VSIN and of VCOS. `far` is where no neighbour need be
/// asked, and so those in a row of up to kFarReach: off the ellipse by kFarOff, without one beyond
/// the supply.
struct PairPlaces {
  std::vector<std::size_t> off, along, far;
  /// Where the angle jumps and runs back from there, which are no spikes.
  std::vector<std::size_t> reversals{};
  std::vector<std::size_t> all() const;
};

/// What no output does at this supply (kRangeMargin).
inline bool beyond_supply(double volts, double supply_v) {
  return volts < -kRangeMargin * supply_v || volts > (1 + kRangeMargin) * supply_v;
}

/// Finds them in stretches of a recording, by limits that are measured on a sample of it. How rare
/// they are, and so whether they are spikes at all, shows only in all of it.
class SpikeFinder {
public:
  /// `samples` of the whole recording, of which `sample` may be all.
  SpikeFinder(const Capture &sample, std::size_t samples, const std::optional<EllipseFit> &ellipse);

  /// Samples on either side of a stretch that its own are judged by.
  static constexpr std::size_t kHalo = std::max(kJudgedBy, 2 * kFarReach);

  /// Where the pair stands out in a stretch. Distance and angle do not move much from sample to
  /// sample, however fast the magnet turns; without an ellipse it is channel by channel.
  PairPlaces pair(const Capture &stretch) const;
  /// Of a column that changes slowly; in a row of up to kFarReach where they are as far off as no
  /// temperature and no supply moves so soon.
  std::vector<std::size_t> vtemp(std::span<const double> column) const;
  std::vector<std::size_t> vdd(std::span<const double> column) const;
  /// Of a reference that goes with the sensor, by the angle between them.
  std::vector<std::size_t> reference(const Capture &stretch, const PairPlaces &pair) const;

  /// Whether `far` is a fault however often it is. Where most of a channel lies beyond the supply
  /// it is the supply that is wrong.
  bool far_is_wrong() const { return far_is_wrong_; }
  /// The spikes among all the places of the recording.
  std::vector<std::size_t> spikes(PairPlaces all) const;
  std::vector<std::size_t> spikes(std::vector<std::size_t> all) const;
  /// So many places are none: what is not rare is structure (base/robust.h).
  bool is_structure(std::size_t places) const;

private:
  double column_limit(const std::vector<double> &column) const;
  void follow_reference(const Capture &sample, const std::vector<double> &psi);
  std::vector<double> from_reference(const Capture &capture, const std::vector<double> &psi) const;

  std::size_t samples_;
  std::optional<EllipseParameters> ellipse_;
  double sin_limit_v_ = 0, cos_limit_v_ = 0, vtemp_limit_v_ = 0, vdd_limit_v_ = 0;
  double vtemp_far_v_ = 0, vdd_far_v_ = 0;
  bool far_is_wrong_ = true;
  double reference_sense_ = 0, reference_zero_rad_ = 0, reference_limit_rad_ = 0;
  double off_limit_v_ = 0, along_limit_rad_ = 0, far_limit_v_ = 0;
};

} // namespace ada::health

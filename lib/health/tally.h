// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What is counted sample by sample, over all of a recording: one pass in blocks.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "calibration/recording_to_fit.h"
#include "health/spikes.h"
#include "model/model.h"
#include "recording/gap_detector.h"
#include "recording/recording.h"

namespace ada::health {

/// How many samples have a fault, and the longest row of them.
struct Faults {
  std::size_t count = 0, longest = 0, longest_first = 0;
};

/// Counts the faults of samples that come in order, or of stretches that do.
class FaultRow {
public:
  void add(bool faulty);
  void add_sound(std::size_t samples);
  void append(const FaultRow &next);
  const Faults &faults() const { return faults_; }

private:
  void end_row(std::size_t length, std::size_t end);

  Faults faults_;
  std::size_t samples_ = 0, leading_ = 0, trailing_ = 0; ///< rows at both ends
};

/// The steps of time from sample to sample.
struct TimeSteps {
  std::size_t back = 0, first_back = 0;         ///< or no number
  std::size_t standing = 0, first_standing = 0; ///< the time of the sample before
  std::size_t gaps = 0;
  double longest_gap_s = 0, lost = 0;
};

struct Tally {
  FaultRow rails, radius, invalid;
  FaultRow beyond;             ///< what the supply allows
  FaultRow same_sin, same_cos; ///< the value of the sample before
  std::size_t usable = 0;      ///< pairs of numbers
  /// Of the radius, but for the spikes.
  double least_radius = std::numeric_limits<double>::infinity(), greatest_radius = -least_radius;
  std::vector<std::size_t> spikes; ///< samples of the pair that stand alone, ascending
  Faults disturbing;               ///< of them, those that a sound sensor's error does not reach
  std::size_t far = 0; ///< samples far off the ellipse, be they spikes or too many for that
  bool far_are_many = false;
  std::vector<std::size_t> vtemp_spikes, vdd_spikes, reference_spikes;
  std::size_t reversals = 0, first_reversal = 0; ///< at one stroke
  TimeSteps steps;
  std::size_t vtemp_jumps = 0, first_vtemp_jump = 0;
  FaultRow same_vtemp; ///< the value of the sample before
  Pairs path; ///< of a recording of more than kPathSamples so many single pairs, else none
};

inline constexpr std::size_t kPathSamples = kFittedWhole;

/// How far VTEMP goes from the median of seven samples to that of the next seven, V; no number
/// where they are not there, or where it takes no longer than kVtempJumpDegPerS allows.
class VtempJumps {
public:
  explicit VtempJumps(const Capture &sample);
  /// Whether it jumps between this sample and the next one.
  bool after(const Capture &stretch, std::size_t i) const;

private:
  double limit_v_ = 0, slope_v_s_ = 0;
};

/// `yardstick` is what radius and status are of; `usual_s` the usual step of time.
Tally take_tally(const Recording &recording, const Model &yardstick, const SpikeFinder &spikes,
                 const VtempJumps &jumps, double usual_s);

} // namespace ada::health

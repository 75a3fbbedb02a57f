// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// The circumstances of a capture: drive, temperature profile, sampling rate, channels. An
/// effect states what it needs in order to be visible, and the circumstances are drawn so.

#pragma once

#include "capture.h"
#include "random.h"
#include <string>
#include <vector>

namespace truth {

enum class MotionKind {
  one_speed,       // one speed, one direction
  speeds,          // several speeds, one direction
  reversals,       // one absolute speed, both directions
  speed_reversals, // several speeds, both directions
  ramps,           // constant accelerations
  coast,           // spins down freely
  dwell,           // runs, stands, runs
  restless,        // never at constant speed: long accelerations and decelerations
  step_reversal,   // one absolute speed, reversed between two samples
  ragged,          // irregular at the rate of the rotation, as if turned by hand
};

std::string to_string(MotionKind kind);

enum class Wanted { no, maybe, yes };

struct Needs {
  std::vector<MotionKind> motions; // empty: any steady enough
  Wanted reference = Wanted::maybe;
  Wanted vtemp = Wanted::maybe;
  Wanted vdd = Wanted::maybe;
  bool sweep = false;           // temperature must change by tens of kelvin
  bool slow = false;            // minutes: thermal time constants matter
  bool fast = false;            // effects that grow with speed
  bool gain_off = false;        // gain control off
  Wanted noise = Wanted::maybe; // stated noise in the metadata
  int periods = 0;              // 1 or 2; 0: either
};

/// False when the two cannot be had in one capture.
bool merge(Needs &into, const Needs &other);

/// Draws everything but the effects.
struct Conditions {
  Bench bench;
  MotionKind motion;
  double lowest_rpm = 0.0; // of the plateaus
  double highest_rpm = 0.0;
};
Conditions draw_conditions(Random &random, const Needs &needs);

/// Only the drive, for a capture of a rate and length that are already known.
Motion draw_motion(Random &random, MotionKind kind, const Bench &bench, bool fast,
                   Conditions *conditions = nullptr);

} // namespace truth

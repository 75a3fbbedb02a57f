// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// One entry for each cause of the catalogue: what it needs in order to be visible, how its size
/// is drawn and put into the physics, and the truth that a diagnosis must find.

#pragma once

#include "conditions.h"
#include "finding.h"
#include <string>
#include <vector>

namespace truth {

struct HiddenEffect {
  std::string cause;
  Needs needs;
  /// Of two effects with a group in common only one goes into a capture: they act on the same
  /// terms and the pair could not be told apart, or one destroys what shows the other.
  std::vector<std::string> groups;
  /// \p scale 1 draws from the usual range; a small one hides it below the noise.
  /// Adds one or more truths (a lag cannot be seen without a drift).
  void (*hide)(Random &random, Conditions &conditions, double scale, std::vector<Truth> &truths);
  bool alone = false; // not combined with others
  bool bench = false; // what real benches add; has a category of its own
};

/// The entries of what real benches add.
std::vector<HiddenEffect> bench_effects();

const std::vector<HiddenEffect> &hidden_effects();
const HiddenEffect *find_effect(const std::string &cause);

/// Without a reference angles about the shaft are known up to the sensor's own period.
double direction_period(const Bench &bench, int order);

} // namespace truth

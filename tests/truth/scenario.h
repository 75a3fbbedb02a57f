// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// Draws captures with hidden effects. Everything follows from the seed.

#pragma once

#include "capture.h"
#include "finding.h"
#include <cstdint>
#include <string>
#include <vector>

namespace truth {

struct Options {
  /// single, two, three, four, bench, ambiguous, null, unknown, outside, tiny, short
  std::string category = "single";
  /// single and tiny: a cause of the catalogue; bench: one that benches add; unknown and outside: a
  /// kind; ambiguous: a case; else unused.
  /// Empty: drawn.
  std::string effect;
  /// single to four: factor on the size of every hidden effect.
  double scale = 1.0;
};

struct Scenario {
  std::uint64_t seed = 0;
  Options options;
  Bench bench;
  Expectation expectation;
  std::string description; // one line: motion, rate, temperature, channels, effects
};

const std::vector<std::string> &categories();
/// All causes of the catalogue that can be hidden, in its order.
const std::vector<std::string> &causes();
const std::vector<std::string> &bench_causes();
const std::vector<std::string> &ambiguous_cases();

/// Throws std::invalid_argument for a category or an effect that does not exist.
Scenario random_scenario(std::uint64_t seed, const Options &options);

/// Another capture of the same sensor in the same housing: other motion, other noise, other
/// temperature profile where there is one. What belongs to the recording, the drive, the
/// reference or to one moment stays behind.
Bench second_capture(const Scenario &scenario);

} // namespace truth

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// What a diagnosis should say about a capture, in the vocabulary of the effect catalogue.

#pragma once

#include <map>
#include <ostream>
#include <string>
#include <vector>

namespace truth {

/// A parameter as the catalogue defines it.
struct Parameter {
  double value = 0.0;
  std::string unit;
  /// Accepted error, absolute: 10 % of the value or the stated floor, whichever is larger.
  double tolerance = 0.0;
  /// Values that differ by a multiple of this are the same (0: none).
  double period = 0.0;
  /// For angles about the shaft the value in the reference's frame, beside the sensor's; for
  /// noise the total beside the excess. Accepted as well, and counted.
  bool has_other = false;
  double other = 0.0;
  std::string text; // instead of a value: a channel's name
};

struct Truth {
  std::string cause;
  std::map<std::string, Parameter> parameters;
  /// Other causes as which the finding may stand if it lists the true one as alternative.
  std::vector<std::string> accept;
  /// Names of which the finding must hold all, as cause or as alternative.
  std::vector<std::string> require;
};

struct Expectation {
  std::vector<Truth> effects;
  /// Causes that are not held against the diagnosis.
  std::vector<std::string> tolerated;
  /// Verdicts that are right.
  std::vector<std::string> verdicts;
  bool unexplained = false;
  /// Causes of which one may be named instead of calling the capture unexplained.
  std::vector<std::string> named_instead;
  /// Neither calling it unexplained nor explaining it is wrong.
  bool unexplained_open = false;
  /// The axis of the budget with the most on it; empty: not asked.
  std::string axis;
  /// What the noise floor of a corrected angle follows from: noise/(amplitude periods), in rad.
  double noise_rms_v = 0.0;
  double amplitude_v = 0.0;
  int periods_per_turn = 0;
};

void write_json(std::ostream &out, const Expectation &expectation, const std::string &category,
                const std::string &description, unsigned long long seed);

} // namespace truth

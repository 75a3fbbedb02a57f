// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What a study says, as plain data; json.cpp, text.cpp and page.cpp only read it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "study/fleet.h"
#include "study/signature.h"
#include "study/statistics.h"

namespace ada::study {

struct ParameterSummary {
  std::string parameter, unit;
  std::size_t column = 0; ///< of the fleet
  std::size_t count = 0;
  double median = 0.0,
         mad = 0.0; ///< mad: times 1.4826, so that it compares with a standard deviation
  std::optional<Components> components;
};

struct CauseSummary {
  std::string cause;
  std::size_t found_in = 0, sensors = 0;
  double share = 0.0;
  std::optional<double> angle_rms_deg; ///< median of the captures where it was found
  double fleet_cost_deg = 0.0; ///< rms over all captures, zero where it was not found: the ranking
  std::vector<ParameterSummary> parameters;
};

struct Level {
  std::string word;
  double median = 0.0;
  std::size_t count = 0;
};

struct Dependence {
  std::string cause, parameter, on, unit; ///< parameter "found": whether it is there at all
  std::size_t column = 0, factor = 0;
  bool numeric = false, within_sensors = false;
  std::optional<Trend> trend;
  std::vector<Level> levels;
  double p = 1.0, p_adjusted = 1.0;
};

struct GoesWith {
  std::string key;
  double p_adjusted = 1.0;
};

struct Grouping {
  std::string cause, parameter, unit;
  std::size_t column = 0;
  std::vector<Population> populations;
  std::vector<std::size_t> sizes; ///< sensors in each
  std::optional<GoesWith> goes_with;
};

struct Outlier {
  std::size_t row = 0;
  std::string capture, serial, cause, parameter, sentence;
  double z = 0.0, value = 0.0;
};

/// How far a calibration brings a fleet; each a median over captures, mechanical degrees rms.
struct Candidate {
  std::string name;
  std::vector<std::string> effects;
  std::optional<double> same_capture; ///< learned on one half, judged on the other
  std::optional<double> same_sensor;  ///< learned on one capture, judged on another of the sensor
  std::optional<double> new_sensor;   ///< learned on other sensors
  std::optional<double> heldout;      ///< the hardest of the first two that there is
};

struct Sufficient {
  std::vector<Candidate> candidates;
  std::optional<std::size_t> chosen;
  std::optional<std::size_t> chosen_new; ///< enough where sensors are not calibrated one by one
  std::string sentence;
};

struct Summary {
  std::size_t captures = 0, failed = 0, waiting = 0, sensors = 0, unsound = 0;
  bool diagnosed = true;
  std::vector<CauseSummary> causes;   ///< by what they cost the fleet
  std::vector<CauseSummary> baseline; ///< amplitude, offsets, noise, residual: no causes
  std::vector<Dependence> dependences;
  std::size_t tests = 0; ///< that were made for them
  std::vector<Grouping> groups;
  std::vector<Outlier> outliers;
  Sufficient sufficient;
};

Summary summarise(const Fleet &fleet);

// The parts of it, a file each.
std::vector<CauseSummary> summarise_causes(const Fleet &fleet, bool baseline);
std::vector<Dependence> find_dependences(const Fleet &fleet, std::size_t &tests);
std::vector<Grouping> find_groups(const Fleet &fleet);
std::vector<Outlier> find_outliers(const Fleet &fleet, const std::vector<CauseSummary> &causes);
Sufficient find_sufficient(const Fleet &fleet, const std::vector<CauseSummary> &causes);

std::string to_json(const Summary &summary);
std::string to_text(const Summary &summary);

/// The name of cause and parameter for a sentence: "amplitude_v of the baseline".
std::string quantity_words(const std::string &cause, const std::string &parameter);
/// Four digits, "0.0123".
std::string digits(double value);

} // namespace ada::study

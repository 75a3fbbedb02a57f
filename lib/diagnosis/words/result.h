// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What a diagnosis gives back, as plain data; json.cpp, text.cpp and the report only read it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/axis.h"
#include "diagnosis/conditions/reference_course.h"
#include "model/effect.h"
#include "model/model.h"

namespace ada {

/// How well a model describes data. Angle errors only with a reference.
struct Quality {
  double residual_rms_v = 0.0; ///< of one channel
  double log_likelihood = 0.0; ///< per sample (both channels), natural logarithm
  std::optional<double> angle_error_rms_deg;
};

struct SplitQuality {
  Quality in_sample, heldout;
};

struct Finding {
  const Effect *effect = nullptr;
  std::vector<double> values, std_errors;
  std::vector<std::string> alternatives;
  std::string separate_by, explanation;
  SplitQuality before, after;
  bool correctable = false;
};

/// Where structure is left over.
struct Structure {
  std::string along; ///< angle, time, temperature, speed or frequency
  std::string description;
  double rms_v = 0.0;
  bool comes_again = false; ///< a mean that was seen again at the same places of the angle
};

struct Invisible {
  std::string cause, reason;
};

/// A check of the capture (health/health.h) that failed: what no model of a sensor is to blame for.
struct FailedCheck {
  std::string id, explanation;
};

/// A capture that would tell a cause from others.
struct Experiment {
  std::string motion, temperature; ///< as the simulation takes them (simulation/profile.h)
  double duration_s = 0.0;
  std::vector<std::string> record; ///< columns that the present capture has not
  std::size_t finding = 0;         ///< its place among the findings
  /// The cause, and those that it would be told from.
  std::vector<std::string> separates;
  double expected_nats = 0.0; ///< for the cause, against the likeliest of them
  std::string sentence;
};

/// A line of the budget: what lies on an axis and on none before it, V rms of one channel, on
/// held-out data.
struct BudgetLine {
  Axis axis;
  double rms_v = 0.0, named_rms_v = 0.0, unnamed_rms_v = 0.0;
};

/// Noise of the pair, V rms.
struct NoiseShape {
  double sin_v = 0.0, cos_v = 0.0, along_v = 0.0, across_v = 0.0;
};

enum class Verdict { no_discrepancy, explained, partly_explained, unexplained, insufficient_data };

std::string_view verdict_name(Verdict verdict);

struct Diagnosis {
  // the capture
  std::size_t samples = 0;
  double rows_a_reading = 1.0;  ///< more than one: each pair is held for several rows
  bool held_reference = false;  ///< it is the reference that is held, and not the pair
  double readings_a_stop = 1.0; ///< more than one: each stop of a table counts as one reading
  /// Of a reference that goes away from the shaft; the pair was judged without that.
  std::optional<ReferenceCourse> reference_course;
  /// Why the reference is none of this shaft; the pair was then judged without it. Empty otherwise.
  std::string reference_aside;
  double duration_s = 0.0, turns = 0.0;
  double fastest_rad_s = 0.0; ///< of the shaft
  int periods_per_turn = 2;
  std::vector<std::string> channels;
  bool has_reference = false;
  bool by_reference() const { return has_reference && reference_aside.empty(); }
  bool radius_only = false; ///< the motion is no reference: only the radius was judged
  // the models
  std::string baseline_name = "application note";
  Model baseline, extended;
  SplitQuality baseline_quality, extended_quality;
  // what was found
  std::vector<Finding> findings;
  std::vector<Model> nested;      ///< baseline first, then the model after each finding
  std::vector<BudgetLine> budget; ///< largest first
  Quality anonymous;              ///< of the best model that names nothing
  NoiseShape noise;
  double remainder_rms_v = 0.0, remainder_angle_rms_deg = 0.0; ///< of extended.remainder
  std::vector<Structure> structure;
  std::vector<Invisible> invisible;
  std::vector<Experiment> next_experiments;
  std::vector<FailedCheck> failed_checks;
  double unexplained_rms_v = 0.0, noise_rms_v = 0.0;
  Verdict verdict = Verdict::insufficient_data;
  std::string reason; ///< of insufficient data
};

} // namespace ada

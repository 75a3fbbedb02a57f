// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What a study keeps of one capture. It travels as text from the process that analysed the capture
// to the one that writes the database.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "study/signature.h"

namespace ada::study {

/// A number that is not known.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// One number of a capture. Place 0: what every capture has (the ellipse, the noise); a finding of
/// the diagnosis has its place in the order in which it was found, from 1 on.
struct Quantity {
  int place = 0;
  std::string cause, parameter, unit;
  double value = 0.0, std_error = 0.0; ///< NaN where unknown
  bool operator==(const Quantity &) const = default;
};

/// What numbers of every capture belong to that are no cause: the ellipse and the noise; what is
/// left of a capture once all that was found in it is modelled, on held-out data.
inline constexpr const char *kBaseline = "baseline", *kExtendedModel = "extended-model";
inline bool is_cause(const std::string &name) {
  return name != kBaseline && name != kExtendedModel;
}

struct FoundCause {
  std::string cause;
  std::vector<std::string> alternatives;
  double angle_rms_deg = 0.0; ///< what it costs in angle, mechanical; NaN where unknown
  bool correctable = false;
};

struct CheckLine {
  std::string check, state;
  double measured = 0.0, limit = 0.0; ///< NaN where there is none
  std::string unit;
};

enum class RowState { waiting, done, failed };

struct Row {
  std::string capture; ///< the name by which it was listed
  RowState state = RowState::waiting;
  std::string reason; ///< of a failure
  // provenance
  std::int64_t bytes = 0, modified_ns = 0; ///< of the file, its data file included
  std::string identity, program, report;
  // the capture
  std::string serial;
  bool has_reference = false;
  std::int64_t samples = 0;
  double duration_s = 0.0;
  // what was found
  bool sound = false;
  std::string verdict;
  double extended_angle_rms_deg = 0.0; ///< held out, of the diagnosed model; NaN where unknown
  std::vector<std::pair<std::string, std::string>> factors; ///< metadata of the header
  std::vector<CheckLine> checks;
  std::vector<FoundCause> findings;
  std::vector<Quantity> quantities;
  Signature signature;

  /// The sensor that it is of: one without a serial number is a sensor of its own.
  const std::string &sensor() const { return serial.empty() ? capture : serial; }
};

std::string row_to_text(const Row &row);
/// Throws Error(ADA4571_ERROR_FORMAT).
Row row_from_text(const std::string &text);

/// Which of two rows of one capture is to be kept, in whichever order they come: one that is done,
/// of the younger file.
bool better(const Row &a, const Row &b);

/// Size and time of a capture's files; zeros where there is none.
struct FileStamp {
  std::int64_t bytes = 0, modified_ns = 0;
};
FileStamp stamp_of(const std::string &capture);

} // namespace ada::study

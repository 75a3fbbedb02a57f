// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A whole diagnosis: prepare, search, judge on data that no fit has seen, and say what is left.
#pragma once

#include <functional>

#include "diagnosis/words/result.h"
#include "recording/capture.h"

namespace ada {

struct DiagnosisOptions {
  const Model *baseline = nullptr; ///< nullptr: the application note's model
  std::string baseline_name = "application note";
  const Capture *heldout = nullptr;
  /// Whether each row of the reference errs for itself, as that of a table that stands elsewhere.
  bool reference_errs = false;
  /// Fraction done and what is being done.
  std::function<void(double, const char *)> progress;
};

Diagnosis diagnose(const Capture &capture, const DiagnosisOptions &options);

/// "ada4571-diagnosis/1"
std::string to_json(const Diagnosis &diagnosis);
/// The same for a person.
std::string to_text(const Diagnosis &diagnosis);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// From a capture to its row: checked, calibrated, diagnosed.
#pragma once

#include <functional>
#include <string>

#include "base/error.h"
#include "study/row.h"

namespace ada::study {

struct AnalysisOptions {
  bool diagnose = true;
  std::string report_folder;                          ///< empty: no page of the capture
  std::function<void(double, const char *)> progress; ///< of the diagnosis; ends it by Stopped
};

/// Whoever asked for an analysis does not want it any more.
class Stopped : public Error {
  using Error::Error;
};

/// Never throws for a capture's sake: one that cannot be used is a row with its reason.
Row analyse(const std::string &capture, const AnalysisOptions &options);

/// The row of a capture whose analysis came to nothing.
Row failed_row(const std::string &capture, const std::string &reason);

/// What a finding costs in angle, mechanical degrees rms: against the reference where there is one;
/// else from the volts, half of whose power is taken to lie across the vector, as for mismatch and
/// quadrature error it does.
double angle_cost_deg(double before_v, double after_v, double amplitude_v, int periods);

} // namespace ada::study

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// From a capture to its row: checked, calibrated, diagnosed.
#pragma once

#include <string>

#include "study/row.h"

namespace ada::study {

struct AnalysisOptions {
  bool diagnose = true;
  std::string report_folder; ///< empty: no page of the capture
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

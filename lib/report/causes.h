// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What each cause that was found does by itself: the residual of the extended model without it, and
// on which axes of the budget its part lies.
#pragma once

#include <array>
#include <vector>

#include "diagnosis/words/result.h"
#include "report/axes.h"

namespace ada {

/// What the page shows of one finding.
struct CauseView {
  bool drawn = false; ///< whether the model does something else without it
  Model without;      ///< the extended model but for this cause, nothing fitted again
  ResidualBins bins;  ///< of that model
  double rms_v = 0.0; ///< of what the cause does, one channel
  std::array<double, kAxes>
      share_v2{}; ///< of it, by axis; what the baseline would take up is in none
};

/// One a finding, in their order. `final`: the residual of the extended model for `data`.
std::vector<CauseView> cause_views(const Diagnosis &diagnosis, const Scene &scene,
                                   const Observations &data, const ResidualColumns &final,
                                   const PlotAxes &axes);

/// How the named part of a line of the budget divides among the findings, V rms each; 0 where a
/// finding has no part of it. What drawn causes do not fill belongs to those without a curve that
/// lie on this axis.
std::vector<double> named_parts(const BudgetLine &line, const std::vector<Finding> &findings,
                                const std::vector<CauseView> &causes);

} // namespace ada

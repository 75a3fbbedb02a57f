// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The pictures of the report as scripts for gnuplot, each with the words that stand for it.
#pragma once

#include <string>
#include <vector>

#include "report/view.h"

namespace ada {

struct Picture {
  std::string script, label;
};

/// Measured points over simulated lines.
Picture stretch_picture(const View &view, int periods);
/// The residual of VSIN over the same stretch.
Picture stretch_residual_picture(const View &view);
/// The pair in the plane, the deviation enlarged `factor` times; factor by locus_factor().
Picture locus_picture(const View &view, double factor, double supply_v);
double locus_factor(const View &view);
/// Raw samples, where there is no model.
Picture raw_picture(const Capture &capture);

/// Half the height of the axis that a row of residual panels shares, mV.
double residual_limit(const View &view, const ResidualBins &before, const ResidualBins &after);
/// One panel: residual against axis `axis` before and after, with the spread. Shows the component
/// that changes most.
Picture residual_picture(const View &view, std::size_t axis, const ResidualBins &before,
                         const ResidualBins &after, double limit_mv);
/// What is left over: means with twice their standard errors. Shows the component that is farthest
/// from zero.
Picture leftover_picture(const View &view, std::size_t axis);
/// Spectra of two models of the ladder; the last one is the extended model.
Picture spectrum_picture(const Spectrum &spectrum, std::size_t before, std::size_t after,
                         double noise_rms_v, bool small);
/// RMS of what a cause changes in the means over the axis that shows it best, mV.
double shown_by_means(const ResidualBins &before, const ResidualBins &after);

Picture angle_error_picture(const View &view, const std::string &baseline_name);

struct LadderStep {
  std::string name;
  Rung rung;
};
/// Residual of each step, in sample and held out, with the noise floor.
Picture ladder_picture(const std::vector<LadderStep> &steps, double noise_rms_v, bool angle);

} // namespace ada

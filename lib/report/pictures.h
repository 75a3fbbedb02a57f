// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The pictures of the report as scripts for gnuplot, each with the words that stand for it.
#pragma once

#include <string>
#include <vector>

#include "report/script.h"
#include "report/view.h"

namespace ada {

struct Picture {
  std::string script, label;
};

// residual_pictures.cpp: residuals along the axes

/// Half the height of the vertical axis that panels of the same two residuals share, mV.
double residual_limit(const ResidualBins &before, const ResidualBins &after);
/// One panel: residual against axis `axis` before and after, with the spread. Shows the component
/// that changes most.
Picture residual_picture(const PlotAxes &axes, std::size_t axis, const ResidualBins &before,
                         const ResidualBins &after, double limit_mv, PictureSize size);
/// What is left over: means with twice their standard errors, of the component that is farthest
/// from zero; `rank` 1: second farthest, and so on.
Picture leftover_picture(const View &view, std::size_t axis, std::size_t rank);
/// By how much it scatters about its mean, along and across the vector.
Picture spread_picture(const View &view, std::size_t axis);
/// The remainder over the angle, and the means that it was fitted to.
Picture remainder_picture(const View &view);
/// Angle minus reference over the angle, before and after.
Picture angle_error_picture(const View &view, const std::string &baseline_name);

// signal_pictures.cpp: volts, and the record over time

/// Simulated lines within measured ones.
Picture stretch_picture(const View &view, int periods);
/// The residual over the same stretch; of VSIN or of VCOS.
Picture stretch_residual_picture(const View &view, bool sin);
/// The pair in the plane, the deviation enlarged `factor` times; factor by locus_factor().
Picture locus_picture(const View &view, double factor, double amplitude_v);
double locus_factor(const View &view, double amplitude_v);
/// Raw samples, where there is no model.
Picture raw_picture(const Capture &capture);
/// Least and largest residual over time, of VSIN or of VCOS, and how far noise alone would reach.
Picture envelope_picture(const Record &record, bool sin, double expected_v);
/// The worst stretch of it.
Picture worst_picture(const Record &record);

// quality_pictures.cpp: how good the models are

/// Spectra of two models by their places in the spectrum.
Picture spectrum_picture(const Spectrum &spectrum, std::size_t before, std::size_t after,
                         double noise_rms_v, PictureSize size);
/// What is left over in the plane along and across the vector.
Picture scatter_picture(const Scatter &scatter, const NoiseShape &noise);
/// How often which size occurs, along the vector alone or along and across, beside a normal distribution.
Picture histogram_picture(const Scatter &scatter, bool along_only);

struct NestedStep {
  std::string name;
  SplitQuality quality;
};
/// Residual of each step, in sample and held out, with the noise.
Picture nested_picture(const std::vector<NestedStep> &steps, double noise_rms_v, bool angle);

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What the report shows of a capture, reduced to what a page can hold: binned residuals of the
// models, a short stretch, the record's extremes, angle errors, a spectrum. Bounded, whatever the
// capture.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/conditions/observations.h"
#include "diagnosis/words/result.h"
#include "report/axes.h"
#include "report/causes.h"
#include "report/record.h"
#include "report/spectrum.h"

namespace ada {

/// Neighbouring samples, measured and simulated by the baseline and the extended model.
struct Stretch {
  bool over_angle = false; ///< key is the angle (deg) rather than time (s)
  std::vector<double> key, vsin, vcos, base_sin, base_cos, extended_sin, extended_cos;
};

/// The curve that the pair draws in a turn: simulated, and the mean deviation from it.
struct Locus {
  double centre_sin_v = 0.0, centre_cos_v = 0.0;
  std::vector<double> base_sin, base_cos, base_dsin, base_dcos;
  std::vector<double> extended_sin, extended_cos, extended_dsin, extended_dcos;
};

/// What is left over in each sample, along and across the vector, mV.
struct Scatter {
  std::vector<double> along, across;
};

/// The remainder, which has no name, and what it was fitted to.
struct RemainderView {
  std::vector<double> angle_deg, sin_mv, cos_mv; ///< the curve, over the axis "angle"
  double angle_rms_deg = 0.0;                    ///< what it does to the angle, mechanical
  ResidualBins without;                          ///< residual of the extended model but for it
};

struct View {
  Scene scene;
  PlotAxes axes;
  ResidualBins baseline, final;  ///< of the extended model
  std::vector<CauseView> causes; ///< one a finding
  std::optional<RemainderView> remainder;
  Scatter scatter;
  Stretch stretch;
  Locus locus;
  Record record;
  Spectrum spectrum; ///< of the baseline, the extended model, then those of spectrum_of
  std::vector<std::size_t> spectrum_of; ///< of each finding: place among the densities; 0: none
  std::vector<Bin> base_angle_error, extended_angle_error; ///< deg over shaft angle, deg

  bool empty() const { return axes.all.empty(); }
};

/// Noise of a channel as the budget has it, V rms.
double noise_v(const Diagnosis &diagnosis);

View make_view(const Diagnosis &diagnosis, const Capture &capture);

/// RMS of what changes in the means between two residuals, mV: of the component that changes most.
double change_of_means(const ResidualBins &before, const ResidualBins &after, std::size_t axis,
                       int *component = nullptr);
/// Which part of what a cause does in that component the means show, 0 to 1; the rest is spread
/// within the bins.
double shown_of_cause(const ResidualBins &without, const ResidualBins &with, std::size_t axis);

} // namespace ada

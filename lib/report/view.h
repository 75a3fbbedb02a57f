// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What the report shows of a capture, reduced to what a page can hold: binned residuals of each
// model of the ladder, a short stretch, angle errors, a spectrum. Bounded, whatever the capture.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "diagnosis/observations.h"
#include "diagnosis/result.h"
#include "report/bins.h"

namespace ada {

/// Parts of a residual: of either channel, along the radius, and across it (what turns the angle).
enum Component { kVsin, kVcos, kRadial, kTangential, kComponents };
const char *component_name(int component);

/// Something that a residual may depend on.
struct PlotAxis {
  std::string name;  ///< "angle"
  std::string label; ///< "shaft angle, deg"
  double from = 0.0, to = 0.0;
  std::size_t bins = 0;
  bool continuous = true; ///< whether neighbouring bins may be joined by a line
  std::vector<double> key;
};

/// Binned residual of one model, in mV, by axis and component.
struct ResidualBins {
  std::vector<std::array<std::vector<Bin>, kComponents>> axis;
};

/// Neighbouring samples, measured and simulated by the baseline and the extended model.
struct Stretch {
  bool over_angle = false; ///< key is the angle (deg) rather than time (s)
  std::vector<double> key, vsin, vcos, base_sin, base_cos, extended_sin, extended_cos;
};

/// The curve that the pair draws in a turn: simulated, and the mean deviation from it.
struct Locus {
  std::vector<double> base_sin, base_cos, base_dsin, base_dcos;
  std::vector<double> extended_sin, extended_cos, extended_dsin, extended_dcos;
};

struct Spectrum {
  std::vector<double> frequency_hz;
  /// uV/sqrt(Hz), mean of both channels: one a model of the ladder, the extended model last.
  std::vector<std::vector<double>> density;
};

struct View {
  Scene scene;
  std::vector<PlotAxis> axes;
  std::vector<std::string> missing; ///< axes that the capture does not have, with the reason
  std::vector<ResidualBins> rungs;  ///< one a model of the ladder
  std::vector<int> rung_of_finding; ///< the model that has it first; -1: none, seen otherwise
  ResidualBins final;               ///< of the extended model
  Stretch stretch;
  Locus locus;
  Spectrum spectrum;
  std::vector<Bin> base_angle_error, extended_angle_error; ///< deg over shaft angle, deg
};

View make_view(const Diagnosis &diagnosis, const Capture &capture);

/// Models of the ladder that get a picture.
inline constexpr std::size_t kMaxRungs = 12;

} // namespace ada

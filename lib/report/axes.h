// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What a residual may depend on, and a residual reduced to its means and spreads along it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "diagnosis/conditions/observations.h"
#include "report/bins.h"

namespace ada {

struct ResidualColumns; // diagnosis/fit.h

/// Parts of a residual: of either channel, along the vector (radius), and across it (what turns the
/// angle).
enum Component { kVsin, kVcos, kAlong, kAcross, kComponents };
const char *component_name(int component);

/// Something that a residual may depend on.
struct PlotAxis {
  std::string name;  ///< "angle", as the budget calls it
  std::string label; ///< "shaft angle, deg"
  double from = 0.0, to = 0.0;
  std::size_t bins = 0;
  bool continuous = true; ///< whether neighbouring bins may be joined by a line
  std::vector<double> key;
};

struct PlotAxes {
  std::vector<PlotAxis> all;
  std::vector<std::string> missing; ///< what the capture does not have, with the reason

  /// Place of an axis by its name; all.size() where there is none.
  std::size_t find(std::string_view name) const;
};

/// The axes that these samples of a capture have. Times count from `start_s`, so that any origin
/// can be drawn.
PlotAxes plot_axes(const Scene &scene, const Observations &data, double start_s, bool with_supply);

/// Binned residual of one model, in mV, by axis and component.
struct ResidualBins {
  std::vector<std::array<std::vector<Bin>, kComponents>> axis;
};

/// What a model leaves, as the page shows it: where only the radius can be judged, at the angle
/// that the pair itself gives.
ResidualColumns shown_residual(const Scene &scene, const Observations &data, const Model &model);

/// Over both channels, V^2.
double mean_square(const ResidualColumns &residual);

/// The four components of a residual, in mV.
std::array<std::vector<double>, kComponents> components(const Observations &data,
                                                        const ResidualColumns &residual);

ResidualBins residual_bins(const Observations &data, const ResidualColumns &residual,
                           const PlotAxes &axes);

} // namespace ada

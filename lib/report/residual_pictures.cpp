// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <tuple>

#include "report/pictures.h"
#include "report/script.h"
#include "report/svg.h"

namespace ada {

namespace {

/// Means, with a band or bars of `half` widths.
template <class Half> std::string bin_rows(const std::vector<Bin> &bins, const Half &half) {
  std::string out;
  for (const Bin &b : bins)
    out += fmt::format("{}{:.6g} {:.5g} {:.5g}\n", b.gap_before ? "\n" : "", b.x, b.mean, half(b));
  return out;
}

std::string spread_rows(const std::vector<Bin> &bins) {
  return bin_rows(bins, [](const Bin &b) { return b.spread; });
}

/// Draws the bins of block `data`: a line with a band, or marks with bars.
std::string drawn(const std::string &data, const char *colour, bool continuous) {
  if (continuous)
    return fmt::format("{0} using 1:($2-$3):($2+$3) with filledcurves fc rgb {1} fs transparent "
                       "solid 0.22 noborder, {0} using 1:2 with lines lc rgb {1} lw 1.8",
                       data, colour);
  return fmt::format("{0} using 1:($2-$3):(0):(2*$3) with vectors nohead lc rgb {1} lw 1.2, "
                     "{0} using 1:2 with points lc rgb {1} pt 7 ps 0.35",
                     data, colour);
}

double rms_of_means(const std::vector<Bin> &bins) {
  double sum = 0.0;
  for (const Bin &b : bins)
    sum += b.mean * b.mean;
  return bins.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(bins.size()));
}

std::size_t most_changed(const ResidualBins &before, const ResidualBins &after, std::size_t axis) {
  int best = 0;
  change_of_means(before, after, axis, &best);
  return static_cast<std::size_t>(best);
}

/// How far the means stand out of their own errors.
double excess(const std::vector<Bin> &bins) {
  double chi2 = 0.0;
  for (const Bin &b : bins)
    if (b.error > 0.0)
      chi2 += b.mean * b.mean / (b.error * b.error);
  return bins.empty() ? 0.0 : chi2 / static_cast<double>(bins.size());
}

std::string x_range(const PlotAxis &axis) {
  if (axis.name == "angle")
    return "set xrange [0:360]\nset xtics 90\n";
  const double room = axis.continuous ? 0.0 : 0.06 * (axis.to - axis.from);
  return range_with_tics("x", axis.from - room, axis.to + room, 4);
}

std::string frame(PictureSize size, const PlotAxis &axis, const std::string &y_label) {
  return panel(size, axis.label, y_label) + x_range(axis);
}

double highest(const std::vector<Bin> &bins, double Bin::*half, double times) {
  double most = 0.0;
  for (const Bin &b : bins)
    most = std::max(most, std::abs(b.mean) + times * b.*half);
  return most;
}

} // namespace

double residual_limit(const ResidualBins &before, const ResidualBins &after) {
  double most = 0.0;
  for (std::size_t a = 0; a < before.axis.size(); ++a) {
    const std::size_t k = most_changed(before, after, a);
    for (const auto *bins : {&before.axis[a][k], &after.axis[a][k]})
      most = std::max(most, highest(*bins, &Bin::spread, 1.0));
  }
  return most > 0.0 ? 1.1 * most : 1.0;
}

Picture residual_picture(const PlotAxes &axes, std::size_t axis, const ResidualBins &before,
                         const ResidualBins &after, double limit, PictureSize size) {
  const PlotAxis &a = axes.all[axis];
  const std::size_t k = most_changed(before, after, axis);
  const char *name = component_name(static_cast<int>(k));
  std::string s = frame(size, a, fmt::format("residual {}, mV", name));
  s += range_with_tics("y", -limit, limit, 4);
  s += block("before", spread_rows(before.axis[axis][k]));
  s += block("after", spread_rows(after.axis[axis][k]));
  s += "plot " + drawn("$before", kBefore, a.continuous) + ", " +
       drawn("$after", kAfter, a.continuous) + "\n";
  return {s, fmt::format("residual {} against {}: means {:.3g} mV rms before, {:.3g} mV rms after",
                         name, a.name, rms_of_means(before.axis[axis][k]),
                         rms_of_means(after.axis[axis][k]))};
}

Picture leftover_picture(const View &view, std::size_t axis, std::size_t rank) {
  const PlotAxis &a = view.axes.all[axis];
  std::array<std::size_t, kComponents> order;
  std::iota(order.begin(), order.end(), 0u);
  // What repeats with the angle is carried by the remainder, and left over all the same.
  const bool carried = view.remainder && a.name == axis_name(Axis::angle);
  const auto &left = (carried ? view.remainder->without : view.final).axis[axis];
  // Where only the radius is judged there is nothing across the vector, which is the last of them.
  const std::size_t shown = view.scene.radius_only ? kAcross : kComponents;
  std::stable_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(shown),
                   [&](std::size_t p, std::size_t q) { return excess(left[p]) > excess(left[q]); });
  const std::size_t part = order[rank % shown];
  const std::vector<Bin> &bins = left[part];
  const double most = highest(bins, &Bin::error, 2.0), limit = most > 0.0 ? 1.25 * most : 1.0;
  const char *name = component_name(static_cast<int>(part));
  std::string s = frame(kPanel, a, fmt::format("mean {}, mV", name));
  s += range_with_tics("y", -limit, limit, 4);
  s += block("rest", bin_rows(bins, [](const Bin &b) { return 2.0 * b.error; }));
  s += "plot " + drawn("$rest", kAfter, false) + "\n";
  return {s, fmt::format("mean {} of what no cause explains against {}: {:.3g} mV rms", name,
                         a.name, rms_of_means(bins))};
}

Picture spread_picture(const View &view, std::size_t axis) {
  const PlotAxis &a = view.axes.all[axis];
  std::string s = frame(kPanel, a, "scatter, mV rms");
  double most = 0.0;
  std::string plots, label;
  for (const auto &[part, name, colour] :
       {std::tuple{kAlong, "along", kMeasured}, std::tuple{kAcross, "across", kSecond}}) {
    if (part == kAcross && view.scene.radius_only)
      continue;
    std::string rows;
    double sum = 0.0;
    const std::vector<Bin> &bins = view.final.axis[axis][static_cast<std::size_t>(part)];
    for (const Bin &b : bins) {
      rows +=
          fmt::format("{}{:.6g} {:.5g}\n", b.gap_before && a.continuous ? "\n" : "", b.x, b.spread);
      most = std::max(most, b.spread);
      sum += b.spread * b.spread;
    }
    s += block(name, rows);
    plots += fmt::format("{}${} using 1:2 with {} lc rgb {}", plots.empty() ? "" : ", ", name,
                         a.continuous ? "lines lw 1.8" : "points pt 7 ps 0.5", colour);
    label +=
        fmt::format("{}{:.3g} mV rms {}", label.empty() ? "" : ", ",
                    bins.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(bins.size())), name);
  }
  s += range_with_tics("y", 0.0, most > 0.0 ? 1.15 * most : 1.0, 4);
  return {s + "plot " + plots + "\n",
          fmt::format("scatter about the mean against {}: {} the vector", a.name, label)};
}

Picture remainder_picture(const View &view) {
  const RemainderView &r = *view.remainder;
  const PlotAxis &a = view.axes.all.front();
  std::string s =
      panel({560, 250}, a.label, "periodic remainder, mV") + "set xrange [0:360]\nset xtics 45\n";
  std::string curve;
  double most = 0.0;
  for (std::size_t i = 0; i < r.angle_deg.size(); ++i) {
    curve += fmt::format("{:.5g} {:.5g} {:.5g}\n", r.angle_deg[i], r.sin_mv[i], r.cos_mv[i]);
    most = std::max({most, std::abs(r.sin_mv[i]), std::abs(r.cos_mv[i])});
  }
  s += block("curve", curve);
  for (const auto &[part, name] : {std::pair{kVsin, "sin"}, std::pair{kVcos, "cos"}}) {
    // Where only the radius can be judged the means are not at the angles of the curve.
    const std::vector<Bin> bins = view.scene.radius_only
                                      ? std::vector<Bin>()
                                      : r.without.axis.front()[static_cast<std::size_t>(part)];
    most = std::max(most, highest(bins, &Bin::error, 2.0));
    s += block(name, bin_rows(bins, [](const Bin &b) { return 2.0 * b.error; }));
  }
  s += range_with_tics("y", -1.1 * most, 1.1 * most, 4);
  s +=
      fmt::format("plot $curve using 1:2 with lines lc rgb {0} lw 1.6, $curve using 1:3 with lines "
                  "lc rgb {1} lw 1.6, {2}, {3}\n",
                  kAfter, kSecond, drawn("$sin", kAfter, false), drawn("$cos", kSecond, false));
  return {s,
          fmt::format("what repeats with the angle and has no name, in VSIN and VCOS: up to {:.3g} "
                      "mV",
                      most)};
}

Picture angle_error_picture(const View &view, const std::string &baseline_name) {
  double limit = 0.0;
  for (const auto *bins : {&view.base_angle_error, &view.extended_angle_error})
    for (const Bin &b : *bins)
      limit = std::max(limit, std::abs(b.mean) + b.spread);
  limit = limit > 0.0 ? 1.1 * limit : 1.0;
  std::string s = panel(kHalf, "shaft angle, deg", "angle minus reference, deg");
  s += "set xrange [0:360]\nset xtics 45\n" + range_with_tics("y", -limit, limit, 5);
  s += block("before", spread_rows(view.base_angle_error));
  s += block("after", spread_rows(view.extended_angle_error));
  s += "plot " + drawn("$before", kBefore, true) + ", " + drawn("$after", kAfter, true) + "\n";
  return {s, fmt::format("angle error against shaft angle: means {:.3g} deg rms by {}, {:.3g} deg "
                         "rms by the extended model",
                         rms_of_means(view.base_angle_error), baseline_name,
                         rms_of_means(view.extended_angle_error))};
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/pictures.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "report/script.h"
#include "report/svg.h"

namespace ada {

namespace {

constexpr int kPanelWidth = 262, kPanelHeight = 190;

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
  return fmt::format("{0} using 1:2:3 with yerrorbars lc rgb {1} lw 1.2 pt 0, "
                     "{0} using 1:2 with points lc rgb {1} pt 7 ps 0.4",
                     data, colour);
}

double rms_of_means(const std::vector<Bin> &bins) {
  double sum = 0.0;
  for (const Bin &b : bins)
    sum += b.mean * b.mean;
  return bins.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(bins.size()));
}

/// RMS of the change of the means; bins are the same ones, for the same samples.
double rms_of_change(const std::vector<Bin> &a, const std::vector<Bin> &b) {
  double sum = 0.0;
  const std::size_t n = std::min(a.size(), b.size());
  for (std::size_t i = 0; i < n; ++i)
    sum += (a[i].mean - b[i].mean) * (a[i].mean - b[i].mean);
  return n == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(n));
}

int most_changed(const ResidualBins &before, const ResidualBins &after, std::size_t axis) {
  int best = 0;
  double most = -1.0;
  for (int k = 0; k < kComponents; ++k) {
    const double change = rms_of_change(before.axis[axis][static_cast<std::size_t>(k)],
                                        after.axis[axis][static_cast<std::size_t>(k)]);
    if (change > most) {
      most = change;
      best = k;
    }
  }
  return best;
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
  return fmt::format("set xrange [{:.8g}:{:.8g}]\n{}", axis.from - room, axis.to + room,
                     tics("x", axis.from, axis.to, 4));
}

} // namespace

double residual_limit(const View &, const ResidualBins &before, const ResidualBins &after) {
  double most = 0.0;
  for (std::size_t a = 0; a < before.axis.size(); ++a) {
    const auto k = static_cast<std::size_t>(most_changed(before, after, a));
    for (const auto *bins : {&before.axis[a][k], &after.axis[a][k]})
      for (const Bin &b : *bins)
        most = std::max(most, std::abs(b.mean) + b.spread);
  }
  return most > 0.0 ? 1.1 * most : 1.0;
}

Picture residual_picture(const View &view, std::size_t axis, const ResidualBins &before,
                         const ResidualBins &after, double limit) {
  const PlotAxis &a = view.axes[axis];
  const int part = most_changed(before, after, axis);
  const auto k = static_cast<std::size_t>(part);
  std::string s = panel(kPanelWidth, kPanelHeight, a.label,
                        fmt::format("{} residual, mV", component_name(part)));
  s += x_range(a) + fmt::format("set yrange [{:.5g}:{:.5g}]\n", -limit, limit) +
       tics("y", -limit, limit, 4);
  s += block("before", spread_rows(before.axis[axis][k]));
  s += block("after", spread_rows(after.axis[axis][k]));
  s += "plot " + drawn("$before", kBefore, a.continuous) + ", " +
       drawn("$after", kAfter, a.continuous) + "\n";
  return {s, fmt::format("{} residual against {}: means {:.3g} mV rms before, {:.3g} mV rms after",
                         component_name(part), a.name, rms_of_means(before.axis[axis][k]),
                         rms_of_means(after.axis[axis][k]))};
}

Picture leftover_picture(const View &view, std::size_t axis) {
  const PlotAxis &a = view.axes[axis];
  std::size_t part = 0;
  for (std::size_t k = 1; k < kComponents; ++k)
    if (excess(view.final.axis[axis][k]) > excess(view.final.axis[axis][part]))
      part = k;
  const std::vector<Bin> &bins = view.final.axis[axis][part];
  double limit = 0.0;
  for (const Bin &b : bins)
    limit = std::max(limit, std::abs(b.mean) + 2.0 * b.error);
  limit = limit > 0.0 ? 1.25 * limit : 1.0;
  const char *name = component_name(static_cast<int>(part));
  std::string s = panel(kPanelWidth, kPanelHeight, a.label, fmt::format("{} residual, mV", name));
  s += x_range(a) + fmt::format("set yrange [{:.5g}:{:.5g}]\n", -limit, limit) +
       tics("y", -limit, limit, 4);
  s += block("rest", bin_rows(bins, [](const Bin &b) { return 2.0 * b.error; }));
  s += "plot " + drawn("$rest", kAfter, false) + "\n";
  return {s, fmt::format("{} residual of the extended model against {}: means {:.3g} mV rms", name,
                         a.name, rms_of_means(bins))};
}

Picture stretch_picture(const View &view, int periods) {
  const Stretch &t = view.stretch;
  std::string rows, lines;
  for (std::size_t i = 0; i < t.key.size(); ++i)
    rows += fmt::format("{:.8g} {:.5f} {:.5f} {:.5f} {:.5f}\n", t.key[i], t.vsin[i], t.vcos[i],
                        t.extended_sin[i], t.extended_cos[i]);
  std::string s = panel(700, 230, "", "VSIN and VCOS, V");
  const auto [low, high] = std::minmax_element(t.key.begin(), t.key.end());
  s += fmt::format("set xrange [{:.9g}:{:.9g}]\nset yrange [*:*]\nset rmargin 7\nset lmargin 7\n",
                   *low, *high);
  const auto at = [&](const char *name, double y) {
    return fmt::format("set label {} at graph 1, first {:.4f} offset 0.7,0 left textcolor rgb {}\n",
                       gnuplot_quoted(name), y, kInk);
  };
  const double ys = t.extended_sin.back(), yc = t.extended_cos.back();
  const double apart = std::max(0.0, 0.25 - std::abs(ys - yc)) * (ys > yc ? 0.5 : -0.5);
  s += at("VSIN", ys + apart) + at("VCOS", yc - apart);
  s += block("pair", rows);
  s += fmt::format("plot $pair using 1:4 with lines lc rgb {1} lw 1.4, $pair using 1:5 with lines "
                   "lc rgb {1} lw 1.4, $pair using 1:2 with points pt 7 ps 0.28 lc rgb {0}, "
                   "$pair using 1:3 with points pt 7 ps 0.28 lc rgb {0}\n",
                   kMeasured, kAfter);
  return {s, fmt::format("VSIN and VCOS, measured points on simulated lines, {} samples, {} "
                         "electrical periods a turn",
                         t.key.size(), periods)};
}

Picture stretch_residual_picture(const View &view) {
  const Stretch &t = view.stretch;
  std::string rows;
  double limit = 0.0;
  for (std::size_t i = 0; i < t.key.size(); ++i) {
    const double before = 1e3 * (t.vsin[i] - t.base_sin[i]);
    const double after = 1e3 * (t.vsin[i] - t.extended_sin[i]);
    limit = std::max({limit, std::abs(before), std::abs(after)});
    rows += fmt::format("{:.8g} {:.4g} {:.4g}\n", t.key[i], before, after);
  }
  limit = limit > 0.0 ? 1.1 * limit : 1.0;
  const auto [low, high] = std::minmax_element(t.key.begin(), t.key.end());
  std::string s =
      panel(700, 170, t.over_angle ? "shaft angle, deg" : "time, s", "VSIN residual, mV");
  s += fmt::format("set xrange [{:.9g}:{:.9g}]\nset yrange [{:.5g}:{:.5g}]\nset rmargin 7\nset "
                   "lmargin 7\n",
                   *low, *high, -limit, limit) +
       tics("y", -limit, limit, 4);
  const char *with = t.over_angle ? "points pt 7 ps 0.28" : "lines lw 1.1";
  s +=
      block("rest", rows) + fmt::format("plot $rest using 1:2 with {0} lc rgb {1}, $rest using 1:3 "
                                        "with {0} lc rgb {2}\n",
                                        with, kBefore, kAfter);
  return {s, "residual of VSIN over the same stretch, before and after"};
}

double locus_factor(const View &view) {
  const Locus &l = view.locus;
  double deviation = 0.0, size = 0.0;
  for (std::size_t i = 0; i < l.base_sin.size(); ++i) {
    if (!std::isfinite(l.base_sin[i]))
      continue;
    deviation = std::max(deviation, std::hypot(l.base_dsin[i], l.base_dcos[i]));
    size = std::max(size, std::abs(l.base_sin[i] - 0.5 * view.scene.supply_v));
  }
  const double most = deviation > 0.0 ? 0.3 * size / deviation : 1.0;
  double factor = 1.0;
  for (double decade = 1.0; decade <= 1e3; decade *= 10.0)
    for (double step : {1.0, 1.5, 2.0, 3.0, 5.0, 7.0})
      if (decade * step <= most)
        factor = decade * step;
  return std::min(factor, 1000.0);
}

Picture locus_picture(const View &view, double factor, double supply_v) {
  const Locus &l = view.locus;
  std::string rows;
  std::size_t first = l.base_sin.size();
  const auto row = [&](std::size_t i) {
    rows += fmt::format("{:.4f} {:.4f} {:.4f} {:.4f} {:.4f} {:.4f}\n", l.base_cos[i], l.base_sin[i],
                        l.base_cos[i] + factor * l.base_dcos[i],
                        l.base_sin[i] + factor * l.base_dsin[i],
                        l.extended_cos[i] + factor * l.extended_dcos[i],
                        l.extended_sin[i] + factor * l.extended_dsin[i]);
  };
  for (std::size_t i = 0; i < l.base_sin.size(); ++i) {
    if (!std::isfinite(l.base_sin[i]))
      continue;
    first = std::min(first, i);
    row(i);
  }
  if (first < l.base_sin.size())
    row(first); // a closed curve
  std::string s = panel(340, 320, "VCOS, V", "VSIN, V");
  s += fmt::format("set size ratio -1\nset xrange [{0:.4g}:{1:.4g}]\nset yrange [{0:.4g}:{1:.4g}]\n"
                   "set xtics 1\nset ytics 1\nunset xzeroaxis\n",
                   0.5 * supply_v - 0.38 * supply_v, 0.5 * supply_v + 0.38 * supply_v);
  s += block("pair", rows);
  s += fmt::format("plot $pair using 1:2 with lines lc rgb {} lw 1, $pair using 3:4 with lines lc "
                   "rgb {} lw 1.6, $pair using 5:6 with lines lc rgb {} lw 1.6\n",
                   kMuted, kBefore, kAfter);
  return {s, fmt::format("VSIN against VCOS: the simulated curve and the mean measured one, its "
                         "deviation enlarged {:g} times",
                         factor)};
}

Picture raw_picture(const Capture &capture) {
  std::string rows;
  const std::size_t step = capture.size() / 600 + 1;
  for (std::size_t i = 0; i < capture.size(); i += step)
    rows += fmt::format("{:.8g} {:.5f} {:.5f}\n", capture.time_s[i], capture.vsin_v[i],
                        capture.vcos_v[i]);
  std::string s = panel(700, 250, "time, s", "volts") + "set yrange [*:*]\n" + block("pair", rows);
  s += fmt::format("plot $pair using 1:2 with points pt 7 ps 0.28 lc rgb {}, $pair using 1:3 with "
                   "points pt 7 ps 0.28 lc rgb {}\n",
                   kAfter, kBefore);
  return {s, "VSIN and VCOS as measured"};
}

Picture spectrum_picture(const Spectrum &p, std::size_t before, std::size_t after,
                         double noise_rms_v, bool small) {
  const std::vector<double> &b = p.density[before], &a = p.density[after];
  std::string rows;
  double low = 1e300, high = 0.0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    rows += fmt::format("{:.5g} {:.4g} {:.4g}\n", p.frequency_hz[i], b[i], a[i]);
    low = std::min({low, b[i], a[i]});
    high = std::max({high, b[i], a[i]});
  }
  const double top = p.frequency_hz.back();
  const double white = 1e6 * noise_rms_v / std::sqrt(top);
  low = std::max(low, 1e-6 * high);
  std::string s = panel(small ? kPanelWidth : 540, small ? kPanelHeight : 230, "frequency, Hz",
                        "residual, \u00b5V/\u221aHz");
  s += fmt::format("set logscale y\nset xrange [0:{:.6g}]\nset yrange [{:.4g}:{:.4g}]\nunset "
                   "xzeroaxis\nset format y '%g'\n",
                   top, 0.6 * std::min(low, white), 1.6 * high) +
       tics("x", 0.0, top, small ? 4 : 8);
  s += block("p", rows);
  s += fmt::format("plot $p using 1:2 with lines lc rgb {} lw 1.1, $p using 1:3 with lines lc rgb "
                   "{} lw 1.1, {:.5g} with lines dt (6,4) lc rgb {} lw 1.4\n",
                   kBefore, kAfter, white, kFloor);
  return {s, fmt::format("spectral density of the residual up to {:.4g} Hz before and after, with "
                         "the density of white noise, {:.3g} \u00b5V/\u221aHz",
                         top, white)};
}

double shown_by_means(const ResidualBins &before, const ResidualBins &after) {
  double most = 0.0;
  for (std::size_t a = 0; a < before.axis.size(); ++a) {
    const auto k = static_cast<std::size_t>(most_changed(before, after, a));
    most = std::max(most, rms_of_change(before.axis[a][k], after.axis[a][k]));
  }
  return most;
}

Picture angle_error_picture(const View &view, const std::string &baseline_name) {
  double limit = 0.0;
  for (const auto *bins : {&view.base_angle_error, &view.extended_angle_error})
    for (const Bin &b : *bins)
      limit = std::max(limit, std::abs(b.mean) + b.spread);
  limit = limit > 0.0 ? 1.1 * limit : 1.0;
  std::string s = panel(540, 230, "shaft angle, deg", "angle error, deg");
  s +=
      fmt::format("set xrange [0:360]\nset xtics 45\nset yrange [{:.5g}:{:.5g}]\n", -limit, limit) +
      tics("y", -limit, limit, 5);
  s += block("before", spread_rows(view.base_angle_error));
  s += block("after", spread_rows(view.extended_angle_error));
  s += "plot " + drawn("$before", kBefore, true) + ", " + drawn("$after", kAfter, true) + "\n";
  return {s, fmt::format("angle error against shaft angle: means {:.3g} deg rms by {}, {:.3g} deg "
                         "rms by the extended model",
                         rms_of_means(view.base_angle_error), baseline_name,
                         rms_of_means(view.extended_angle_error))};
}

Picture ladder_picture(const std::vector<LadderStep> &steps, double noise_rms_v, bool angle) {
  const auto value = [&](const Quality &q) {
    return angle ? q.angle_error_rms_deg.value_or(0.0) : 1e3 * q.residual_rms_v;
  };
  const double floor = angle ? 0.0 : 1e3 * noise_rms_v;
  double low = floor > 0.0 ? floor : 1e300, high = floor;
  std::string rows, names;
  const auto count = static_cast<double>(steps.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double in = value(steps[i].rung.in_sample), out = value(steps[i].rung.heldout);
    const double y = count - static_cast<double>(i);
    low = std::min({low, in, out});
    high = std::max({high, in, out});
    rows += fmt::format("{:g} {:.6g} {:.6g} \"{:.3g}\"\n", y, in, out, out);
    names += fmt::format("{}{} {:g}", i == 0 ? "" : ", ", gnuplot_quoted(steps[i].name), y);
  }
  low = std::max(low, 1e-6);
  high = std::max(high, low);
  if (high < 2.0 * low) { // a logarithmic axis needs room for its numbers
    low *= 0.6;
    high *= 1.4;
  }
  const double right = high * std::pow(high / low, 0.3); // for the last number
  std::string s =
      panel(540, 58 + 27 * static_cast<int>(steps.size()),
            angle ? "angle error, deg rms (logarithmic)" : "residual, mV rms (logarithmic)", "");
  s += fmt::format("set logscale x\nset xrange [{:.4g}:{:.4g}]\nset yrange [0.4:{:g}]\nset ytics "
                   "({})\nset tmargin 0.6\nunset xzeroaxis\nset format x "
                   "'%g'\nset bmargin 3.4\n",
                   low / 1.25, right, count + 0.6, names);
  s += log_tics(low / 1.25, right);
  if (floor > 0.0)
    s += fmt::format("set arrow from first {0:.6g}, graph 0 to first {0:.6g}, graph 1 nohead dt "
                     "(6,4) lc rgb {1} lw 1.4\n",
                     floor, kFloor);
  s += block("steps", rows);
  s +=
      fmt::format("plot $steps using 3:1 with lines lc rgb {2} lw 1, $steps using 2:1 with points "
                  "pt 6 ps 0.95 lw 1.2 lc rgb {3}, $steps using 3:1 with points pt 7 ps 0.6 lc rgb "
                  "{0}, $steps using 3:1:4 with labels left offset 1.1,0 textcolor rgb {1}\n",
                  kAfter, kInk, kGrid, kMuted);
  std::string label = angle ? "angle error" : "residual";
  for (const LadderStep &step : steps)
    label += fmt::format("; {}: {:.3g} held out, {:.3g} in sample", step.name,
                         value(step.rung.heldout), value(step.rung.in_sample));
  return {s, label + (angle ? " deg rms" : " mV rms")};
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "base/angle.h"
#include "report/pictures.h"
#include "report/script.h"
#include "report/svg.h"

namespace ada {

namespace {

double rms_of(const std::vector<double> &values) {
  double sum = 0.0;
  for (double v : values)
    sum += v * v;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

} // namespace

Picture spectrum_picture(const Spectrum &p, std::size_t before, std::size_t after,
                         double noise_rms_v, PictureSize size) {
  const Spectrum::Density &b = p.density[before], &a = p.density[after];
  std::string rows;
  double low = 1e300, high = 0.0;
  for (std::size_t i = 0; i < p.frequency_hz.size(); ++i) {
    rows += fmt::format("{:.5g} {:.4g} {:.4g} {:.4g} {:.4g}\n", p.frequency_hz[i], b.mean[i],
                        b.peak[i], a.mean[i], a.peak[i]);
    low = std::min({low, b.mean[i], a.mean[i]});
    high = std::max({high, b.peak[i], a.peak[i]});
  }
  const double white = 1e6 * noise_rms_v / std::sqrt(p.highest_hz);
  low = 0.5 * std::max(std::min(low, white > 0.0 ? white : low), 1e-6 * high);
  std::string s = panel(size, "frequency, Hz (logarithmic)", "residual, \u00b5V/\u221aHz");
  s += "unset xzeroaxis\n" + log_range("x", p.frequency_hz.front(), p.highest_hz) +
       log_range("y", std::max(low, 1e-12), std::max(2.0 * high, 1e-11));
  s += block("p", rows);
  s += fmt::format(
      "plot $p using 1:2:3 with filledcurves fc rgb {0} fs transparent solid 0.25 "
      "noborder, $p using 1:4:5 with filledcurves fc rgb {1} fs transparent solid 0.35 "
      "noborder, $p using 1:2 with lines lc rgb {0} lw 1.6, $p using 1:4 with lines lc rgb "
      "{1} lw 1.6",
      kBefore, kAfter);
  if (white > 0.0)
    s += fmt::format(", {:.5g} with lines dt (6,4) lc rgb {} lw 1.4", white, kFloor);
  return {s + "\n",
          fmt::format("spectral density of the residual from {:.3g} to {:.4g} Hz before and after, "
                      "with that of white noise, {:.3g} \u00b5V/\u221aHz",
                      p.frequency_hz.front(), p.highest_hz, white)};
}

Picture scatter_picture(const Scatter &scatter, const NoiseShape &noise) {
  constexpr std::size_t kPoints = 700;
  const double along = rms_of(scatter.along), across = rms_of(scatter.across);
  const double limit = 4.0 * std::max({along, across, 1e-6});
  std::string rows, circle;
  const std::size_t step = scatter.along.size() / kPoints + 1;
  for (std::size_t i = 0; i < scatter.along.size(); i += step)
    rows += fmt::format("{:.4g} {:.4g}\n", scatter.across[i], scatter.along[i]);
  for (int k = 0; k <= 90; ++k)
    circle += fmt::format("{:.4g} {:.4g}\n", 2e3 * noise.across_v * std::cos(k * kTwoPi / 90.0),
                          2e3 * noise.along_v * std::sin(k * kTwoPi / 90.0));
  std::string s = panel({340, 320}, "across the vector, mV", "along the vector, mV");
  s += "set size ratio -1\n" + range_with_tics("x", -limit, limit, 5) +
       range_with_tics("y", -limit, limit, 5) + block("left", rows) + block("circle", circle);
  s +=
      fmt::format("plot $left using 1:2 with points pt 7 ps 0.22 lc rgb {}, $circle using 1:2 with "
                  "lines lc rgb {} lw 1.8\n",
                  kMeasured, kFloor);
  return {
      s, fmt::format("what is left over along and across the vector: {:.3g} and {:.3g} mV rms; the "
                     "noise {:.3g} and {:.3g} mV rms",
                     along, across, 1e3 * noise.along_v, 1e3 * noise.across_v)};
}

Picture histogram_picture(const Scatter &scatter, bool along_only) {
  constexpr int kBins = 48;
  constexpr double kReach = 6.0, kWidth = 2.0 * kReach / kBins;
  std::string s = panel(along_only ? kHalf : PictureSize{340, 320},
                        "size in multiples of its own rms", "share of samples (logarithmic)");
  double least = 1.0;
  for (const auto &[values, name] :
       {std::pair{&scatter.along, "along"}, std::pair{&scatter.across, "across"}}) {
    if (along_only && values == &scatter.across)
      continue;
    const double rms = std::max(rms_of(*values), 1e-12);
    std::vector<double> count(kBins, 0.0);
    for (double v : *values) {
      const double at = std::clamp(v / rms, -kReach, kReach - 1e-9);
      count[static_cast<std::size_t>((at + kReach) / kWidth)] += 1.0;
    }
    std::string rows;
    for (int k = 0; k < kBins; ++k) {
      const double share = count[static_cast<std::size_t>(k)] /
                           static_cast<double>(std::max<std::size_t>(1, values->size()));
      if (share > 0.0)
        least = std::min(least, share);
      rows += fmt::format("{:.4g} {}\n", -kReach + (k + 0.5) * kWidth,
                          share > 0.0 ? fmt::format("{:.4g}", share) : "NaN");
    }
    s += block(name, rows);
  }
  std::string normal;
  for (int k = 0; k <= 120; ++k) {
    const double x = -kReach + k * 0.1;
    normal +=
        fmt::format("{:.3g} {:.4g}\n", x, kWidth * std::exp(-0.5 * x * x) / std::sqrt(kTwoPi));
  }
  s += block("normal", normal) + "unset xzeroaxis\nset xrange [-6:6]\nset xtics 2\n" +
       log_range("y", 0.5 * least, 1.0);
  s += fmt::format(
      "plot $normal using 1:2 with lines dt (6,4) lc rgb {1} lw 1.6, $along using 1:2 with "
      "linespoints pt 7 ps 0.4 lw 1.2 lc rgb {0}",
      kMeasured, kFloor);
  if (!along_only)
    s += fmt::format(", $across using 1:2 with linespoints pt 6 ps 0.5 lw 1.2 lc rgb {}", kSecond);
  return {s + "\n", fmt::format("how often what is left over has which size, along{} the vector, "
                                "beside a normal distribution",
                                along_only ? "" : " and across")};
}

Picture nested_picture(const std::vector<NestedStep> &steps, double noise_rms_v, bool angle) {
  const auto value = [&](const Quality &q) {
    return angle ? q.angle_error_rms_deg.value_or(0.0) : 1e3 * q.residual_rms_v;
  };
  const double floor = angle ? 0.0 : 1e3 * noise_rms_v;
  double low = floor > 0.0 ? floor : 1e300, high = floor;
  std::string rows, names;
  std::size_t longest = 0;
  const auto count = static_cast<double>(steps.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double in = value(steps[i].quality.in_sample), out = value(steps[i].quality.heldout);
    const double y = count - static_cast<double>(i);
    low = std::min({low, in, out});
    high = std::max({high, in, out});
    rows +=
        fmt::format("{:g} {:.6g} {:.6g} \"{:.3g}\" {:.6g}\n", y, in, out, out, std::max(in, out));
    longest = std::max(longest, steps[i].name.size());
    names += fmt::format("{}{} {:g}", i == 0 ? "" : ", ", gnuplot_quoted(steps[i].name), y);
  }
  low = std::max(low, 1e-6);
  high = std::max(high, low);
  if (high < 2.0 * low) { // a logarithmic axis needs room for its numbers
    low *= 0.6;
    high *= 1.4;
  }
  const double right = high * std::pow(high / low, 0.3); // for the last number
  std::string s = panel({kHalf.width, 62 + 25 * static_cast<int>(steps.size())},
                        angle ? "angle error, deg rms (log)" : "residual, mV rms (log)", "");
  // What the names leave of the width, at 46 pixels a number.
  const int room = (kHalf.width - 30 - 8 * static_cast<int>(longest)) / 46;
  s += log_range("x", low / 1.25, right, std::clamp(room, 2, 6));
  s += fmt::format("set yrange [0.4:{:g}]\nset ytics ({})\nset tmargin 0.6\nunset xzeroaxis\nset "
                   "bmargin 3.4\n",
                   count + 0.6, names);
  if (floor > 0.0)
    s += fmt::format("set arrow from first {0:.6g}, graph 0 to first {0:.6g}, graph 1 nohead dt "
                     "(6,4) lc rgb {1} lw 1.4\n",
                     floor, kFloor);
  s += block("steps", rows);
  s +=
      fmt::format("plot $steps using 3:1 with lines lc rgb {2} lw 1, $steps using 2:1 with points "
                  "pt 6 ps 0.95 lw 1.2 lc rgb {3}, $steps using 3:1 with points pt 7 ps 0.6 lc rgb "
                  "{0}, $steps using 5:1:4 with labels left offset 1.1,0 textcolor rgb {1}\n",
                  kAfter, kInk, kGrid, kMuted);
  std::string label = angle ? "angle error" : "residual";
  for (const NestedStep &step : steps)
    label += fmt::format("; {}: {:.3g} held out, {:.3g} in sample", step.name,
                         value(step.quality.heldout), value(step.quality.in_sample));
  return {s, label + (angle ? " deg rms" : " mV rms")};
}

} // namespace ada

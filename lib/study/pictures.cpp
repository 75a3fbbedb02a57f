// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "report/script.h"
#include "report/svg.h"
#include "study/page.h"

namespace ada::study {

namespace {

constexpr std::size_t kMostPoints = 800, kMostWords = 16;
constexpr double kShown = 6.0; ///< robust standard deviations; what is farther stands at the edge

std::string axis_words(const std::string &name, const std::string &unit) {
  return unit.empty() || unit == "1" ? name : name + ", " + unit;
}

/// The reach of the bulk, so that one outlier does not press the others into one bar.
std::pair<double, double> reach_of(const std::vector<double> &x) {
  const double middle = median(x), spread = median_deviation(x);
  double low = *std::min_element(x.begin(), x.end()), high = *std::max_element(x.begin(), x.end());
  if (spread > 0.0) {
    low = std::max(low, middle - kShown * spread);
    high = std::min(high, middle + kShown * spread);
  }
  return {low, high > low ? high : low + std::max(1e-12, 1e-6 * std::abs(low))};
}

double normal(double x, const Population &p) {
  const double u = (x - p.centre) / p.spread;
  return p.share * std::exp(-0.5 * u * u) / (p.spread * std::sqrt(2.0 * 3.14159265358979));
}

} // namespace

Picture histogram_picture(const Fleet &fleet, const ParameterSummary &p, const std::string &cause,
                          const Grouping *grouping) {
  const std::vector<double> &x = fleet.columns[p.column].value;
  const auto [low, high] = reach_of(x);
  const auto bins = static_cast<std::size_t>(
      std::clamp(2.0 * std::sqrt(static_cast<double>(x.size())), 8.0, 40.0));
  const double width = (high - low) / static_cast<double>(bins);
  std::vector<double> count(bins, 0.0);
  for (double v : x)
    ++count[std::min(bins - 1, static_cast<std::size_t>(
                                   std::clamp((v - low) / width, 0.0, static_cast<double>(bins))))];
  std::string rows, curve;
  for (std::size_t k = 0; k < bins; ++k)
    rows += fmt::format("{:.8g} {}\n", low + (static_cast<double>(k) + 0.5) * width, count[k]);
  std::string s = panel(kPanel, axis_words(p.parameter, p.unit), "captures");
  s += range_with_tics("x", low, high, 4) +
       range("y", 0.0, 1.12 * std::max(1.0, *std::max_element(count.begin(), count.end()))) +
       block("h", rows);
  s += fmt::format(
      "set boxwidth {:.6g}\nplot $h using 1:2 with boxes fc rgb {} fs solid 0.55 noborder",
      0.92 * width, kAfter);
  std::string words = fmt::format("histogram of {} of {}: median {}, spread {}", p.parameter, cause,
                                  digits(p.median), digits(p.mad));
  if (grouping != nullptr) {
    for (int k = 0; k <= 120; ++k) {
      const double v = low + (high - low) * k / 120.0;
      double y = 0.0;
      for (const Population &of : grouping->populations)
        y += normal(v, of);
      curve += fmt::format("{:.8g} {:.5g}\n", v, y * width * static_cast<double>(x.size()));
    }
    s = s.substr(0, s.rfind("set boxwidth")) + block("m", curve) +
        s.substr(s.rfind("set boxwidth"));
    s += fmt::format(", $m using 1:2 with lines lc rgb {} lw 1.8", kBefore);
    words += fmt::format("; {} populations", grouping->populations.size());
  }
  return {s + "\n", words};
}

Picture dependence_picture(const Fleet &fleet, const Dependence &d) {
  const Column &c = fleet.columns[d.column];
  const Factor &f = fleet.factors[d.factor];
  std::string rows, tics;
  std::vector<double> shown;
  double low = 1e300, high = -1e300;
  const std::size_t step = c.capture.size() / kMostPoints + 1;
  for (std::size_t k = 0; k < c.capture.size(); k += step) {
    const std::size_t row = c.capture[k];
    double at = d.numeric ? f.number[row] : -1.0;
    for (std::size_t l = 0; !d.numeric && l < d.levels.size() && l < kMostWords; ++l)
      if (d.levels[l].word == f.word[row]) // side by side, so that they do not hide one another
        at = static_cast<double>(l) + 0.4 * (static_cast<double>(k * 7 % 16) / 15.0 - 0.5);
    if (!std::isfinite(at) || (!d.numeric && at < -0.5))
      continue;
    rows += fmt::format("{:.8g} {:.8g}\n", at, c.value[k]);
    shown.push_back(c.value[k]);
    low = std::min(low, at);
    high = std::max(high, at);
  }
  if (shown.empty())
    return {panel(kHalf, f.key, c.parameter) + "plot NaN\n", "nothing to show"};
  const auto [bottom, top] = reach_of(shown);
  std::string s = panel(kHalf, f.key, axis_words(c.parameter + " of " + c.cause, c.unit));
  const double margin = 0.05 * (high - low);
  s += d.numeric
           ? range_with_tics("x", low - margin, high + margin, 5)
           : range("x", -0.6, static_cast<double>(std::min(d.levels.size(), kMostWords)) - 0.4);
  s += range_with_tics("y", bottom - 0.06 * (top - bottom), top + 0.06 * (top - bottom), 5) +
       block("p", rows);
  if (!d.numeric) {
    std::string medians;
    for (std::size_t l = 0; l < d.levels.size() && l < kMostWords; ++l) {
      tics += fmt::format("{}{} {}", l == 0 ? "" : ",",
                          gnuplot_quoted(d.levels[l].word.substr(0, 12)), l);
      medians += fmt::format("{} {:.8g} 0.3\n", l, d.levels[l].median);
    }
    s += "set xtics (" + tics + ")\n" + (d.within_sensors ? block("m", "") : block("m", medians));
  }
  s += fmt::format("plot $p using 1:2 with points pt 7 ps 0.3 lc rgb {}", kMeasured);
  if (!d.numeric)
    s += fmt::format(", $m using 1:2:3 with xerrorbars ps 0 lw 2.5 lc rgb {}", kAfter);
  else if (!d.within_sensors)
    s += fmt::format(", {:.8g} + {:.8g} * x with lines lc rgb {} lw 2", d.trend->intercept,
                     d.trend->slope, kAfter);
  return {s + "\n", quantity_words(d.cause, d.parameter) + " over " + d.on};
}

} // namespace ada::study

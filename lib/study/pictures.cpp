// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "report/script.h"
#include "report/svg.h"
#include "study/page.h"

namespace ada::study {

namespace {

constexpr std::size_t kMostPoints = 800, kMostWords = 16;
/// What is shown: so many robust standard deviations, and the values but for this part at either
/// end, so that a population beside the largest one is seen. What is farther stands at the edge.
constexpr double kShown = 6.0, kApart = 0.02;

std::string axis_words(const std::string &name, const std::string &unit) {
  return unit.empty() || unit == "1" ? name : name + ", " + unit;
}

/// The reach of the bulk, so that one outlier does not press the others into one bar.
std::pair<double, double> reach_of(std::vector<double> x) {
  const double middle = median(x), spread = median_deviation(x);
  std::sort(x.begin(), x.end());
  const auto apart = static_cast<std::size_t>(kApart * static_cast<double>(x.size()));
  double low = x.front(), high = x.back();
  if (spread > 0.0) {
    low = std::max(low, std::min(middle - kShown * spread, x[apart]));
    high = std::min(high, std::max(middle + kShown * spread, x[x.size() - 1 - apart]));
  }
  return {low, high > low ? high : low + std::max(1e-12, 1e-6 * std::abs(low))};
}

/// Share of all numbers that a population has in a bar about x: it may be narrower than the bar.
double share_in_bar(const Population &p, double x, double width) {
  const auto below = [&p](double v) {
    return 0.5 * std::erfc((p.centre - v) / (std::numbers::sqrt2 * p.spread));
  };
  return p.share * (below(x + 0.5 * width) - below(x - 0.5 * width));
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
  s += range_with_tics("x", low, high, 4) + block("h", rows);
  double highest = std::max(4.0, *std::max_element(count.begin(), count.end()));
  std::string plot = fmt::format(
      "set boxwidth {:.6g}\nplot $h using 1:2 with boxes fc rgb {} fs solid 0.55 noborder",
      0.92 * width, kAfter);
  std::string words = fmt::format("histogram of {} of {}: median {}, spread {}", p.parameter, cause,
                                  digits(p.median), digits(p.mad));
  if (grouping != nullptr) {
    for (int k = 0; k <= 120; ++k) {
      const double v = low + (high - low) * k / 120.0;
      double y = 0.0;
      for (const Population &of : grouping->populations)
        y += share_in_bar(of, v, width);
      y *= static_cast<double>(x.size());
      highest = std::max(highest, y);
      curve += fmt::format("{:.8g} {:.5g}\n", v, y);
    }
    s += block("m", curve);
    plot += fmt::format(", $m using 1:2 with lines lc rgb {} lw 1.8", kBefore);
    words += fmt::format("; {} populations", grouping->populations.size());
  }
  // Whole captures: no tics at parts of one.
  double step = 1.0;
  for (double decade = 1.0; 4.0 * step < highest; decade *= 10.0)
    for (const double m : {1.0, 2.0, 5.0})
      step = 4.0 * step < highest ? m * decade : step;
  s += range("y", 0.0, 1.12 * highest) + fmt::format("set ytics {}\n", step);
  return {s + plot + "\n", words};
}

Picture dependence_picture(const Fleet &fleet, const Dependence &d) {
  const Column &c = fleet.columns[d.column];
  const Factor &f = fleet.factors[d.factor];
  std::string tics;
  std::vector<double> shown, along;
  double low = 1e300, high = -1e300;
  const std::size_t step = c.capture.size() / kMostPoints + 1;
  for (std::size_t k = 0; k < c.capture.size(); k += step) {
    const std::size_t row = c.capture[k];
    double at = d.numeric ? f.number[row] : -1.0;
    for (std::size_t l = 0; !d.numeric && l < d.levels.size() && l < kMostWords; ++l)
      if (d.levels[l].word == f.text(row)) // side by side, so that they do not hide one another
        at = static_cast<double>(l) + 0.4 * (static_cast<double>(k * 7 % 16) / 15.0 - 0.5);
    if (!std::isfinite(at) || (!d.numeric && at < -0.5))
      continue;
    along.push_back(at);
    shown.push_back(c.value[k]);
    low = std::min(low, at);
    high = std::max(high, at);
  }
  if (shown.empty())
    return {panel(kHalf, f.key, c.parameter) + "plot NaN\n", "nothing to show"};
  const auto [bottom, top] = reach_of(shown);
  std::string rows;
  for (std::size_t k = 0; k < shown.size(); ++k)
    rows += fmt::format("{:.8g} {:.8g}\n", along[k], std::clamp(shown[k], bottom, top));
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

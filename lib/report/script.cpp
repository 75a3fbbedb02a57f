// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/script.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "report/svg.h"

namespace ada {

namespace {

/// A range that can be drawn, whatever it was.
void widen(double &from, double &to) {
  if (!std::isfinite(from) || !std::isfinite(to)) {
    from = 0.0;
    to = 1.0;
  }
  const double least = 1e-9 * std::max({std::abs(from), std::abs(to), 1e-6});
  if (to - from >= least)
    return;
  const double middle = 0.5 * (from + to), half = std::max(0.01 * std::abs(middle), 1e-6);
  from = middle - half;
  to = middle + half;
}

/// 1, 2, 2.5 or 5 times a power of ten, not below `rough`.
double round_step(double rough) {
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  for (double m : {1.0, 2.0, 2.5, 5.0})
    if (m * decade >= rough * 0.999)
      return m * decade;
  return 10.0 * decade;
}

double tics_between(double from, double to, double step) {
  return std::floor(to / step) - std::ceil(from / step) + 1.0;
}

/// Whether the numbers at that step stand apart. A place of one in `count` has room for six
/// characters, and gnuplot gives all numbers of an axis the same decimals.
bool has_room(double from, double to, double step, int count) {
  const double largest = std::max(std::abs(from), std::abs(to));
  std::size_t decimals = 0;
  for (double unit = step; decimals < 9 && std::abs(unit - std::round(unit)) > 1e-6 * unit;
       unit *= 10.0)
    ++decimals;
  std::size_t characters = fmt::format("{:.{}f}", largest, decimals).size();
  if (largest < 1e-5 || largest >= 1e6) // written with an exponent
    characters = 6;
  return tics_between(from, to, step) * static_cast<double>(characters + 1) <= 6.0 * count;
}

/// From the densest to the thinnest.
const std::vector<double> kLogSteps[] = {{1.0, 2.0, 5.0}, {1.0, 3.0}, {1.0}};

std::vector<double> log_tics(double from, double to, const std::vector<double> &steps) {
  std::vector<double> out;
  for (int e = static_cast<int>(std::floor(std::log10(from))); e <= std::ceil(std::log10(to)); ++e)
    for (const double m : steps) {
      const double x = m * std::pow(10.0, e);
      if (x >= from && x <= to)
        out.push_back(x);
    }
  return out;
}

} // namespace

std::string panel(PictureSize size, const std::string &x_label, const std::string &y_label) {
  std::string s =
      fmt::format("set terminal svg size {},{} dynamic noenhanced font 'sans-serif,12' butt\n"
                  "set encoding utf8\nset errorbars 0\nset border 3 lc rgb {} lw 1\nset key off\n"
                  "set tics nomirror scale 0.5 textcolor rgb {}\n"
                  "set grid xtics ytics lt 1 lc rgb {} lw 0.8, lt 1 lc rgb {} lw 0.8\n"
                  "set xzeroaxis lt 1 lc rgb {} lw 1\n",
                  size.width, size.height, kMuted, kInk, kGrid, kGrid, kMuted);
  if (!x_label.empty())
    s +=
        fmt::format("set xlabel {} offset 0,0.3 textcolor rgb {}\n", gnuplot_quoted(x_label), kInk);
  if (!y_label.empty())
    s +=
        fmt::format("set label 1000 {} at screen 0.012, screen 1 offset 0,-0.75 left textcolor rgb "
                    "{}\nset tmargin 1.9\n",
                    gnuplot_quoted(y_label), kInk);
  return s + "set rmargin 1.6\n";
}

std::string block(const std::string &name, const std::string &rows) {
  return "$" + name + " << EOD\n" + (rows.empty() ? "NaN NaN NaN NaN NaN NaN\n" : rows) + "EOD\n";
}

std::string range(const char *axis, double from, double to) {
  widen(from, to);
  return fmt::format("set {}range [{:.10g}:{:.10g}]\n", axis, from, to);
}

std::string range_with_tics(const char *axis, double from, double to, int count) {
  widen(from, to);
  double step = round_step((to - from) / count);
  if (*axis == 'x')
    for (int fewer = count; fewer > 2 && !has_room(from, to, step, count); --fewer)
      step = round_step((to - from) / (fewer - 1));
  // One number alone, a zero say, gives no scale.
  for (int more = count; *axis == 'y' && tics_between(from, to, step) < 2.0 && more < 9; ++more)
    step = round_step((to - from) / (more + 1));
  return range(axis, from, to) + fmt::format("set {}tics {:g}\n", axis, step);
}

std::string log_range(const char *axis, double from, double to, int most) {
  std::vector<double> tics;
  for (const auto &steps : kLogSteps) {
    tics = log_tics(from, to, steps);
    if (tics.size() <= static_cast<std::size_t>(std::max(most, 2)))
      break;
  }
  std::string list;
  for (const double x : tics)
    list += fmt::format("{}{:.6g}", list.empty() ? "" : ",", x);
  return fmt::format("set logscale {0}\nset {0}range [{1:.6g}:{2:.6g}]\nset format {0} '%g'\n",
                     axis, from, to) +
         (tics.size() > 1 ? fmt::format("set {}tics ({})\n", axis, list) : std::string());
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/script.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

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
  const double rough = (to - from) / count, decade = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * decade;
  for (double m : {5.0, 2.5, 2.0, 1.0})
    if (m * decade >= rough * 0.999)
      step = m * decade;
  return range(axis, from, to) + fmt::format("set {}tics {:g}\n", axis, step);
}

std::string log_range(const char *axis, double from, double to) {
  std::string tics;
  int count = 0;
  const double decades = std::log10(to / from);
  for (int e = static_cast<int>(std::floor(std::log10(from))); e <= std::ceil(std::log10(to)); ++e)
    for (double m : {1.0, 2.0, 5.0}) {
      const double x = m * std::pow(10.0, e);
      if (x < from || x > to || (m > 1.0 && decades > 2.5))
        continue;
      tics += fmt::format("{}{:.6g}", count++ == 0 ? "" : ",", x);
    }
  return fmt::format("set logscale {0}\nset {0}range [{1:.6g}:{2:.6g}]\nset format {0} '%g'\n",
                     axis, from, to) +
         (count > 1 ? fmt::format("set {}tics ({})\n", axis, tics) : std::string());
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/script.h"

#include <cmath>
#include <fmt/format.h>

#include "report/svg.h"

namespace ada {

std::string panel(int width, int height, const std::string &x_label, const std::string &y_label) {
  std::string s =
      fmt::format("set terminal svg size {},{} dynamic noenhanced font 'sans-serif,12' butt\n"
                  "set encoding utf8\nset errorbars 0\nset border 3 lc rgb {} lw 1\nset key off\n"
                  "set tics nomirror scale 0.5 textcolor rgb {}\n"
                  "set grid xtics ytics lt 1 lc rgb {} lw 0.8, lt 1 lc rgb {} lw 0.8\n"
                  "set xzeroaxis lt 1 lc rgb {} lw 1\n",
                  width, height, kMuted, kInk, kGrid, kGrid, kMuted);
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

std::string tics(const char *axis, double from, double to, int count) {
  if (!(to > from))
    return {};
  const double rough = (to - from) / count, decade = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * decade;
  for (double m : {5.0, 2.5, 2.0, 1.0})
    if (m * decade >= rough * 0.999)
      step = m * decade;
  return fmt::format("set {}tics {:g}\n", axis, step);
}

std::string log_tics(double from, double to) {
  std::string out;
  int count = 0;
  const double decades = std::log10(to / from);
  for (int e = static_cast<int>(std::floor(std::log10(from))); e <= std::ceil(std::log10(to)); ++e)
    for (double m : {1.0, 2.0, 5.0}) {
      const double x = m * std::pow(10.0, e);
      if (x < from || x > to || (m > 1.0 && decades > 3.0))
        continue;
      out += fmt::format("{}{:.6g}", count++ == 0 ? "" : ",", x);
    }
  return count > 1 ? "set xtics (" + out + ")\n" : std::string();
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/gnuplot.h"
#include "simulation/figures.h"

namespace ada {

namespace {

/// The figure of the application note that this one reproduces.
std::string_view number_in_note(std::string_view name) {
  constexpr std::pair<std::string_view, std::string_view> kNumbers[] = {
      {"mismatch", "Fig. 6"},      {"offset-25", "Fig. 8"},     {"offset-0-110", "Fig. 9"},
      {"offset-20-80", "Fig. 10"}, {"offset-20-50", "Fig. 11"}, {"error-gc-on", "Fig. 2"},
      {"error-gc-off", "Fig. 3"}};
  for (const auto &[known, number] : kNumbers)
    if (known == name)
      return number;
  return {};
}

std::string csv(const FigureData &f, std::uint64_t seed) {
  std::string out = fmt::format("# {}\n# application note: {}\n# seed = {}\n", f.title,
                                number_in_note(f.name), seed);
  for (const std::string &a : f.assumptions)
    out += "# " + a + "\n";
  out += fmt::format("{}\n", fmt::join(f.columns, ","));
  for (const auto &row : f.rows)
    out += fmt::format("{:.6g}\n", fmt::join(row, ","));
  return out;
}

std::string script(const FigureData &f, std::uint64_t seed) {
  constexpr const char *kColours[] = {"#0b62b8", "#c2560c", "#1b7f3b", "#8a3fa0",
                                      "#00808a", "#a15c00", "#5b6470", "#b3261e"};
  const bool mismatch = f.name == "mismatch";
  const bool pair = f.columns.size() > 1 && f.columns[1].find("_sin_") != std::string::npos;
  std::string s = fmt::format(
      "set encoding utf8\nset terminal svg size 760,{} noenhanced font 'sans-serif,13' background "
      "'#ffffff'\nset title {}\nset xlabel {}\nset ylabel {}\nset grid lt 1 lc rgb '#e3e6ea'\nset "
      "border 3\nset tics nomirror\nset lmargin 11\nset bmargin {}\nset key {}\n",
      480 + 18 * f.assumptions.size(),
      gnuplot_quoted(fmt::format("{} (application note, {})", f.title, number_in_note(f.name))),
      gnuplot_quoted(f.x_label), gnuplot_quoted(f.y_label), 5 + f.assumptions.size(),
      mismatch ? "top left" : "off");
  double line = 14.0 * static_cast<double>(f.assumptions.size()) + 10.0;
  for (const std::string &a : f.assumptions) {
    s += fmt::format("set label {} at screen 0.03, screen {:.4f} left font 'sans-serif,11'\n",
                     gnuplot_quoted(a),
                     line / (480.0 + 18.0 * static_cast<double>(f.assumptions.size())));
    line -= 14.0;
  }
  s += fmt::format("set label 'simulated, seed {}' at graph 1, graph 1 offset 0,0.6 right font "
                   "'sans-serif,11'\n",
                   seed);
  if (!mismatch)
    s += fmt::format("set xrange [{:g}:{:g}]\n", f.rows.front()[0], f.rows.back()[0]);
  if (pair)
    s += "set label 'one colour a sensor; VSIN solid, VCOS dashed' at graph 0, graph 1 offset "
         "0,0.6 left font 'sans-serif,11'\n";
  s += "$d << EOD\n";
  for (const auto &row : f.rows)
    s += fmt::format("{:.6g}\n", fmt::join(row, " "));
  s += "EOD\nplot ";
  if (mismatch)
    return s +
           fmt::format("$d using 1:3 with lines lw 1.6 lc rgb '{}' title 'closed form k/4 rad', $d "
                       "using 1:2 with points pt 6 ps 0.8 lc rgb '{}' title 'simulated'\n",
                       kColours[1], kColours[0]);
  for (std::size_t c = 1; c < f.columns.size(); ++c) {
    const std::size_t sensor = pair ? (c - 1) / 2 : c - 1;
    s += fmt::format("{}$d using 1:{} with lines lw 1.6 dt {} lc rgb '{}'", c == 1 ? "" : ", ",
                     c + 1, pair && c % 2 == 0 ? 2 : 1, kColours[sensor % 8]);
  }
  return s + "\n";
}

} // namespace

void write_figure(std::string_view name, std::uint64_t seed, const std::string &directory) {
  const FigureData figure = make_figure(name, seed);
  const std::string stem = directory + "/" + figure.name;
  std::vector<std::string> drawings;
  try {
    drawings = draw({script(figure, seed)});
  } catch (const Error &e) {
    if (e.status() != ADA4571_ERROR_NOT_FOUND) // without gnuplot the data are still of use
      throw;
  }
  AtomicFile data(stem + ".csv");
  data.write(csv(figure, seed));
  if (!drawings.empty()) {
    AtomicFile picture(stem + ".svg");
    picture.write("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n" + drawings.front() + "\n");
    picture.commit();
  }
  data.commit();
}

} // namespace ada

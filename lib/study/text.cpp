// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <fmt/format.h>

#include "base/text.h"
#include "report/words.h"
#include "study/summary.h"

namespace ada::study {

namespace {

constexpr std::size_t kMostLines = 30;

std::string beside_unit(double value, const std::string &unit) {
  return digits(value) + (unit.empty() || unit == "1" ? "" : " " + unit);
}

std::string cause_lines(const CauseSummary &c, std::size_t captures) {
  std::string out = "  " + c.cause;
  if (captures > 0)
    out += fmt::format(": in {} of {}", c.found_in, counted(captures, "capture"));
  if (c.angle_rms_deg)
    out += fmt::format(", costs {} deg rms", digits(*c.angle_rms_deg));
  out += "\n";
  for (const ParameterSummary &p : c.parameters) {
    out += fmt::format("    {} = {}, spread {}", p.parameter, beside_unit(p.median, p.unit),
                       digits(p.mad));
    if (p.components)
      out += fmt::format(" (between sensors {}, within one {})", digits(p.components->between),
                         digits(p.components->within));
    out += "\n";
  }
  return out;
}

std::string dependence_line(const Dependence &d) {
  std::string out =
      "  " + quantity_words(d.cause, d.parameter) + " goes with " + printable(d.on) + ": ";
  if (d.numeric)
    out += fmt::format("{} +- {} {}", digits(d.trend->slope), digits(d.trend->std_error), d.unit);
  else
    for (std::size_t k = 0; k < d.levels.size() && k < kMostLines; ++k)
      out += fmt::format("{}{} {}", k == 0 ? "" : ", ", printable(d.levels[k].word),
                         digits(d.levels[k].median));
  return out + fmt::format(" (p = {:.2g}, corrected)\n", d.p_adjusted);
}

std::string group_line(const Grouping &g) {
  std::string out = "  " + quantity_words(g.cause, g.parameter) + ": ";
  for (std::size_t k = 0; k < g.sizes.size(); ++k)
    out += fmt::format("{}{} sensors about {}", k == 0 ? "" : ", ", g.sizes[k],
                       beside_unit(g.populations[k].centre, g.unit));
  if (g.goes_with && g.goes_with->p_adjusted < kFalseDiscoveries)
    out += fmt::format("; goes with {} (p = {:.2g}, corrected)", printable(g.goes_with->key),
                       g.goes_with->p_adjusted);
  else
    out += "; goes with nothing in the headers";
  return out + "\n";
}

/// The first lines, and how many there are besides.
template <class List, class Line>
std::string lines(const std::string &title, const List &list, Line line) {
  std::string out = "\n" + title + "\n";
  for (std::size_t k = 0; k < list.size() && k < kMostLines; ++k)
    out += line(list[k]);
  if (list.size() > kMostLines)
    out += fmt::format("  and {} more\n", list.size() - kMostLines);
  return list.empty() ? out + "  none\n" : out;
}

} // namespace

std::string digits(double value) {
  return fmt::format("{:.4g}", value);
}

std::string quantity_words(const std::string &cause, const std::string &parameter) {
  if (cause == kExtendedModel)
    return parameter + " of the extended model";
  return parameter == "found" ? "whether there is " + cause : parameter + " of " + cause;
}

std::string to_text(const Summary &s) {
  const std::size_t done = s.captures - s.failed;
  std::string out = counted(s.captures, "capture") + " of " + counted(s.sensors, "sensor");
  out += s.failed > 0 ? fmt::format(", {} of them failed", s.failed) : "";
  out += s.waiting > 0 ? fmt::format(", {} not done", s.waiting) : "";
  out += s.unsound > 0 ? fmt::format("; {} not sound", s.unsound) : "";
  out += s.diagnosed ? "\n" : "; checked and calibrated, not diagnosed\n";
  out += lines("causes, by what they cost the fleet:", s.causes,
               [done](const CauseSummary &c) { return cause_lines(c, done); });
  out += lines("beside them:", s.baseline, [](const CauseSummary &c) { return cause_lines(c, 0); });
  out +=
      lines(fmt::format("dependences ({} were tested):", s.tests), s.dependences, dependence_line);
  out += lines("groups that no header names:", s.groups, group_line);
  out += lines("outliers:", s.outliers,
               [](const Outlier &o) { return "  " + printable(o.sentence) + "\n"; });
  out += "\ncalibration:\n  " + s.sufficient.sentence + "\n";
  for (const Candidate &c : s.sufficient.candidates)
    if (c.heldout) {
      out += fmt::format("    {:30} {} deg rms", c.name, digits(*c.heldout));
      out +=
          c.new_sensor ? fmt::format(", on sensors never seen {}\n", digits(*c.new_sensor)) : "\n";
    }
  return out;
}

} // namespace ada::study

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "report/page.h"
#include "report/svg.h"
#include "report/words.h"

namespace ada {

namespace {

/// A named part that is worth its place: a hundredth of the line's power.
bool worth_showing(double part_v, const BudgetLine &line) {
  return part_v > 0.1 * line.named_rms_v;
}

std::string link(const Diagnosis &d, std::size_t finding) {
  return fmt::format("<a href=\"#finding-{}\">{}</a>", finding + 1,
                     html_escape(d.findings[finding].effect->info().id));
}

/// One bar with its amount; `inside` are its parts.
std::string bar(const char *kind, double rms_v, double most_v, const std::string &inside,
                const std::string &amount) {
  const double width = most_v > 0.0 ? std::clamp(100.0 * rms_v / most_v, 0.0, 100.0) : 0.0;
  return fmt::format(
      "<div class=\"bar\"><div class=\"fill {}\" style=\"--w:{:.2f}\">{}</div><span>{}"
      "</span></div>",
      kind, width, inside, amount);
}

std::string named_bar(const Diagnosis &d, const BudgetLine &line, const std::vector<double> &parts,
                      double most_v) {
  std::string inside, names;
  for (std::size_t f = 0; f < parts.size(); ++f) {
    if (!worth_showing(parts[f], line))
      continue;
    const double share = std::pow(parts[f] / line.named_rms_v, 2.0);
    const bool has_room = share * line.named_rms_v > 0.03 * most_v;
    inside += fmt::format("<i style=\"flex-grow:{:.4f}\">{}</i>", share,
                          has_room ? std::to_string(f + 1) : "");
    names += fmt::format("{}{} {} {}", names.empty() ? "" : ", ", f + 1, link(d, f),
                         millivolts(parts[f]));
  }
  if (names.empty())
    names = "by the causes together";
  return bar("named", line.rms_v > 0.0 ? line.named_rms_v : 0.0, most_v, inside,
             "<b>" + millivolts(line.named_rms_v) + "</b> named") +
         "<p class=\"by\">" + names + "</p>";
}

std::string noise_bar(const Diagnosis &d, const BudgetLine &line, double most_v) {
  std::string kinds;
  for (std::size_t f = 0; f < d.findings.size(); ++f)
    if (d.findings[f].effect->info().axis == axis_name(Axis::noise))
      kinds += fmt::format("{}{} {}", kinds.empty() ? "its kind: " : ", ", f + 1, link(d, f));
  return bar("noise", line.rms_v, most_v, "", "<b>" + millivolts(line.rms_v) + "</b>") +
         (kinds.empty() ? "" : "<p class=\"by\">" + kinds + "</p>");
}

std::string line_of(const Diagnosis &d, const BudgetLine &line, const View &view, double most_v) {
  std::string out =
      fmt::format("<div class=\"line\" data-axis=\"{0}\"><div class=\"what\"><b>{0}</b>"
                  "<span>{1}</span></div><div class=\"bars\">",
                  axis_name(line.axis), meaning(line.axis, d.by_reference()));
  if (line.axis == Axis::noise)
    return out + noise_bar(d, line, most_v) + "</div></div>\n";
  if (line.named_rms_v > 0.0)
    out += named_bar(d, line, named_parts(line, d.findings, view.causes), most_v);
  if (line.unnamed_rms_v > 0.0) {
    out += bar("unnamed", line.unnamed_rms_v, most_v, "",
               "<b>" + millivolts(line.unnamed_rms_v) + "</b> unnamed");
    if (line.axis == Axis::angle && d.extended.remainder)
      out += "<p class=\"by\">modelled and corrected without a name: <a href=\"#remainder\">"
             "periodic-remainder</a></p>";
  }
  return out + "</div></div>\n";
}

/// What nothing was found on, and what the capture could not show.
std::string silent_axes(const Diagnosis &d, const View &view) {
  std::string quiet, absent;
  for (std::size_t k = 0; k < kAxes; ++k) {
    const auto axis = static_cast<Axis>(k);
    const auto is_it = [&](const BudgetLine &line) { return line.axis == axis; };
    const std::string name(axis_name(axis));
    const bool missing = std::any_of(view.axes.missing.begin(), view.axes.missing.end(),
                                     [&](const std::string &m) { return m.starts_with(name); });
    if (!missing && std::none_of(d.budget.begin(), d.budget.end(), is_it))
      quiet += (quiet.empty() ? "" : ", ") + name;
  }
  for (const std::string &m : view.axes.missing)
    absent += (absent.empty() ? "" : ", ") + m;
  return (quiet.empty() ? "" : "Nothing above the noise: " + html_escape(quiet) + ". ") +
         (absent.empty() ? "" : "Not in this capture: " + html_escape(absent) + ". ");
}

} // namespace

std::string budget_section(const Diagnosis &d, const View &view) {
  if (d.budget.empty())
    return {};
  std::vector<BudgetLine> lines = d.budget;
  std::stable_sort(lines.begin(), lines.end(), [](const BudgetLine &a, const BudgetLine &b) {
    const bool noise_a = a.axis == Axis::noise, noise_b = b.axis == Axis::noise;
    return noise_a != noise_b ? noise_b : a.rms_v > b.rms_v;
  });
  double most = 0.0, noise = 0.0;
  for (const BudgetLine &line : lines) {
    most = std::max({most, line.rms_v, line.named_rms_v, line.unnamed_rms_v});
    if (line.axis == Axis::noise)
      noise = line.rms_v;
  }
  std::string out =
      fmt::format("<h2>Where {} is wrong, and by how much</h2>\n<div class=\"budget\" "
                  "id=\"budget\" style=\"--noise:{:.2f}\">\n",
                  html_escape(baseline_words(d)), most > 0.0 ? 100.0 * noise / most : 0.0);
  for (const BudgetLine &line : lines)
    out += line_of(d, line, view, most);
  out += "</div>" + legend({{"box named", "named: a cause below explains it"},
                            {"box unnamed", "unnamed: it is there, and no known cause explains it"},
                            {"box noise", "noise"},
                            {"tick", "the noise, for comparison"}});
  return out + "<p class=\"note\">Volts rms of one channel, on data that no fit has seen. " +
         fmt::format("The amplitude is {:.3g} V, so that 1 mV is {:.2g} % of it. ",
                     d.extended.baseline.amplitude_v,
                     100.0 * 1e-3 / std::max(std::abs(d.extended.baseline.amplitude_v), 1e-9)) +
         "Nothing counts twice: each line holds what those before it, in the order angle, speed, "
         "temperature, supply, time, frequency, do not explain. Parts add up by their squares. " +
         silent_axes(d, view) + "</p>\n";
}

} // namespace ada

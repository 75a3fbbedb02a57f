// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "study/page.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "report/gallery.h"
#include "report/page.h"
#include "report/svg.h"
#include "report/words.h"

namespace ada::study {

namespace {

const std::string kNoBreak = "\u00a0";
constexpr std::size_t kMostRows = 200, kMostPictures = 12;

std::string with_unit(double value, const std::string &unit) {
  return html_escape(digits(value) + (unit.empty() || unit == "1" ? "" : kNoBreak + unit));
}

std::string tile(const std::string &number, const std::string &words) {
  return "<div class=\"tile\"><b>" + number + "</b><span>" + words + "</span></div>";
}

std::string headline(const Summary &s) {
  if (s.captures == s.failed)
    return "No capture of this study could be used.";
  std::string out = s.causes.empty() ? "No cause was found in any capture"
                                     : fmt::format("Most is lost to {}", s.causes.front().cause);
  if (!s.causes.empty() && s.causes.front().angle_rms_deg)
    out += fmt::format(": {} deg rms, in {:.0f}\u00a0% of the captures",
                       digits(*s.causes.front().angle_rms_deg), 100.0 * s.causes.front().share);
  if (!s.outliers.empty())
    out += fmt::format("; {} to look at", counted(s.outliers.size(), "sensor's number"));
  return out + ".";
}

std::string head(const Summary &s, const std::string &path) {
  std::string name = std::filesystem::path(path).stem().string();
  std::string out =
      page_begin("Study " + name, s.outliers.empty() ? "explained" : "partly-explained");
  out += fmt::format("<header id=\"study\"><p class=\"over\">Study of {} of {}{}</p><h1>{}</h1>"
                     "</header>\n",
                     counted(s.captures, "capture"), counted(s.sensors, "sensor"),
                     s.diagnosed ? "" : ", checked and calibrated, not diagnosed",
                     html_escape(headline(s)));
  out += Gallery::notice();
  if (s.waiting > 0)
    out += fmt::format("<p class=\"notice\">{} not done yet: every number here may change.</p>\n",
                       counted(s.waiting, "capture"));
  out += "<div class=\"tiles\">" + tile(std::to_string(s.captures - s.failed), "captures used") +
         tile(std::to_string(s.failed), "failed") + tile(std::to_string(s.unsound), "not sound") +
         tile(std::to_string(s.outliers.size()), "outliers");
  return out +
         tile(s.sufficient.chosen
                  ? with_unit(*s.sufficient.candidates[*s.sufficient.chosen].heldout, "deg")
                  : "\u2013",
              "rms is left by the calibration that is enough") +
         "</div>\n";
}

std::string ranking(const Summary &s) {
  std::string out =
      "<h2 id=\"ranking\">Causes, by what they cost the fleet</h2>\n"
      "<p class=\"note\">Angle error, rms: the share of the captures that have the "
      "cause times the median of what it costs them.</p>\n<div class=\"budget plain\">\n";
  double most = 0.0;
  for (const CauseSummary &c : s.causes)
    most = std::max(most, c.fleet_cost_deg);
  for (const CauseSummary &c : s.causes) {
    const double w = most > 0.0 ? 100.0 * c.fleet_cost_deg / most : 0.0;
    out += fmt::format(
        "<div class=\"line\"><div class=\"what\"><b>{}</b><span>in {} of {} captures</span></div>"
        "<div class=\"bar\"><div class=\"fill\" style=\"--w:{:.2f}\"><i class=\"named\"></i></div>"
        "<span>{}</span></div></div>\n",
        html_escape(c.cause), c.found_in, s.captures - s.failed, w,
        c.angle_rms_deg ? with_unit(c.fleet_cost_deg, "deg") : "cost unknown");
  }
  return s.causes.empty() ? out + "<p>No cause was found.</p></div>\n" : out + "</div>\n";
}

std::string parameter_row(const std::string &cause, const ParameterSummary &p) {
  const auto component = [&p](double Components::*which) {
    return p.components ? digits((*p.components).*which) : std::string("\u2013");
  };
  return fmt::format(
      "<tr><td>{}</td><td><code>{}</code></td><td class=\"n\">{}</td><td class=\"n\">"
      "{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>"
      "</tr>\n",
      html_escape(cause), html_escape(p.parameter), p.count, with_unit(p.median, p.unit),
      digits(p.mad), component(&Components::between), component(&Components::within));
}

const Grouping *grouping_of(const Summary &s, std::size_t column) {
  for (const Grouping &g : s.groups)
    if (g.column == column)
      return &g;
  return nullptr;
}

std::string distributions(const Summary &s, const Fleet &f, Gallery &gallery) {
  std::string out =
      "<h2 id=\"distributions\">Distributions</h2>\n<div class=\"scroll\"><table><thead>"
      "<tr><th scope=\"col\">cause</th><th scope=\"col\">parameter</th><th scope=\"col\""
      " class=\"n\">captures</th><th scope=\"col\" class=\"n\">median</th><th "
      "scope=\"col\" class=\"n\">spread</th><th scope=\"col\" class=\"n\">between "
      "sensors</th><th scope=\"col\" class=\"n\">within a sensor</th></tr></thead>"
      "<tbody>\n";
  std::vector<std::string> cells;
  for (const auto *list : {&s.causes, &s.baseline})
    for (const CauseSummary &c : *list)
      for (const ParameterSummary &p : c.parameters) {
        out += parameter_row(c.cause, p);
        if (cells.size() < kMostPictures && p.count >= 5 && f.columns[p.column].measured)
          cells.push_back(
              figure(gallery.add(histogram_picture(f, p, c.cause, grouping_of(s, p.column))),
                     html_escape(fmt::format("{}: median {}", c.cause, digits(p.median)))));
      }
  out += "</tbody></table></div>\n<p class=\"note\">The spread is 1.4826 times the median absolute "
         "deviation; between and within come from the analysis of variance, where sensors were "
         "measured several times. In the pictures what lies far from the bulk stands in the "
         "outermost bar; where there are several populations, the line is what they would give."
         "</p>\n"
         "<div class=\"row n3\">";
  for (const std::string &cell : cells)
    out += cell;
  return out + "</div>\n";
}

std::string dependence_words(const Dependence &d) {
  std::string out = "<b>" + html_escape(quantity_words(d.cause, d.parameter)) +
                    "</b> goes with <b>" + html_escape(d.on) + "</b>: ";
  if (d.numeric)
    out += html_escape(
        fmt::format("{} \u00b1 {} {}", digits(d.trend->slope), digits(d.trend->std_error), d.unit));
  for (std::size_t k = 0; !d.numeric && k < d.levels.size() && k < 8; ++k)
    out += html_escape(
        fmt::format("{}{} {}", k == 0 ? "" : ", ", d.levels[k].word, digits(d.levels[k].median)));
  return out + fmt::format(" (p = {:.2g})", d.p_adjusted) +
         (d.within_sensors ? ", within the sensors" : "");
}

std::string dependences(const Summary &s, const Fleet &f, Gallery &gallery) {
  std::string out = fmt::format("<h2 id=\"dependences\">What goes with what</h2>\n<p "
                                "class=\"note\">{} pairs of a number and a "
                                "key were tested; of those listed, one in twenty may be chance "
                                "(Benjamini and Hochberg).</p>\n",
                                s.tests);
  std::vector<std::string> cells;
  std::string rest;
  for (std::size_t k = 0; k < s.dependences.size() && k < kMostRows; ++k)
    if (k < kMostPictures)
      cells.push_back(figure(gallery.add(dependence_picture(f, s.dependences[k])),
                             dependence_words(s.dependences[k])));
    else
      rest += "<li>" + dependence_words(s.dependences[k]) + "</li>\n";
  if (s.dependences.empty())
    return out + "<p>Nothing goes with anything that the headers say.</p>\n";
  const std::string key = "<p class=\"note\">A point is a capture, the blue line the trend or the "
                          "median of a word. What lies far from the bulk stands at the edge of its "
                          "picture.</p>\n";
  return out + halves(std::move(cells), key) + (rest.empty() ? "" : "<ul>" + rest + "</ul>\n");
}

std::string groups(const Summary &s) {
  std::string out = "<h2 id=\"groups\">Groups that no header names</h2>\n";
  for (const Grouping &g : s.groups) {
    out += "<p><b>" + html_escape(quantity_words(g.cause, g.parameter)) + "</b>: ";
    for (std::size_t k = 0; k < g.sizes.size(); ++k)
      out += fmt::format("{}{} about {}", k == 0 ? "" : ", ", counted(g.sizes[k], "sensor"),
                         with_unit(g.populations[k].centre, g.unit));
    const bool with = g.goes_with && g.goes_with->p_adjusted < kFalseDiscoveries;
    out += with ? fmt::format("; goes with <b>{}</b> (p = {:.2g})", html_escape(g.goes_with->key),
                              g.goes_with->p_adjusted)
                : std::string("; goes with nothing that the headers say");
    out += ".</p>\n";
  }
  return s.groups.empty() ? out + "<p>None: one population describes every number.</p>\n" : out;
}

std::string link_of(const Member &row, const std::string &page) {
  if (row.report.empty())
    return html_escape(row.capture);
  std::error_code failed;
  const auto folder = std::filesystem::absolute(page, failed).parent_path();
  const auto target = std::filesystem::absolute(row.report, failed).lexically_relative(folder);
  return "<a href=\"" + html_escape(target.empty() ? row.report : target.string()) + "\">" +
         html_escape(row.capture) + "</a>";
}

/// Checks that fail in most captures, and in how many: that is no sensor's fault.
std::map<std::string, std::size_t> faults_of_most(const Fleet &f) {
  std::map<std::string, std::size_t> out;
  for (const std::size_t row : f.done)
    for (const std::uint32_t check : f.rows[row].failed_checks)
      ++out[f.names[check]];
  std::erase_if(out, [&f](const auto &fault) { return 2 * fault.second <= f.done.size(); });
  return out;
}

/// What a person is to look at: outliers, then what failed, then what is not sound.
std::string to_look_at(const Summary &s, const Fleet &f, const std::string &page) {
  std::string rows;
  std::size_t count = 0;
  const auto add = [&](const Member &row, const std::string &why) {
    if (++count <= kMostRows)
      rows += "<tr><td>" + html_escape(row.serial.empty() ? "\u2013" : row.serial) + "</td><td>" +
              link_of(row, page) + "</td><td>" + html_escape(why) + "</td></tr>\n";
  };
  for (const Outlier &o : s.outliers)
    add(f.rows[o.row], o.sentence);
  for (const Member &row : f.rows)
    if (!row.done)
      add(row, "Failed: " + row.reason);
  const std::map<std::string, std::size_t> everywhere = faults_of_most(f);
  for (const Member &row : f.rows) {
    std::string failed;
    for (const std::uint32_t check : row.failed_checks)
      if (everywhere.count(f.names[check]) == 0)
        failed += (failed.empty() ? "" : ", ") + f.names[check];
    if (row.done && !failed.empty())
      add(row, "Not sound: " + failed + ".");
  }
  std::string out = "<h2 id=\"look\">Sensors to look at</h2>\n";
  for (const auto &[check, captures] : everywhere)
    out +=
        fmt::format("<p class=\"notice\">The check <b>{}</b> fails in {} of {} captures: look at "
                    "the bench, not at a sensor.</p>\n",
                    html_escape(check), captures, s.captures - s.failed);
  if (count == 0)
    return out + "<p>No single sensor.</p>\n";
  out += "<div class=\"scroll\"><table><thead><tr><th scope=\"col\">sensor</th><th scope=\"col\">"
         "capture</th><th scope=\"col\">why</th></tr></thead><tbody>\n" +
         rows + "</tbody></table></div>\n";
  if (count > kMostRows)
    out += fmt::format("<p class=\"note\">And {} more: the database has them all.</p>\n",
                       count - kMostRows);
  return out;
}

std::string sufficient(const Summary &s) {
  const auto cell = [](const std::optional<double> &x) {
    return "<td class=\"n\">" + (x ? digits(*x) : std::string("\u2013")) + "</td>";
  };
  std::string out = "<h2 id=\"sufficient\">Which calibration is enough</h2>\n<p>" +
                    html_escape(s.sufficient.sentence) + "</p>\n";
  if (!s.sufficient.chosen)
    return out;
  out +=
      "<div class=\"scroll\"><table><thead><tr><th scope=\"col\">calibration</th><th scope=\"col\" "
      "class=\"n\">other half, deg</th><th scope=\"col\" class=\"n\">other capture, deg</th><th "
      "scope=\"col\" class=\"n\">new sensor, deg</th></tr></thead><tbody>\n";
  for (std::size_t k = 0; k < s.sufficient.candidates.size(); ++k) {
    const Candidate &c = s.sufficient.candidates[k];
    out += "<tr><td>" + std::string(k == *s.sufficient.chosen ? "<b>" : "") + html_escape(c.name) +
           (k == *s.sufficient.chosen ? "</b>" : "") + "</td>" + cell(c.same_capture) +
           cell(c.same_sensor) + cell(c.new_sensor) + "</tr>\n";
  }
  return out +
         "</tbody></table></div>\n<p class=\"note\">Angle error rms with the noise of a sample, "
         "median over the captures, on data that the calibration has not seen.</p>\n";
}

} // namespace

void write_page(const Summary &s, const Fleet &f, const std::string &path) {
  AtomicFile file(path); // a path that cannot be written is better known before the work
  Gallery gallery;
  std::string text = head(s, path) + ranking(s) + to_look_at(s, f, path);
  text += dependences(s, f, gallery) + groups(s) + sufficient(s) + distributions(s, f, gallery);
  text += "<footer>libada4571 " ADA4571_VERSION_STRING ". Angles are mechanical.</footer>\n"
          "</main></body></html>\n";
  file.write(gallery.place(text));
  file.commit();
}

} // namespace ada::study

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/page.h"

#include <fmt/format.h>
#include <map>

#include "report/svg.h"
#include "report/words.h"

namespace ada {

namespace {

std::string tile(const std::string &number, const std::string &words) {
  return fmt::format("<div class=\"tile\"><b>{}</b><span>{}</span></div>", number, words);
}

std::string tiles(const Diagnosis &d) {
  const Quality &b = d.baseline_quality.heldout, &e = d.extended_quality.heldout, &a = d.anonymous;
  std::string out = "<div class=\"tiles\">";
  out += tile(change(millivolts(b.residual_rms_v), millivolts(e.residual_rms_v)),
              "residual rms of a channel, before and with everything found");
  if (b.angle_error_rms_deg && e.angle_error_rms_deg)
    out += tile(change(degrees(*b.angle_error_rms_deg), degrees(*e.angle_error_rms_deg)),
                "angle error rms against the reference");
  else
    out += tile("no reference", "the angle error cannot be measured");
  std::size_t open = 0;
  for (const Finding &f : d.findings)
    open += f.alternatives.empty() ? 0 : 1;
  out += tile(d.findings.empty() ? "no cause" : counted(d.findings.size(), "cause"),
              d.findings.empty() ? "found"
              : open == 0        ? "found, each the only one that fits"
                                 : fmt::format("found, {} of them with rivals", open));
  out += tile(millivolts(a.residual_rms_v) +
                  (a.angle_error_rms_deg ? ", " + degrees(*a.angle_error_rms_deg) : ""),
              "what the best model that names nothing leaves");
  return out + "</div>\n";
}

std::string invisible_section(const Diagnosis &d) {
  if (d.invisible.empty())
    return {};
  std::map<std::string, std::string> by_reason;
  for (const Invisible &i : d.invisible) {
    std::string &causes = by_reason[i.reason];
    causes += (causes.empty() ? "" : ", ") + i.cause;
  }
  std::string out =
      "<h2>What this capture cannot show</h2>\n<p class=\"note\">Not found is not the "
      "same as absent: these causes leave no mark in such a capture.</p>\n<table>"
      "<thead><tr><th scope=\"col\">because</th><th scope=\"col\">not visible</th>"
      "</tr></thead><tbody>\n";
  for (const auto &[reason, causes] : by_reason)
    out += "<tr><td>" + html_escape(reason) + "</td><td>" + html_escape(causes) + "</td></tr>\n";
  return out + "</tbody></table>\n";
}

std::string failed_checks(const Diagnosis &d) {
  if (d.failed_checks.empty())
    return {};
  std::string out = "<div class=\"notice\" id=\"failed-checks\">The capture is not sound:<ul>";
  for (const FailedCheck &c : d.failed_checks)
    out += fmt::format("<li><code>{}</code> {}</li>", html_escape(c.id), html_escape(c.explanation));
  return out + "</ul></div>\n";
}

std::string head(const Diagnosis &d, const Capture &c) {
  const std::string name = c.meta.serial.empty() ? c.identity : "sensor " + c.meta.serial;
  std::string out = page_begin(name.empty() ? "Diagnosis" : "Diagnosis of " + name,
                               std::string(verdict_name(d.verdict))) +
                    "<header id=\"verdict\">";
  out +=
      fmt::format("<p class=\"over\">Diagnosis of {}: {} samples, {:.4g} s, {:.4g} turns, {}</p>",
                  name.empty() ? "a capture" : html_escape(name), d.samples, d.duration_s, d.turns,
                  !d.has_reference   ? "no reference angle"
                  : d.by_reference() ? "with a reference angle"
                                     : "with a reference angle, which is set aside");
  return out + "<h1>" + html_escape(headline(d)) + "</h1></header>\n" + failed_checks(d) +
         Gallery::notice();
}

std::string foot(const Diagnosis &d) {
  const std::string date = d.extended.provenance.date;
  return fmt::format("<footer>libada4571 {}{}. Every gain is measured on data that no fit has "
                     "seen. Captures and models are compared in volts; angles are "
                     "mechanical.</footer>\n</main></body></html>\n",
                     ADA4571_VERSION_STRING, date.empty() ? "" : ", " + html_escape(date));
}

} // namespace

std::string page_begin(const std::string &title, const std::string &tone) {
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
         "<meta name=\"color-scheme\" content=\"light dark\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
         "style-src 'unsafe-inline'; img-src data:\">\n"
         "<link rel=\"icon\" href=\"data:,\">\n<title>" +
         html_escape(title) + "</title>\n<style>" + std::string(kStyle) +
         "</style></head>\n<body class=\"" + tone + "\">" + svg_marks() + "<main>\n";
}

std::string figure(const std::string &picture, const std::string &caption_html) {
  return "<figure>" + picture +
         (caption_html.empty() ? "" : "<figcaption>" + caption_html + "</figcaption>") +
         "</figure>\n";
}

std::string row(std::vector<std::string> cells, const std::string &filler) {
  const bool fills = cells.size() < 3 && !filler.empty();
  if (fills)
    cells.push_back("<div>" + filler + "</div>");
  std::string out = fmt::format("<div class=\"row n{}\">", cells.size());
  for (const std::string &cell : cells)
    out += cell;
  return out + "</div>" + (fills ? "" : filler) + "\n";
}

std::string halves(std::vector<std::string> cells, const std::string &filler) {
  const bool fills = cells.size() % 2 == 1;
  if (fills)
    cells.push_back("<div>" + filler + "</div>");
  std::string out = "<div class=\"row n2\">";
  for (const std::string &cell : cells)
    out += cell;
  return out + "</div>" + (fills ? "" : filler) + "\n";
}

std::string legend(std::initializer_list<std::pair<const char *, std::string>> entries) {
  std::string out = "<ul class=\"legend\">";
  for (const auto &[look, words] : entries)
    out += fmt::format("<li><i class=\"{}\"></i>{}</li>", look, words);
  return out + "</ul>";
}

std::string page(const Diagnosis &d, const Capture &capture, const View &view, Gallery &gallery) {
  std::string out = head(d, capture);
  if (view.empty()) {
    const std::string facts = capture_section(d, capture, view);
    if (capture.size() < 2)
      return out + facts + foot(d);
    return out + "<div class=\"row wide\"><section><h2>What was measured</h2>\n" +
           figure(gallery.add(raw_picture(capture)),
                  legend({{"after dot", "VSIN"}, {"before ring", "VCOS"}})) +
           "</section><section>" + facts + "</section></div>\n" + foot(d);
  }
  out += budget_section(d, view) + tiles(d);
  out += causes_section(d, view, gallery);
  out += left_section(d, view, gallery);
  out += remainder_section(d, view, gallery);
  out += noise_section(d, view, gallery);
  out += record_section(d, capture, view, gallery);
  out += measured_section(d, view, gallery);
  out += residual_section(d, view, gallery);
  out += nested_section(d, view, gallery);
  out += invisible_section(d);
  out += "<div class=\"row last\"><section>" + model_section(d) + "</section><section>" +
         capture_section(d, capture, view) + "</section></div>\n";
  return out + foot(d);
}

} // namespace ada

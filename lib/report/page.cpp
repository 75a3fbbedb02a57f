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

std::string change(const std::string &before, const std::string &after) {
  return before == after ? after : before + " \u2192 " + after;
}

std::string tiles(const Diagnosis &d) {
  const Quality &b = d.baseline_quality.heldout, &e = d.extended_quality.heldout;
  std::string out = "<div class=\"tiles\">";
  out += tile(change(millivolts(b.residual_rms_v), millivolts(e.residual_rms_v)),
              fmt::format("residual rms, held out; noise floor {}", millivolts(d.noise_rms_v)));
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
              : open == 0        ? "found, none with rivals"
                                 : fmt::format("found, {} with rivals", open));
  out += tile(d.structure.empty() ? "white noise" : millivolts(d.unexplained_rms_v) + " rms",
              d.structure.empty() ? "is all that is left over" : "left over and unexplained");
  return out + "</div>\n";
}

std::string summary(const Diagnosis &d) {
  if (d.findings.empty())
    return {};
  std::string out = "<table><thead><tr><th scope=\"col\" colspan=\"2\">cause</th><th "
                    "scope=\"col\">size</th><th scope=\"col\" class=\"n\">residual, held "
                    "out</th><th scope=\"col\">rivals</th></tr></thead><tbody>\n";
  for (std::size_t i = 0; i < d.findings.size(); ++i) {
    const Finding &f = d.findings[i];
    const auto parameters = f.effect->info().parameters;
    std::string size, rivals;
    for (std::size_t k = 0; k < parameters.size() && size.empty(); ++k)
      if (!std::isnan(f.values[k]) && parameters[k].role == Role::fitted) {
        const double error = k < f.std_errors.size() ? f.std_errors[k] : 0.0;
        const Shown shown = show(parameters[k], f.values[k], error);
        size = fmt::format("<code>{}</code> {}{}{} {}", parameters[k].name, shown.value,
                           shown.error.empty() ? "" : " \u00b1 ", shown.error, shown.unit);
      }
    for (const std::string &rival : f.alternatives)
      rivals += (rivals.empty() ? "" : ", ") + plain_name(rival);
    const Quality &b = f.before.heldout, &a = f.after.heldout;
    out +=
        fmt::format("<tr><td class=\"n\">{0}</td><td><a href=\"#finding-{0}\">{1}</a></td><td>{2}"
                    "</td><td class=\"n\">{3}</td><td>{4}</td></tr>\n",
                    i + 1, html_escape(plain_name(f.effect->info().id)), size,
                    change(millivolts(b.residual_rms_v), millivolts(a.residual_rms_v)),
                    rivals.empty() ? "none" : html_escape(rivals));
  }
  return out + "</tbody></table>\n";
}

std::string measured_section(const Diagnosis &d, const View &view, Gallery &gallery) {
  const double factor = locus_factor(view);
  std::string out = "<h2>Measured against simulated</h2>\n<div class=\"row wide\">";
  out += figure(gallery.add(stretch_picture(view, d.periods_per_turn)) +
                    gallery.add(stretch_residual_picture(view)),
                legend({{"measured dot", "measured"},
                        {"after", "simulated by the extended model, and its residual"},
                        {"before", "residual of the " + html_escape(d.baseline_name)}}));
  out += figure(gallery.add(locus_picture(view, factor, view.scene.supply_v)),
                legend({{"muted", "simulated"},
                        {"before", fmt::format("deviation \u00d7{:g}", factor)},
                        {"after", "with the causes"}}));
  return out + "</div>\n";
}

std::string residual_section(const Diagnosis &d, const View &view, Gallery &gallery) {
  const ResidualBins &first = view.rungs.front();
  const double limit = residual_limit(view, first, view.final);
  const std::string base = html_escape(d.baseline_name);
  std::string out = "<h2>Residual before and after</h2>\n<div class=\"row panels\">";
  for (std::size_t a = 0; a < view.axes.size(); ++a)
    out += figure(gallery.add(residual_picture(view, a, first, view.final, limit)), "");
  out += "</div>" + legend({{"before", base}, {"after", "extended model"}});
  out += "<p class=\"note\">Measured minus simulated: mean over each bin with its spread (one "
         "standard deviation), one scale for all. Each panel shows the part that changes most: one "
         "of the outputs, along the radius, or across it (which turns the angle).";
  for (const std::string &missing : view.missing)
    out += " Not shown: " + html_escape(missing) + ".";
  return out + "</p>\n";
}

std::string ladder_section(const Diagnosis &d, const View &view, Gallery &gallery) {
  std::vector<LadderStep> steps{{d.baseline_name.substr(0, 40), d.baseline_quality}};
  for (const Finding &f : d.findings)
    if (steps.size() < 2 * kMaxRungs && f.effect->info().evidence != Evidence::screening)
      steps.push_back({"+ " + plain_name(f.effect->info().id), f.after});
  std::string out = "<h2>What each cause gains</h2>\n<div class=\"row half\">";
  out += figure(gallery.add(ladder_picture(steps, d.noise_rms_v, false)),
                legend({{"after dot", "held out: data that no fit has seen"},
                        {"muted ring", "in sample"},
                        {"floor dash", "noise floor"}}));
  if (d.baseline_quality.heldout.angle_error_rms_deg)
    out += figure(gallery.add(ladder_picture(steps, d.noise_rms_v, true)),
                  legend({{"after dot", "held out"}, {"muted ring", "in sample"}}));
  if (!view.base_angle_error.empty())
    out += figure(gallery.add(angle_error_picture(view, d.baseline_name)),
                  legend({{"before", html_escape(d.baseline_name)},
                          {"after", "extended model: mean and spread"}}));
  if (!view.spectrum.density.empty())
    out += figure(gallery.add(spectrum_picture(view.spectrum, 0, view.spectrum.density.size() - 1,
                                               d.noise_rms_v, false)),
                  legend({{"before", html_escape(d.baseline_name)},
                          {"after", "extended model"},
                          {"floor dash", "white noise"}}));
  return out + "</div>\n";
}

std::string left_section(const Diagnosis &d, const View &view, Gallery &gallery) {
  std::string out = "<h2>What is left over</h2>\n";
  if (d.structure.empty()) {
    out += "<p>Nothing but noise: the residual of the extended model is white along every axis "
           "that this capture has.</p>\n";
  } else {
    out += "<ul class=\"plain\">";
    for (const Structure &s : d.structure)
      out += fmt::format("<li><b>Along {}:</b> {}</li>", html_escape(s.along),
                         html_escape(s.description));
    out += "</ul>\n";
  }
  out += "<div class=\"row panels\">";
  for (std::size_t a = 0; a < view.axes.size(); ++a)
    out += figure(gallery.add(leftover_picture(view, a)), "");
  return out +
         "</div><p class=\"note\">Residual of the extended model, enlarged: means with bars of "
         "two standard errors. Noise alone leaves one bar in twenty off zero.</p>\n";
}

std::string invisible_section(const Diagnosis &d) {
  if (d.invisible.empty())
    return {};
  std::map<std::string, std::string> by_reason;
  for (const Invisible &i : d.invisible) {
    std::string &causes = by_reason[i.reason];
    causes += (causes.empty() ? "" : ", ") + plain_name(i.cause);
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

std::string head(const Diagnosis &d, const Capture &c) {
  const std::string name = c.meta.serial.empty() ? c.identity : "sensor " + c.meta.serial;
  std::string out = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
                    "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
                    "<meta name=\"color-scheme\" content=\"light dark\">\n"
                    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
                    "style-src 'unsafe-inline'; img-src data:\">\n"
                    "<link rel=\"icon\" href=\"data:,\">\n<title>Diagnosis";
  out += name.empty() ? "" : " of " + html_escape(name);
  out += "</title>\n<style>" + std::string(kStyle) + "</style></head>\n<body class=\"" +
         std::string(verdict_name(d.verdict)) + "\">" + svg_marks() +
         "<main>\n<header id=\"verdict\">";
  out +=
      fmt::format("<p class=\"over\">Diagnosis of {}: {} samples, {:.4g} s, {:.4g} turns, {}</p>",
                  name.empty() ? "a capture" : html_escape(name), d.samples, d.duration_s, d.turns,
                  d.has_reference ? "with a reference angle" : "no reference angle");
  return out + "<h1>" + html_escape(headline(d)) + "</h1></header>\n";
}

std::string foot(const Diagnosis &d) {
  const std::string date = d.extended.provenance.date;
  return fmt::format("<footer>libada4571 {}{}. Every gain is measured on whole revolutions that no "
                     "fit has seen. Captures and models are compared in volts; angles are "
                     "mechanical.</footer>\n</main></body></html>\n",
                     ADA4571_VERSION_STRING, date.empty() ? "" : ", " + html_escape(date));
}

} // namespace

std::string figure(const std::string &picture, const std::string &caption_html,
                   const std::string &kind) {
  return "<figure" + (kind.empty() ? "" : " class=\"" + kind + "\"") + ">" + picture +
         (caption_html.empty() ? "" : "<figcaption>" + caption_html + "</figcaption>") +
         "</figure>\n";
}

std::string legend(std::initializer_list<std::pair<const char *, std::string>> entries) {
  std::string out = "<ul class=\"legend\">";
  for (const auto &[look, words] : entries)
    out += fmt::format("<li><i class=\"{}\"></i>{}</li>", look, words);
  return out + "</ul>";
}

std::string page(const Diagnosis &d, const Capture &capture, const View &view, Gallery &gallery) {
  std::string out = head(d, capture);
  if (d.verdict == Verdict::insufficient_data || view.rungs.empty()) {
    if (capture.size() >= 2)
      out += "<h2>What was measured</h2>\n" +
             figure(gallery.add(raw_picture(capture)),
                    legend({{"after dot", "VSIN"}, {"before dot", "VCOS"}}));
    return out + capture_section(d, capture, view) + foot(d);
  }
  out += tiles(d) + summary(d);
  out += measured_section(d, view, gallery);
  out += residual_section(d, view, gallery);
  out += ladder_section(d, view, gallery);
  out += findings_section(d, view, gallery);
  out += left_section(d, view, gallery);
  out += invisible_section(d);
  out += model_section(d);
  out += capture_section(d, capture, view);
  return out + foot(d);
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <cmath>
#include <fmt/format.h>

#include "report/page.h"
#include "report/svg.h"
#include "report/words.h"

namespace ada {

namespace {

/// A sentence ends once.
std::string without_stop(std::string text) {
  while (!text.empty() && text.back() == '.')
    text.pop_back();
  return text;
}

std::string parameter_table(const Finding &f) {
  const auto parameters = f.effect->info().parameters;
  std::string out = "<table><thead><tr><th scope=\"col\">parameter</th><th scope=\"col\" "
                    "class=\"n\">value</th><th scope=\"col\" class=\"n\">std error</th><th "
                    "scope=\"col\">unit</th></tr></thead><tbody>";
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    if (std::isnan(f.values[k]))
      continue;
    const double error = k < f.std_errors.size() ? f.std_errors[k] : 0.0;
    const Shown shown = show(parameters[k], f.values[k], error);
    out += fmt::format("<tr><td><code>{}</code></td><td class=\"n\">{}</td><td class=\"n\">{}</td>"
                       "<td>{}</td></tr>",
                       html_escape(parameters[k].name), shown.value, shown.error,
                       html_escape(shown.unit));
  }
  return out + "</tbody></table>";
}

std::string gain_table(const Finding &f) {
  const Quality &b = f.before.heldout, &a = f.after.heldout;
  std::string out = "<table><thead><tr><th scope=\"col\">on held-out data</th><th scope=\"col\" "
                    "class=\"n\">before</th><th scope=\"col\" class=\"n\">after</th></tr></thead>"
                    "<tbody>";
  const auto row = [&](const char *what, const std::string &before, const std::string &after) {
    out += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>", what,
                       before, after);
  };
  if (a.residual_rms_v != b.residual_rms_v)
    row("residual, rms", millivolts(b.residual_rms_v), millivolts(a.residual_rms_v));
  if (b.angle_error_rms_deg && a.angle_error_rms_deg &&
      *b.angle_error_rms_deg != *a.angle_error_rms_deg)
    row("angle error, rms", degrees(*b.angle_error_rms_deg), degrees(*a.angle_error_rms_deg));
  if (a.log_likelihood != b.log_likelihood)
    row("log likelihood a sample", fmt::format("{:.4g}", b.log_likelihood),
        fmt::format("{:.4g}", a.log_likelihood));
  else
    return {};
  return out + "</tbody></table>";
}

/// Whether the means over the axes miss most of what the cause explains, as they do for a tone.
bool means_miss(const Finding &f, const ResidualBins &before, const ResidualBins &after) {
  const double b = f.before.heldout.residual_rms_v, a = f.after.heldout.residual_rms_v;
  return b > a && shown_by_means(before, after) < 0.4e3 * std::sqrt(b * b - a * a);
}

std::string panels(const Finding &f, double noise_rms_v, const View &view, int rung,
                   Gallery &gallery) {
  const auto after = static_cast<std::size_t>(rung);
  const ResidualBins &b = view.rungs[after - 1], &a = view.rungs[after];
  const double limit = residual_limit(view, b, a);
  std::string out = "<div class=\"row panels\">";
  for (std::size_t axis = 0; axis < view.axes.size(); ++axis)
    out += figure(gallery.add(residual_picture(view, axis, b, a, limit)), "");
  if (!view.spectrum.density.empty() && means_miss(f, b, a))
    out += figure(gallery.add(spectrum_picture(view.spectrum, after - 1, after, noise_rms_v, true)),
                  "");
  return out + "</div>" +
         legend({{"before", "before this cause"}, {"after", "with it: mean and spread"}});
}

std::string rivals(const Finding &f) {
  if (f.alternatives.empty())
    return {};
  std::string names;
  for (const std::string &rival : f.alternatives)
    names += (names.empty() ? "" : ", ") + plain_name(rival);
  return fmt::format("<p class=\"rivals\"><b>This capture cannot tell it from {}.</b> What would: "
                     "{}.</p>",
                     html_escape(names), html_escape(without_stop(f.separate_by)));
}

std::string tag_of(const Finding &f) {
  if (f.correctable)
    return "corrected in the angle";
  return "not corrected in the angle: it is no property of the sensor";
}

} // namespace

std::string findings_section(const Diagnosis &d, const View &view, Gallery &gallery) {
  if (d.findings.empty())
    return {};
  std::string out = "<h2>What was found</h2>\n";
  for (std::size_t i = 0; i < d.findings.size(); ++i) {
    const Finding &f = d.findings[i];
    const EffectInfo &info = f.effect->info();
    out += fmt::format("<section class=\"finding\" id=\"finding-{}\" data-cause=\"{}\">"
                       "<h3><span>{}.</span> {} <span class=\"tag\">{}</span></h3><p>{}</p>",
                       i + 1, info.id, i + 1, html_escape(plain_name(info.id)), tag_of(f),
                       html_escape(info.cause));
    out += "<div class=\"facts\"><div>" + parameter_table(f) + "</div><div>" + gain_table(f) +
           "</div></div>" + rivals(f);
    const int rung = i < view.rung_of_finding.size() ? view.rung_of_finding[i] : -1;
    if (rung > 0)
      out += panels(f, d.noise_rms_v, view, rung, gallery);
    else if (info.evidence == Evidence::screening)
      out += "<p class=\"note\">Seen in the record sample by sample, not as a curve.</p>";
    else
      out += "<p class=\"note\">It changes the noise, not the mean of the signal, so that it shows "
             "in the likelihood rather than in a curve.</p>";
    out += "</section>\n";
  }
  return out;
}

} // namespace ada

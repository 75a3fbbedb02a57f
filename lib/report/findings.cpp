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

/// Calls each(parameter, shown) for every number of a finding.
template <class Each> void for_parameters(const Finding &f, const Each &each) {
  const auto parameters = f.effect->info().parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (!std::isnan(f.values[k]))
      each(parameters[k],
           show(parameters[k], f.values[k], k < f.std_errors.size() ? f.std_errors[k] : 0.0));
}

std::string listed(const std::vector<std::string> &ids) {
  std::string out;
  for (const std::string &id : ids)
    out += (out.empty() ? "" : ", ") + html_escape(id);
  return out;
}

/// What a finding gains, by what it changes: the residual, or only the likelihood.
std::string gain(const Finding &f) {
  const Quality &b = f.before.heldout, &a = f.after.heldout;
  if (millivolts(b.residual_rms_v) != millivolts(a.residual_rms_v))
    return change(millivolts(b.residual_rms_v), millivolts(a.residual_rms_v));
  if (a.log_likelihood != b.log_likelihood)
    return fmt::format("{:+.3g} nats a sample", a.log_likelihood - b.log_likelihood);
  return "\u2013";
}

std::string causes_table(const Diagnosis &d) {
  std::string out =
      "<table class=\"causes\" id=\"causes\"><thead><tr><th scope=\"col\" "
      "colspan=\"2\">cause</th><th "
      "scope=\"col\">parameters</th><th scope=\"col\" class=\"n\">residual, held out</th><th "
      "scope=\"col\">cannot be told from</th></tr></thead><tbody>\n";
  for (std::size_t i = 0; i < d.findings.size(); ++i) {
    const Finding &f = d.findings[i];
    std::string sizes;
    for_parameters(f, [&](const ParameterInfo &parameter, const Shown &shown) {
      sizes += fmt::format("<div><code>{}</code> {}</div>", html_escape(parameter.name),
                           html_escape(shown.in_full()));
    });
    out +=
        fmt::format("<tr><td class=\"n\">{0}</td><td><a href=\"#finding-{0}\">{1}</a></td><td>{2}"
                    "</td><td class=\"n\" data-label=\"residual, held out: \">{3}</td><td "
                    "data-label=\"cannot be told from: \">{4}</td></tr>\n",
                    i + 1, html_escape(f.effect->info().id), sizes, gain(f),
                    f.alternatives.empty() ? "\u2013" : listed(f.alternatives));
  }
  return out + "</tbody></table>\n";
}

std::string parameter_table(const Finding &f) {
  std::string out = "<table><thead><tr><th scope=\"col\">parameter</th><th scope=\"col\" "
                    "class=\"n\">value</th><th scope=\"col\" class=\"n\">std error</th><th "
                    "scope=\"col\">unit</th></tr></thead><tbody>";
  for_parameters(f, [&](const ParameterInfo &parameter, const Shown &shown) {
    out +=
        fmt::format("<tr><td><code>{}</code></td><td class=\"n\">{}</td><td class=\"n\">{}</td>"
                    "<td>{}</td></tr>",
                    html_escape(parameter.name), shown.value, shown.error, html_escape(shown.unit));
  });
  return f.effect->info().parameters.empty() ? std::string() : out + "</tbody></table>";
}

std::string gain_table(const Finding &f) {
  const Quality &b = f.before.heldout, &a = f.after.heldout;
  std::string rows;
  const auto add = [&](const char *what, const std::string &before, const std::string &after) {
    if (before != after)
      rows += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>",
                          what, before, after);
  };
  add("residual, rms", millivolts(b.residual_rms_v), millivolts(a.residual_rms_v));
  if (b.angle_error_rms_deg && a.angle_error_rms_deg)
    add("angle error, rms", degrees(*b.angle_error_rms_deg), degrees(*a.angle_error_rms_deg));
  add("log likelihood a sample", fmt::format("{:.4g}", b.log_likelihood),
      fmt::format("{:.4g}", a.log_likelihood));
  if (rows.empty())
    return {};
  return "<table><thead><tr><th scope=\"col\">on held-out data</th><th scope=\"col\" class=\"n\">"
         "before</th><th scope=\"col\" class=\"n\">after</th></tr></thead><tbody>" +
         rows + "</tbody></table>";
}

std::string rivals(const Diagnosis &d, std::size_t i) {
  const Finding &f = d.findings[i];
  if (f.alternatives.empty())
    return {};
  std::string next;
  for (const Experiment &e : d.next_experiments)
    if (e.finding == i)
      next += " To record next: " + html_escape(e.sentence) + ".";
  return fmt::format(
      "<p class=\"rivals\"><b>This capture cannot tell it from {}.</b> What would: {}.{}"
      "</p>",
      listed(f.alternatives), html_escape(without_stop(f.separate_by)), next);
}

/// Why a finding has no curve, by how a capture shows it.
std::string why_no_curve(const Finding &f) {
  switch (f.effect->info().evidence) {
  case Evidence::screening:
    return "No curve: it was seen in the samples themselves before any model was fitted, not as a "
           "difference between two models.";
  case Evidence::noise:
    return "No curve: it changes by how much the samples scatter, not where they lie on average. "
           "<a "
           "href=\"#noise\">The noise</a> shows its shape.";
  case Evidence::process:
    return "No curve of its own: its course is random, and no parameter draws it. The picture "
           "shows "
           "what the record holds along its axis.";
  case Evidence::signal:
    break;
  }
  return "No curve: what it does is known only from what this capture does not hold, or the "
         "baseline "
         "takes it up, so that the extended model is the same without it.";
}

/// The axis that a cause belongs to where it shows there, else the one along which it shows most; a
/// second one where the first does not show nearly all of it.
std::vector<std::size_t> best_axes(const Finding &f, const CauseView &cause, const View &view) {
  constexpr double kAlso = 0.3, kNearlyAll = 0.9;
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t a = 0; a < view.axes.all.size(); ++a)
    ranked.emplace_back(change_of_means(cause.bins, view.final, a), a);
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto &p, const auto &q) { return p.first > q.first; });
  const auto own = std::find_if(ranked.begin(), ranked.end(), [&](const auto &r) {
    return view.axes.all[r.second].name == f.effect->info().axis &&
           r.first > kAlso * ranked[0].first;
  });
  if (own != ranked.end())
    std::rotate(ranked.begin(), own, own + 1);
  std::vector<std::size_t> out{ranked[0].second};
  const bool enough = shown_of_cause(cause.bins, view.final, out[0]) > kNearlyAll;
  if (!enough && ranked.size() > 1 && ranked[1].first > kAlso * ranked[0].first)
    out.push_back(ranked[1].second);
  return out;
}

std::string curves(const Diagnosis &d, const View &view, std::size_t f, Gallery &gallery) {
  const CauseView &cause = view.causes[f];
  std::vector<Picture> pictures;
  if (view.spectrum_of[f] > 0)
    pictures.push_back(
        spectrum_picture(view.spectrum, view.spectrum_of[f], 1, noise_v(d), kBeside));
  else {
    const std::vector<std::size_t> axes = best_axes(d.findings[f], cause, view);
    const double limit = residual_limit(cause.bins, view.final);
    for (std::size_t a : axes)
      pictures.push_back(residual_picture(view.axes, a, cause.bins, view.final, limit,
                                          axes.size() == 1 ? kBeside : kPanel));
  }
  std::vector<std::string> cells;
  for (const Picture &p : pictures)
    cells.push_back(figure(gallery.add(p), ""));
  return row(std::move(cells)) +
         legend({{"before", "measured minus extended model without this cause"},
                 {"after",
                  view.spectrum_of[f] > 0 ? "with it" : "with it (line: mean, band: spread)"}});
}

/// Where no curve of its own can be drawn: the reason, and for a process what the record holds.
std::string instead(const Finding &f, const View &view, Gallery &gallery) {
  const std::string why = "<p class=\"note\">" + why_no_curve(f) + "</p>";
  const std::size_t axis = view.axes.find(f.effect->info().axis);
  if (f.effect->info().evidence != Evidence::process || axis == view.axes.all.size())
    return why;
  return row({figure(gallery.add(leftover_picture(view, axis, 0)), ""),
              figure(gallery.add(leftover_picture(view, axis, 1)), "")}) +
         why;
}

const char *in_the_angle(const Finding &f) {
  Baseline left;
  return f.correctable ? "corrected in the angle"
         : f.effect->leaves_behind(f.values, left)
             ? "the angle is corrected for what it left behind"
             : "not corrected in the angle: it is no property of the sensor";
}

std::string finding(const Diagnosis &d, const View &view, std::size_t i, Gallery &gallery) {
  const Finding &f = d.findings[i];
  const EffectInfo &info = f.effect->info();
  std::string out =
      fmt::format("<section class=\"finding\" id=\"finding-{0}\" "
                  "data-cause=\"{1}\"><h3><span>{0}.</span> {1} <span "
                  "class=\"tag\">{2}</span></h3><div class=\"two\"><div><p>{3}</p>{4}",
                  i + 1, html_escape(info.id),
                  in_the_angle(f),
                  html_escape(info.cause), parameter_table(f));
  if (i < view.causes.size() && view.causes[i].drawn)
    out += gain_table(f) + "</div><div>" + curves(d, view, i, gallery);
  else
    out += "</div><div>" + gain_table(f) + instead(f, view, gallery);
  out += "</div></div>";
  return out + rivals(d, i) + "</section>\n";
}

} // namespace

std::string causes_section(const Diagnosis &d, const View &view, Gallery &gallery) {
  if (d.findings.empty())
    return "<h2>Causes</h2>\n<p>No cause of the catalogue was found.</p>\n";
  std::string out = "<h2>Causes</h2>\n" + causes_table(d);
  for (std::size_t i = 0; i < d.findings.size(); ++i)
    out += finding(d, view, i, gallery);
  return out;
}

} // namespace ada

// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "base/angle.h"
#include "diagnosis/words/explain.h"
#include "report/page.h"
#include "report/svg.h"
#include "report/words.h"

namespace ada {

namespace {

std::string model_row(const std::string &part, const std::string &name, const Shown &shown) {
  return fmt::format("<tr><th scope=\"row\">{}</th><td><code>{}</code></td><td class=\"n\">{}</td>"
                     "<td class=\"n\">{}</td><td>{}</td></tr>\n",
                     part, name, shown.value, shown.error, html_escape(shown.unit));
}

std::string baseline_rows(const Model &m) {
  struct Row {
    const char *name, *unit;
    double value, error;
  };
  const Baseline &b = m.baseline, &e = m.baseline_std_error;
  std::string out, part = "baseline";
  for (const Row &r : {Row{"amplitude_v", "V", b.amplitude_v, e.amplitude_v},
                       Row{"offset_sin_v", "V", b.offset_sin_v, e.offset_sin_v},
                       Row{"offset_cos_v", "V", b.offset_cos_v, e.offset_cos_v},
                       Row{"angle_zero_deg", "deg", b.angle_zero_deg, e.angle_zero_deg}}) {
    const ParameterInfo info{r.name, r.unit, 0.0, 0.0, 0.0};
    out += model_row(part, r.name, show(info, r.value, r.error));
    part.clear();
  }
  return out;
}

std::string effect_rows(const EffectInstance &e) {
  const auto parameters = e.effect->info().parameters;
  std::string out, part = html_escape(e.effect->info().id);
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    if (std::isnan(e.values[k]))
      continue;
    const double error = k < e.std_errors.size() ? e.std_errors[k] : 0.0;
    out +=
        model_row(part, html_escape(parameters[k].name), show(parameters[k], e.values[k], error));
    part.clear();
  }
  return out;
}

std::string fact(const std::string &name, const std::string &value) {
  return value.empty()
             ? std::string()
             : "<tr><th scope=\"row\">" + name + "</th><td>" + html_escape(value) + "</td></tr>\n";
}

template <class T> std::string range(const std::vector<T> &column, double scale, const char *unit) {
  if (column.empty())
    return {};
  const auto [low_at, high_at] = std::minmax_element(column.begin(), column.end());
  const double low = *low_at * scale, high = *high_at * scale;
  // As many digits as tell the ends apart.
  for (int digits = 4; digits < 9; ++digits) {
    const std::string from = fmt::format("{:.{}g}", low, digits),
                      to = fmt::format("{:.{}g}", high, digits);
    if (from != to)
      return from + " to " + to + " " + unit;
  }
  return fmt::format("{:.6g} {} throughout", low, unit);
}

std::string channels(const Diagnosis &d) {
  std::string out;
  for (const std::string &c : d.channels)
    out += (out.empty() ? "" : ", ") + c;
  return out;
}

} // namespace

std::string model_section(const Diagnosis &d) {
  std::string out =
      "<h2>The extended model</h2>\n<p class=\"note\">Fitted jointly to the training "
      "part; standard errors of one sigma. <code>--extend</code> writes it as a file "
      "that <code>convert --calibration</code> reads.</p>\n"
      "<div class=\"scroll\"><table id=\"model\"><thead><tr><th scope=\"col\">part</th><th "
      "scope=\"col\">parameter</th><th scope=\"col\" class=\"n\">value</th><th "
      "scope=\"col\" class=\"n\">std error</th><th scope=\"col\">unit</th></tr>"
      "</thead><tbody>\n";
  out += baseline_rows(d.extended);
  for (const EffectInstance &e : d.extended.effects)
    out += effect_rows(e);
  if (d.extended.remainder)
    out += fmt::format(
        "<tr><th scope=\"row\">periodic-remainder (unnamed)</th><td colspan=\"4\">{} orders of "
        "the {}, {} rms</td></tr>\n",
        d.extended.remainder->orders(),
        d.extended.remainder->electrical ? "electrical period" : "turn",
        millivolts(d.remainder_rms_v));
  return out + "</tbody></table></div>\n";
}

std::string capture_section(const Diagnosis &d, const Capture &c, const View &view) {
  std::string out = "<h2>The capture</h2>\n<table id=\"capture\"><tbody>\n";
  out += fact("serial", c.meta.serial);
  out += fact("origin", c.meta.origin);
  out += fact("identity", c.identity);
  out += fact("record", fmt::format("{} samples in {:.4g} s, {:.4g} turns", d.samples, d.duration_s,
                                    d.turns));
  if (!d.reference_aside.empty())
    out += fact("reference", "set aside: " + d.reference_aside);
  if (d.reference_course)
    out += fact("reference", in_words(*d.reference_course));
  if (!c.time_s.empty())
    out += fact("starts at", fmt::format("{:.10g} s", c.time_s.front()));
  out += fact("channels", channels(d));
  out += fact("speed", range(view.scene.all.omega, 60.0 / kTwoPi, "rpm"));
  out += fact("VTEMP", range(c.vtemp_v, 1.0, "V"));
  out += fact("VDD", range(c.vdd_v, 1.0, "V"));
  out += fact("supply", fmt::format("{:g} V, {} electrical periods a turn", c.meta.supply_v,
                                    d.periods_per_turn));
  if (c.meta.gain_control)
    out += fact("gain control", *c.meta.gain_control ? "on" : "off");
  if (c.meta.noise_rms_v)
    out += fact("stated noise", millivolts(*c.meta.noise_rms_v) + " rms");
  return out + "</tbody></table>\n";
}

} // namespace ada
